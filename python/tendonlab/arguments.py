"""Checks of arguments: each message names the argument, its value and what was expected."""

from __future__ import annotations

import math
from collections.abc import Sequence
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike

from tendonlab.errors import ParameterError, expected_one_of

JITTER = 0.01  # share of the sampling interval by which intervals may differ and still count as even


def reals(name: str, values: ArrayLike) -> np.ndarray:
    """`values` as floats in their own shape, finite or not; neither text nor complex numbers, and nothing masked."""
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        where = np.argwhere(np.ma.getmaskarray(values))[0]
        raise ParameterError(f"{name}[{', '.join(map(str, where))}] is masked: expected a number")
    try:
        given = np.asarray(values)
    except ValueError as error:  # rows of unequal lengths
        raise ParameterError(f"{name} holds rows of unequal lengths: expected real numbers") from error
    try:
        return given.astype(float, casting="unsafe" if given.dtype == object else "same_kind")
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{name} holds {given.dtype}: expected real numbers") from error


def samples(name: str, values: ArrayLike, *, fewest: int = 1) -> np.ndarray:
    """`values` as a row of finite floats, at least `fewest` of them."""
    row = reals(name, values)
    if row.ndim != 1:
        raise ParameterError(f"{name} has shape {row.shape}: expected one row of samples")
    if len(row) < fewest:
        raise ParameterError(f"{name} has {len(row)} samples: expected at least {fewest}")
    broken = np.flatnonzero(~np.isfinite(row))
    if broken.size:
        raise ParameterError(f"{name}[{broken[0]}] = {row[broken[0]]}: expected a finite number")
    return row


def times(time: ArrayLike, *, fewest: int = 2) -> np.ndarray:
    """Sampling times, s, that increase."""
    row = samples("time", time, fewest=fewest)
    back = np.flatnonzero(np.diff(row) <= 0.0)
    if back.size:
        k = back[0] + 1
        raise ParameterError(f"time[{k}] = {row[k]} s after {row[k - 1]} s: expected time to increase")
    return row


def along(time: np.ndarray, name: str, values: ArrayLike) -> np.ndarray:
    """Samples of a signal, one for each sampling time."""
    row = samples(name, values)
    if len(row) != len(time):
        raise ParameterError(f"{name} has {len(row)} samples: expected {len(time)}, as many as time")
    return row


def interval(time: np.ndarray) -> float:
    """The sampling interval, s, of times that are evenly spaced."""
    steps = np.diff(time)
    mean = float(time[-1] - time[0]) / len(steps)
    uneven = np.flatnonzero(np.abs(steps - mean) > JITTER * mean)
    if uneven.size:
        k = uneven[0]
        raise ParameterError(
            f"time[{k + 1}] - time[{k}] = {steps[k]:.6g} s: expected even sampling, {mean:.6g} s within 1 %; "
            "resample the record first"
        )
    return mean


def within(
    name: str,
    value: float,
    lower: float,
    upper: float,
    unit: str = "",
    *,
    open_lower: bool = False,
    open_upper: bool = False,
) -> float:
    """A finite number between two bounds, either of which may be excluded."""
    number = _number(value)
    inside = (lower < number if open_lower else lower <= number) and (number < upper if open_upper else number <= upper)
    if math.isfinite(number) and inside:
        return number
    shown = value if isinstance(value, Real) else f"{value!r:.60}"
    bounds = interval_text(lower, upper, unit, open_lower=open_lower, open_upper=open_upper)
    raise ParameterError(f"{name} = {shown}: expected {bounds}")


def interval_text(
    lower: float, upper: float, unit: str = "", *, open_lower: bool = False, open_upper: bool = False
) -> str:
    """ "a value in [0, 1) rad", for a message; a ratio has the unit "1" and shows none."""
    left, right = "(" if open_lower or math.isinf(lower) else "[", ")" if open_upper or math.isinf(upper) else "]"
    return f"a value in {left}{lower:g}, {upper:g}{right} {'' if unit == '1' else unit}".rstrip()


def _number(value: object) -> float:
    """A number as it is given; NaN for anything else, such as True or text that looks like a number."""
    given = np.asarray(value)
    return float(given) if given.ndim == 0 and given.dtype.kind in "iuf" else math.nan


def positive(name: str, value: float, unit: str = "") -> float:
    """A finite number above zero."""
    return within(name, value, 0.0, math.inf, unit, open_lower=True)


def whole(name: str, value: int, lower: int) -> int:
    """A whole number of at least `lower`."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < lower:
        raise ParameterError(f"{name} = {value!r}: expected a whole number of at least {lower}")
    return int(value)


def choice(name: str, value: str, known: Sequence[str]) -> str:
    """One of the known words."""
    if value not in known:
        raise ParameterError(f"{name} = {value!r}: {expected_one_of(value, known)}")
    return value
