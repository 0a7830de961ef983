"""Which experiments are held out where the dataset does not say."""

from collections.abc import Sequence

TEST_SHARE = 0.3


def choose_test(repeats: Sequence[str | None]) -> tuple[int, ...]:
    """Indices of the experiments to hold out, given the repeat label of each: about 30 %, evenly over the session.

    Whole experiments only, never samples. The first experiment and the first of every group of repeats stay in the
    training set, so that nothing that was recorded is known from the held-out side alone. Depends on nothing random."""
    first = {0} | {repeats.index(label) for label in set(repeats) if label is not None and repeats.count(label) > 1}
    candidates = [index for index in range(len(repeats)) if index not in first]
    count = min(max(1, round(TEST_SHARE * len(repeats))), len(candidates))
    # the middle of each of `count` equal stretches of the candidates
    return tuple(candidates[int((part + 0.5) * len(candidates) / count)] for part in range(count))
