"""Expected and computed numbers side by side, and where each expected one comes from."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import pandas as pd

from tendonlab.arguments import choice

if TYPE_CHECKING:
    from pandas.io.formats.style import Styler

PAPER, DERIVED, RECONSTRUCTED, TWIN = STATUSES = ("paper", "derived", "reconstructed", "twin")
ROUNDING = 1e-11  # of the expected value: a difference that is due to doubles
COLUMNS = ("unit", "status", "expected", "computed", "difference", "tolerance", "within")


class Number(NamedTuple):
    """One number that can be computed: what it is, its unit, where its expected value comes from (`status`), the
    expected and the computed value, and how far they may differ.

    "paper": printed in the paper. "derived": follows from printed numbers by the equations. "reconstructed": computed
    separately from values that the paper does not print. "twin": read off a twin, which was made to meet
    the expected number: agreement shows only that the reconstruction is consistent. `bound`: the paper states a lower
    bound."""

    quantity: str
    unit: str
    status: str
    expected: float
    computed: float
    tolerance: float
    bound: bool = False

    @property
    def within(self) -> bool:
        """Whether they differ by no more than the tolerance, or the bound is exceeded."""
        difference = self.computed - self.expected
        return difference > 0 if self.bound else abs(difference) <= self.tolerance


def compared(numbers: Iterable[Number]) -> pd.DataFrame:
    """The table of all numbers, by quantity. Raises ParameterError for an unknown status."""
    rows = []
    for number in numbers:
        choice("status", number.status, STATUSES)
        computed = float(number.computed)
        rows.append(
            {
                "quantity": number.quantity,
                "unit": number.unit,
                "status": number.status + (", lower bound" if number.bound else ""),
                "expected": float(number.expected),
                "computed": computed,
                "difference": computed - number.expected,
                "tolerance": number.tolerance,
                "within": number.within,
            }
        )
    return pd.DataFrame(rows).set_index("quantity")[list(COLUMNS)]


def shown(table: pd.DataFrame) -> Styler:
    """The table for a notebook: five digits of the values, one of differences and tolerances below ten; a difference of
    rounding is none."""
    rounding = table["difference"].abs() <= ROUNDING * table["expected"].abs()
    formats: dict[Any, Any] = {
        **dict.fromkeys(("expected", "computed"), "{:.5g}"),
        **dict.fromkeys(("difference", "tolerance"), _short),
    }
    return table.assign(difference=table["difference"].mask(rounding, 0.0)).style.format(formats)


def _short(value: float) -> str:
    return f"{value:.1g}" if abs(value) < 9.5 else f"{value:.0f}"
