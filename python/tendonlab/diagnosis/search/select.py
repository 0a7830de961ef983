"""Which effects: added one at a time, then each judged again beside the others (docs/method.md)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from tendonlab.diagnosis.search.contest import Round, Workshop, another
from tendonlab.diagnosis.search.rivals import MAX_EFFECTS, Known, Seat, exchange, most, seats, without
from tendonlab.fitting.fitted import Fitted, Fitter

MAX_EXCHANGES = 3


@dataclass(frozen=True)
class Search:
    """The refitted simulator, the models that lead from it to the one that came out, effect by effect, and the rounds
    that chose: one an effect, beside the others, and the one that found no further effect."""

    null: Fitted
    steps: tuple[Fitted, ...]
    rounds: tuple[Round, ...]

    @property
    def best(self) -> Fitted:
        """The model that came out."""
        return self.path[-1]

    @property
    def selected(self) -> tuple[str, ...]:
        """Effects established, in the order in which they were found."""
        return self.best.added

    @property
    def path(self) -> tuple[Fitted, ...]:
        """The refitted simulator, and the model after each effect that was added."""
        return (self.null, *self.steps)


Renew = Callable[[Fitter, Fitted], tuple[Fitter, Fitted]]


def search(
    fitter: Fitter,
    null: Fitted,
    *,
    pool: ThreadPoolExecutor,
    renew: Renew,
    progress: bool,
    library: Sequence[str] | None,
) -> Search:
    """Add effects one at a time, as long as evidence and left-out experiments both ask for it; then judge each beside
    the others: what explains most alone may only imitate two that belong together. `renew` gives the fitter for the
    search beyond a model, and the model in its eyes."""
    shop = Workshop(pool, progress, library)
    steps, known, last = list[Fitted](), Known(), list[Round]()
    for exchanges in range(MAX_EXCHANGES + 1):
        fitter, last = _forward(fitter, null, steps, known, shop=shop, renew=renew)
        chosen = seats(fitter, steps[-1], known, shop) if steps else []
        better = (
            exchange(fitter, steps[-1], chosen, known, shop) if len(chosen) > 1 and exchanges < MAX_EXCHANGES else None
        )
        if better is None:
            break
        fitter, best = renew(fitter, better)
        steps = [*_on_the_way(fitter, best), best]
    return Search(null, tuple(steps), (*(seat.round for seat in chosen), *last))


def _forward(
    fitter: Fitter,
    null: Fitted,
    steps: list[Fitted],
    known: Known,
    *,
    shop: Workshop,
    renew: Renew,
) -> tuple[Fitter, list[Round]]:
    """Add effects to `steps` until none is established, and the seats they won to `known`. The fitter then, and the
    round that found none, if there was one."""
    while len(steps) < MAX_EFFECTS:
        best = steps[-1] if steps else null
        one = another(fitter, best, most=most(known), shop=shop)
        if one is None or one.accepted is None:
            return fitter, [one] if one else []
        known[frozenset(best.added), one.accepted.effect] = Seat(best, one.accepted, one)
        fitter, best = renew(fitter, one.accepted.fitted)
        steps.append(best)
    return fitter, []


def _on_the_way(fitter: Fitter, best: Fitted) -> list[Fitted]:
    """The models between the refitted simulator and `best`, effect by effect."""
    return [
        fitter.fit(without(fitter, best, best.added[k:]), added=best.added[:k], initial=best.initial)
        for k in range(1, len(best.added))
    ]
