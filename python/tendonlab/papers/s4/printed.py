"""The last table of the notebook: printed and computed values side by side."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pandas as pd

COLUMNS = ("quantity", "unit", "printed", "computed", "difference", "tolerance", "within")


def compare(quantity: str, unit: str, printed: float, computed: float, tolerance: float) -> dict[str, Any]:
    """One row: a value of the paper (reconstructed where it prints none), ours, and how far they may differ."""
    difference = float(computed) - float(printed)
    return dict(
        zip(COLUMNS, (quantity, unit, printed, float(computed), difference, tolerance, abs(difference) <= tolerance),
            strict=True)
    )  # fmt: skip


def differences(rows: Iterable[dict[str, Any]]) -> pd.DataFrame:
    """The table of all rows, by quantity."""
    return pd.DataFrame(list(rows), columns=list(COLUMNS)).set_index("quantity")
