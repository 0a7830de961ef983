"""From wrong factors to findings, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence

from tendonlab.checking.conversions import nearest
from tendonlab.checking.finding import Finding
from tendonlab.checking.logs import TIME
from tendonlab.checking.scales import BLOCKING, Factor
from tendonlab.data import Dataset
from tendonlab.report.numbers import number

NEAR = 0.12  # relative distance within which a known ratio is named


def factor_findings(factors: Sequence[Factor], dataset: Dataset) -> list[Finding]:
    """A finding for each signal of the best factor; the other ones are its alternatives."""
    if not factors:
        return []
    best = factors[0]
    kind = "sign" if best.value < 0 else "scale"
    ways = list(dict.fromkeys(f.signals for f in factors if (f.value < 0) == (best.value < 0)))
    alternatives = tuple(dict.fromkeys(name for way in ways for name in way if name not in best.signals))

    def details(name: str) -> str:
        if kind == "sign":
            return _sign_words(best.value, ways)
        return _scale_words(name, best.value, alternatives, dataset)

    return [
        Finding(
            problem=kind,
            signal=name,
            alternatives=alternatives,
            factor=best.value,
            blocks=True,
            detail=details(name),
        )
        for name in best.signals
    ]


def _sign_words(value: float, ways: Sequence[tuple[str, ...]]) -> str:
    text = f"the efforts that the motion needs come out {number(value)} times as stated"
    size = f". Their size is wrong as well{_hint(-value)}" if abs(math.log(-value)) > math.log(BLOCKING) else ""
    each = [" and ".join(way) for way in ways]
    return f"{text}; turn the sign of {', or of '.join(each)}{size}"


def _scale_words(name: str, value: float, alternatives: Sequence[str], dataset: Dataset) -> str:
    also = f". {' or '.join(alternatives)} may be wrong instead" if alternatives else ""
    seen = f"{number(value)} times as large as the equation of motion allows{_hint(value)}"
    if name == TIME:
        inertias = f"the inertias stated, which would be {number(value**-2)} times as large as they are"
        return f"the time is {seen}; check the unit of the time column, or that of {inertias}{also}"
    spec = dataset.signals[name]
    gain = dataset.system().info.with_role("command_gain")
    scaled = spec.role == "input" and gain is not None and gain.name in dataset.parameters
    constant = f"and {gain.name}" if scaled and gain is not None else "and the constants that scale it"
    return f"{name} is {seen}; check its unit ({spec.unit}) {constant}{also}"


def _hint(value: float) -> str:
    """The confusion that a factor suggests: the nearest of those that are known."""
    near = nearest(value)
    return f" (near {near.label}: {near.words}?)" if abs(math.log(value / near.ratio)) < NEAR else ""
