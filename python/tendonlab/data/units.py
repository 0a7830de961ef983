"""Unit conversion to SI by pint, with the dimension checked against what the system expects."""

from __future__ import annotations

import functools
import tokenize
from typing import TYPE_CHECKING

from tendonlab.errors import DatasetError

if TYPE_CHECKING:
    import numpy as np
    import pint

# What a command that the torque constant converts may be measured in, and how a message calls it.
COMMAND_UNITS = ("A", "V", "1")


@functools.cache
def _registry() -> pint.UnitRegistry[float]:
    import pint  # takes half a second, so only where a unit is met

    registry: pint.UnitRegistry[float] = pint.UnitRegistry()
    registry.define("@alias turn = rev")  # pint knows revolution, cycle and rpm
    return registry


@functools.cache
def parse(unit: str) -> pint.Unit:
    """The unit that the text `unit` names, "1" being dimensionless. Raises DatasetError where it names none."""
    import pint

    try:
        return _registry().Unit("dimensionless" if unit.strip() in ("1", "") else unit)
    except (pint.PintError, ValueError, TypeError, AttributeError, AssertionError, tokenize.TokenError) as error:
        # Of a product that breaks off, pint's parser says nothing that a reader could use.
        reason = "" if isinstance(error, AssertionError | tokenize.TokenError) else f" ({error})"
        raise DatasetError(f"unit {unit!r} is not a unit{reason}; expected one like 'N*m', 'rad/s', '1'") from error


def same_dimension(unit: str, other: str) -> bool:
    """Whether one converts into the other. Hertz, counts and percent are no angle, though pint sees only numbers.
    Pint takes half a second to load: what is written as the library writes it does without."""
    if unit == other:
        return True
    left, right = parse(unit), parse(other)
    if left.dimensionality != right.dimensionality:
        return False
    return not _is_angular(right) or _is_angular(left) or _is_plain(left)


def require_dimension(unit: str, expected: str) -> None:
    """Raise DatasetError unless `unit` converts into `expected`."""
    if not same_dimension(unit, expected):
        raise DatasetError(f"unit {unit!r} is of the wrong dimension; expected one that converts to {expected!r}")


def base_unit(unit: str) -> str:
    """The SI base form of `unit`, as text."""
    text = f"{_registry().get_base_units(parse(unit))[1]:~C}"
    return text or "1"


def convert(values: np.ndarray, *, unit: str, to: str) -> np.ndarray:
    """`values` in `unit`, shape (n,), expressed in `to`."""
    if unit == to or parse(unit) == parse(to):
        return values
    converted: np.ndarray = _registry().Quantity(values, parse(unit)).to(parse(to)).magnitude
    return converted


def convert_difference(value: float, *, unit: str, to: str) -> float:
    """A difference (a noise sd, a step) in `unit`, expressed in `to`: unlike `convert` it knows no zero point."""
    if unit == to or parse(unit) == parse(to):
        return value
    quantity = _registry().Quantity
    return value * float(quantity(1.0, parse(unit)).to(parse(to)).m - quantity(0.0, parse(unit)).to(parse(to)).m)


def _is_angular(unit: pint.Unit) -> bool:
    return "radian" in f"{_registry().get_base_units(unit)[1]}"


def _is_plain(unit: pint.Unit) -> bool:
    """Made of times only: "1" is an angle in radians and "1/s" a rate, as SI has it."""
    names = [str(name) for name in _registry().Quantity(1, unit).unit_items()]
    return all(dict(parse(name).dimensionality) == {"[time]": 1} for name in names)
