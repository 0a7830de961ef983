"""What to measure where the library explains too little: motions that show what the unknown cause follows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from tendonlab.report.numbers import region, unit_text
from tendonlab.report.words import coordinate_words

CLEAR = 0.05  # chance below which errors that gather in one regime are no accident
FOLLOWS = {
    "position": "slow reversals at one speed, {there} and elsewhere: errors that belong to a place return there",
    "velocity": "constant speeds in both directions, up and down again, {there} and beyond: errors that belong to a "
    "speed return with the speed",
    "load": "one motion with two or three payloads, {there} and beyond: errors that belong to a load grow with "
    "the load",
    "time": "one motion after rests of several lengths, and again when all is warm: only errors that belong to rest or "
    "warmth change",
}
REPEAT = (
    "one experiment three times, at the start, in the middle and at the end: what does not repeat is noise or drift, "
    "and the rest has a cause"
)


def explore(
    regimes: Sequence[Mapping[str, Any]], units: Mapping[str, str], kind: str, *, repeated: bool
) -> list[dict[str, Any]]:
    """Measurements for a verdict of an unknown cause: in the regimes that clearly hold most of the errors, one of each
    quantity, and repeats where there are none. `units`: of each coordinate. `kind`: of the system."""
    found: dict[str, str] = {}
    for regime in regimes:
        name = str(regime["coordinate"])
        quantity = name.rpartition("_")[2]
        if quantity in FOLLOWS and regime["p_value"] < CLEAR:
            there = f"{coordinate_words(name, kind)} of {region(regime['range'], 2)} {unit_text(units.get(name, ''))}"
            found.setdefault(quantity, FOLLOWS[quantity].format(there=f"at a {there.rstrip()}"))
    found = found or {"time": FOLLOWS["time"]}
    words = [*([] if repeated else [REPEAT]), *found.values()]
    return [{"description": text, "separates": [], "expected_gain": None} for text in words]
