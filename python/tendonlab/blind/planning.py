"""What every case of a draw is to be."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import unknown
from .excitation import PLANS
from .rig import MET_WITHIN, forms_of
from .strength import TOLERANCE
from .systems import SYSTEMS

MIXED = "mixed"
SHARES = (
    "repeats", "unknown_share", "effect_share", "nothing_share", "pairs", "dominant", "faults", "other_form",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Options:
    """What a series is to hold; the defaults are those of `draw`.

    `system`: a kind of `SYSTEMS`, or "mixed" for all of them. `unknown_share`: share of the cases whose cause the
    library lacks. Of the others the share `effect_share` lacks an effect and `nothing_share` lacks nothing; the rest
    has wrong parameters only. `pairs`: share of the cases that lack an effect which lack a second one. `repeats`: share
    of the cases that repeat an experiment. `faults`: share of the cases whose logs have a mistake.

    `strengths`: range of the gap/noise of an effect. `second`: that of the second effect of a pair, None for the same.
    `dominant`: share of the pairs that hide a weak effect, in the range `weak`, behind a strong one, in `strong`.
    `other_form`: share of the single effects, and of the pairs, in another form than the library's, as far as effects
    have one; None: half of those that have one, each by its own draw.

    `effects`: those that are drawn, () for all of the kind of rig. `excitation`: "rich" or "poor", None for both.

    A rig is drawn again until the logarithm of its gap/noise is as wanted, within `met_within`; after `tries` rigs
    another effect takes the place.
    """

    system: str = "two_inertia"
    repeats: float = 1.0
    unknown_share: float = 0.0
    effect_share: float = 0.7
    nothing_share: float = 0.15
    pairs: float = 0.0
    dominant: float = 0.0
    faults: float = 0.0
    other_form: float | None = None
    strengths: tuple[float, float] = (1.0, 6.0)
    second: tuple[float, float] | None = None
    strong: tuple[float, float] = (20.0, 100.0)
    weak: tuple[float, float] = (0.5, 5.0)
    tries: int = 3
    met_within: float = MET_WITHIN
    effects: tuple[str, ...] = ()
    excitation: str | None = None

    def __post_init__(self) -> None:
        """Raise ValueError if a share is not from 0 to 1, if strengths are no range, and for another system."""
        for name in SHARES:
            share = getattr(self, name)
            if share is not None and not 0.0 <= share <= 1.0:
                raise ValueError(f"{name} = {share}: expected a share from 0 to 1")
        if self.effect_share + self.nothing_share > 1.0 + 1e-9:
            both = f"{self.effect_share} + {self.nothing_share}"
            raise ValueError(f"effect_share + nothing_share = {both}: expected at most 1")
        for name in ("strengths", "second", "strong", "weak"):
            least, largest = getattr(self, name) or self.strengths
            if not 0.0 < least < largest < np.inf:
                raise ValueError(f"{name} = {least}, {largest}: expected two numbers, 0 < least < largest")
        if self.system not in (*SYSTEMS, MIXED):
            raise ValueError(f"system = {self.system!r}: expected one of {', '.join((*SYSTEMS, MIXED))}")
        for kind in self.kinds:
            known = SYSTEMS[kind].effects
            if self.effects and not set(self.effects) & set(known):
                raise ValueError(f"effects = {', '.join(self.effects)}: expected some of a {kind}, {', '.join(known)}")
        if self.excitation not in (None, *PLANS):
            raise ValueError(f"excitation = {self.excitation!r}: expected one of {', '.join(PLANS)}")
        if self.tries < 1:
            raise ValueError(f"tries = {self.tries}: expected at least 1")
        if not TOLERANCE < self.met_within < np.inf:
            raise ValueError(f"met_within = {self.met_within}: expected more than {TOLERANCE}, where the search stops")

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of rigs that are drawn."""
        return tuple(SYSTEMS) if self.system == MIXED else (self.system,)


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A case to draw: its system, kind, the effect that its simulator lacks ("" for none, "unknown:bump" for a cause
    that the library lacks as well), whether it repeats an experiment, whether it lacks a second effect, and whether
    its logs have a mistake; ranges of the gap/noise of its effect and of the second one. `is_other_form`: whether the
    effect has another form than the library's, None where the rig draws that. `excitation`, `tries`, `met_within`: see
    `Options`.
    """

    system: str
    kind: str
    effect: str
    has_repeats: bool
    is_pair: bool = False
    has_fault: bool = False
    strengths: tuple[float, float] = (1.0, 6.0)
    second: tuple[float, float] = (1.0, 6.0)
    is_other_form: bool | None = None
    tries: int = 3
    met_within: float = MET_WITHIN
    excitation: str | None = None


def plan(seed: int, count: int, **options: Any) -> list[Wanted]:
    """What every case is to be, shuffled; effects go round in turn, so that all appear once `count` allows it.

    `options`: fields of `Options`. The draws of repeats, pairs, forms and mistakes change nothing else: the rigs of a
    seed are the same with and without. Raises ValueError if count < 1, and as `Options` does.
    """
    if count < 1:
        raise ValueError(f"count = {count}: expected at least 1")
    of = Options(**options)
    repeated, faulty = (_some(seed, n, of=range(count), share=x) for n, x in ((1, of.repeats), (4, of.faults)))
    drawn = _mixed_kinds(seed, count, of) if of.system == MIXED else _kinds(seed, count, system=of.system, of=of)
    lacking = [i for i, (_, kind, _) in enumerate(drawn) if kind == "effect"]
    pairs = _some(seed, 3, of=lacking, share=of.pairs)
    dominant = _some(seed, 5, of=sorted(pairs), share=of.dominant)
    other = _in_other_form(seed, {i: drawn[i] for i in lacking}, pairs, share=of.other_form)
    return [
        Wanted(
            system=name,
            kind=kind,
            effect=effect,
            has_repeats=i in repeated,
            is_pair=i in pairs,
            has_fault=i in faulty,
            strengths=of.strong if i in dominant else of.strengths,
            second=of.weak if i in dominant else of.second or of.strengths,
            is_other_form=None if of.other_form is None else i in other,
            tries=of.tries,
            met_within=of.met_within,
            excitation=of.excitation,
        )
        for i, (name, kind, effect) in enumerate(drawn)
    ]


def _in_other_form(
    seed: int, lacking: Mapping[int, tuple[str, str, str]], pairs: set[int], *, share: float | None
) -> set[int]:
    """Places whose effect has another form: the `share` of the single ones, and of the pairs, as far as effects have
    another form.
    """
    chosen: set[int] = set()
    for stream, group in ((6, [i for i in lacking if i not in pairs]), (7, sorted(pairs))):
        able = [i for i in group if len(forms_of(SYSTEMS[lacking[i][0]], lacking[i][2])) > 1]
        wanted = round((share or 0.0) * len(group))
        chosen |= _some(seed, stream, of=able, share=min(1.0, wanted / max(1, len(able))))
    return chosen


def _some(seed: int, stream: int, *, of: Sequence[int], share: float) -> set[int]:
    """A share of these places."""
    chosen = np.random.default_rng([seed, 0, stream]).permutation(len(of))
    return {of[k] for k in chosen[: round(share * len(of))]}


def _mixed_kinds(seed: int, count: int, of: Options) -> list[tuple[str, str, str]]:
    """As many cases of each system, within one, in random order."""
    names = of.kinds
    order = [names[i % len(names)] for i in np.random.default_rng([seed, 0, 2]).permutation(count)]
    queues = {name: iter(_kinds(seed, order.count(name), system=name, of=of)) for name in set(order)}
    return [next(queues[name]) for name in order]


def _kinds(seed: int, count: int, *, system: str, of: Options) -> list[tuple[str, str, str]]:
    """(system, kind, effect) of the cases of one system."""
    draw, num_unknown = np.random.default_rng([seed, 0]), round(of.unknown_share * count)
    known = count - num_unknown
    singles = min(known, max(1 if of.effect_share else 0, round(of.effect_share * known)))
    none = min(known - singles, round(of.nothing_share * known))
    drawn = [effect for effect in SYSTEMS[system].effects if effect in (of.effects or SYSTEMS[system].effects)]
    kinds = [("effect", effect) for effect in _in_turn(drawn, singles, draw)] + [("none", "")] * none
    kinds += [("parameters_only", "")] * (known - len(kinds))
    kinds += [("unknown", cause) for cause in _in_turn(unknown.named(SYSTEMS[system].causes), num_unknown, draw)]
    return [(system, *kinds[i]) for i in draw.permutation(count)]


def _in_turn(names: Sequence[str], count: int, draw: np.random.Generator) -> list[str]:
    """`count` of the names, each round of them shuffled."""
    order: list[str] = []
    while len(order) < count:
        order += [names[i] for i in draw.permutation(len(names))]
    return order[:count]
