"""What the cases add up to: per effect, where nothing was withheld, and how far the probabilities can be relied on."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from tendonlab.rehearsal.curve import Threshold, clopper_pearson, threshold_of
from tendonlab.rehearsal.sizes import Ladder

BINS = (0.0, 0.5, 0.8, 0.95, 1.0)  # of the stated probability
VISIBLE = 1.0  # gap over noise from which a probability must be right
HITS = ("found", "tied")
Row = Mapping[str, Any]


@dataclass(frozen=True, kw_only=True)
class SizeCount:
    """One size of an effect: `gap` over noise, `amount` of its size parameter, `found` of `tried` rigs, `ci95` of that
    share."""

    gap: float
    amount: float
    found: int
    tried: int
    ci95: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class EffectRehearsal:
    """One effect. `parameter`: the one that says how large it is, in `unit`; it `falls` or grows with the effect. At
    the largest size that was simulated the effect leaves `largest_gap`. `sizes`: counts. `threshold`: gap over noise
    from which it is found 9 times in 10, None where nothing was tried. `amounts`: the same bounds in the size
    parameter: at the threshold, and its 95 % interval. `missed`: what it was called where it was not found, with
    counts, most frequent first; `tied`: effects that were named
    in its place where the data could not tell them apart, which counts as found, with counts."""

    effect: str
    parameter: str
    unit: str
    falls: bool
    largest_gap: float
    largest_amount: float | None
    sizes: tuple[SizeCount, ...]
    threshold: Threshold | None
    amounts: tuple[float | None, float | None, float | None]
    missed: Mapping[str, int]
    tied: Mapping[str, int]

    @property
    def tried(self) -> int:
        """Rigs from which the effect was withheld."""
        return sum(size.tried for size in self.sizes)


@dataclass(frozen=True, kw_only=True)
class Share:
    """`hits` of `num` rigs, with a 95 % Clopper–Pearson interval."""

    hits: int
    num: int
    ci95: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class ReliabilityBin:
    """Answers whose stated probability lies in `stated`: `mean` of it, and how many were right."""

    stated: tuple[float, float]
    mean: float
    right: Share


def effect_rehearsal(ladder: Ladder, rows: Iterable[Row]) -> EffectRehearsal:
    """What became of one effect."""
    own = [row for row in rows if row["effect"] == ladder.effect]
    sizes = tuple(_count(ladder, gap, own) for gap in sorted({float(row["gap"]) for row in own}))
    threshold = (
        threshold_of([s.gap for s in sizes], [s.found for s in sizes], [s.tried for s in sizes]) if sizes else None
    )
    return EffectRehearsal(
        effect=ladder.effect,
        parameter=ladder.parameter,
        unit=ladder.unit,
        falls=ladder.falls,
        largest_gap=ladder.largest_gap,
        largest_amount=ladder.amounts[-1] if ladder.amounts else None,
        sizes=sizes,
        threshold=threshold,
        amounts=_amounts(ladder, threshold),
        missed=_missed(own),
        tied=_tied(own),
    )


def share(hits: int, num: int) -> Share:
    """A share with its interval."""
    return Share(hits=hits, num=num, ci95=clopper_pearson(hits, num))


def nothing_withheld(rows: Iterable[Row]) -> dict[str, Share]:
    """Of the rigs from which nothing was withheld: in how many an effect was named, an unknown one was claimed, or a
    fault of the logs."""
    outcomes = [row["outcome"] for row in rows if not row["effect"]]
    named, unknown = outcomes.count("other"), outcomes.count("unknown")
    counts = {"effect": named, "unknown_effect": unknown, "data_fault": outcomes.count("data_fault")}
    return {name: share(count, len(outcomes)) for name, count in counts.items()}


def false_effects(rows: Iterable[Row]) -> dict[str, int]:
    """Effects that were named where nothing was withheld, most frequent first."""
    return dict(Counter(name for row in rows if not row["effect"] for name in row["named"]).most_common())


def reliability(rows: Iterable[Row]) -> tuple[float | None, list[ReliabilityBin]]:
    """Mean probability on the truth, and by stated probability how many answers were right: of the rigs with an effect
    of at least one noise floor, and of those from which nothing was withheld."""
    kept = [r for r in rows if r["stated"] is not None and (not r["effect"] or r["gap"] >= VISIBLE)]
    bins = []
    for low, high in pairwise(BINS):
        inside = [r for r in kept if low <= r["stated"] < high or r["stated"] == high == BINS[-1]]
        if inside:
            mean = sum(r["stated"] for r in inside) / len(inside)
            right = share(sum(bool(r["right"]) for r in inside), len(inside))
            bins.append(ReliabilityBin(stated=(low, high), mean=mean, right=right))
    return (sum(r["on_truth"] for r in kept) / len(kept) if kept else None), bins


def _count(ladder: Ladder, gap: float, rows: Sequence[Row]) -> SizeCount:
    here = [row["outcome"] for row in rows if row["gap"] == gap]
    found = sum(outcome in HITS for outcome in here)
    return SizeCount(
        gap=gap, amount=ladder.amount(gap), found=found, tried=len(here), ci95=clopper_pearson(found, len(here))
    )


def _missed(rows: Iterable[Row]) -> dict[str, int]:
    """Answers in place of the truth. Where several effects were named, the first one counts."""
    answers = (row["named"][0] if row["outcome"] == "other" else row["outcome"] for row in rows)
    return dict(Counter(answer for answer in answers if answer not in HITS).most_common())


def _tied(rows: Iterable[Row]) -> dict[str, int]:
    """Effects that were named in place of the truth, from a group that contains it."""
    return dict(Counter(name for row in rows if row["outcome"] == "tied" for name in row["named"][:1]).most_common())


def _amounts(ladder: Ladder, threshold: Threshold | None) -> tuple[float | None, float | None, float | None]:
    if threshold is None:
        return None, None, None
    low, high = threshold.ci95
    bounds = [None if gap is None else ladder.amount(gap) for gap in (threshold.size, low, high)]
    return bounds[0], bounds[1], bounds[2]
