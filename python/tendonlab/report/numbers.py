"""Numbers as a reader wants them: few digits, a true minus sign, units with raised exponents and SI prefixes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

ABSENT = "–"
MOST_DIGITS = 6  # of a bound of a narrow span
_EDGE = 0.01  # share of the other edge of a region below which an edge is none
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"))
_TAKES_PREFIX = ("rad", "m", "N", "s", "A", "V")


def number(value: float | None, digits: int = 3) -> str:
    """`value` to so many significant digits; a dash where there is none or it is not finite."""
    if value is None or not math.isfinite(value):
        return ABSENT
    mantissa, _, power = f"{value:.{digits - 1}e}".partition("e")
    exponent = int(power)
    if -3 <= exponent < 5:
        text = f"{float(f'{value:.{digits - 1}e}'):.{max(0, digits - 1 - exponent)}f}"
        text = text.rstrip("0").rstrip(".") if "." in text else text
    else:
        text = f"{mantissa.rstrip('0').rstrip('.')}×10{str(exponent).translate(_RAISED)}"
    return "0" if float(value) == 0.0 else text.replace("-", "−")


def counted(count: int, noun: str) -> str:
    """ "1 run", "2 runs"."""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def span(bounds: Sequence[float] | None, digits: int = 3) -> str:
    """Two bounds as "0.04 to 0.06"; empty where they are absent. Different bounds differ in print, by more digits."""
    if bounds is None:
        return ""
    low, high = (number(bound, _telling(bounds, digits)) for bound in bounds)
    return f"{low} to {high}"


def region(bounds: Sequence[float] | None, digits: int = 3) -> str:
    """Where a coordinate lies, as a `span`: an edge below 1 % of the other is noise about zero and reads 0."""
    if bounds is None:
        return ""
    least = _EDGE * max(map(abs, bounds))
    return span([0.0 if abs(bound) < least else bound for bound in bounds], digits)


def estimate(value: float | None, bounds: Sequence[float | None] | None, digits: int = 3) -> tuple[str, str]:
    """A value and the span of its bounds (empty where one is absent), with the digits that tell the bounds apart."""
    known = [bound for bound in bounds or () if bound is not None]
    if len(known) != 2:
        return number(value, digits), ""
    return number(value, _telling(known, digits)), span(known, digits)


def _telling(bounds: Sequence[float], digits: int) -> int:
    """The digits, `digits` or more, that tell two different bounds apart."""
    if bounds[0] == bounds[1]:
        return digits
    apart = (d for d in range(digits, MOST_DIGITS) if number(bounds[0], d) != number(bounds[1], d))
    return next(apart, max(digits, MOST_DIGITS))


def probability(value: float | None) -> str:
    """Two decimals, and never a certainty that two decimals cannot state."""
    if value is None or not math.isfinite(value):
        return ABSENT
    if value > 0.99:
        return "> 0.99"
    return f"{value:.2f}" if value >= 0.01 or value == 0.0 else "< 0.01"


def percent(value: float | None, bounds: Sequence[float] | None = None) -> str:
    """A share as "91 %", with bounds "91 % (88–94 %)"."""
    if value is None or not math.isfinite(value):
        return ABSENT
    if bounds is None or not all(map(math.isfinite, bounds)):
        return f"{_hundredths(value)} %"
    return f"{_hundredths(value)} % ({percent_span(bounds)})"


def percent_span(bounds: Sequence[float]) -> str:
    """Two shares as "88–94 %", or "−5 to 70 %" where a dash would read as a sign."""
    low, high = map(_hundredths, bounds)
    return f"{low}{' to ' if min(bounds) < 0 else '–'}{high} %"


def times_as_large(shrinkage: float) -> str:
    """What a negative shrinkage makes of a gap: "6.3 times as large"."""
    return f"{number(1.0 - shrinkage, 2)} times as large"


def _hundredths(value: float) -> str:
    text = f"{100 * value:.1f}" if 0.99 < abs(value) < 0.9995 else f"{100 * value:.0f}"
    return "0" if text == "-0" else text.replace("-", "−")


def unit_text(unit: str) -> str:
    """A pint unit for the eye: "kg*m^2" as "kg·m²"; empty for a dimensionless one."""
    if unit in ("", "1", "dimensionless"):
        return ""
    text = unit.replace("**", "^").replace("*", "·")
    head, *powers = text.split("^")
    for power in powers:
        length = len(power) - len(power.lstrip("-0123456789"))
        head += power[:length].translate(_RAISED) + power[length:]
    return head


def prefixed(values: Iterable[float | None], unit: str) -> tuple[float, str]:
    """(factor, unit) that bring the largest of `values` to 1 or more: (1000.0, "mrad") for 0.03 rad."""
    sizes = [abs(value) for value in values if value is not None and math.isfinite(value) and value != 0]
    first = unit.split("*")[0].split("/")[0].split("^")[0]
    if not sizes or first not in _TAKES_PREFIX or unit.startswith(first + "^"):
        return 1.0, unit_text(unit)
    scale, letter = next((pair for pair in _PREFIXES if max(sizes) >= pair[0]), _PREFIXES[-1])
    return 1.0 / scale, letter + unit_text(unit)
