"""The tables of the papers, and reconstructed values that they lack, as the package carries them."""

from __future__ import annotations

from importlib.resources import files

import pandas as pd

from tendonlab.errors import ParameterError, expected_one_of


def tables() -> tuple[str, ...]:
    """Names of all tables, "S4_table2_parameters" and the like."""
    folder = files("tendonlab").joinpath("bundled", "papers")
    names = (item.name for item in folder.iterdir()) if folder.is_dir() else ()
    return tuple(sorted(name.removesuffix(".csv") for name in names if name.endswith(".csv")))


def table(name: str) -> pd.DataFrame:
    """One table by its name; columns as in its file, values as printed unless a column says SI.

    Raises ParameterError for an unknown name."""
    if name not in tables():
        raise ParameterError(f"table = {name!r}: {expected_one_of(name, tables())}")
    with files("tendonlab").joinpath("bundled", "papers", f"{name}.csv").open(encoding="utf-8") as text:
        return pd.read_csv(text)
