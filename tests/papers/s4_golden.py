"""The check numbers of S4, by their ids."""

import json
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

GOLDEN = Path(__file__).resolve().parents[1] / "golden" / "papers" / "S4.json"


@cache
def _all() -> dict[str, Any]:
    return {one["id"]: one for one in json.loads(GOLDEN.read_text(encoding="utf-8"))["checks"]}


def ids() -> list[str]:
    return list(_all())


def check(name: str) -> SimpleNamespace:
    """Input, expected values and tolerances of one check."""
    one = _all()[name]
    given = one["input"]
    return SimpleNamespace(given=SimpleNamespace(**given), expected=one["expected"], rtol=one["rtol"], atol=one["atol"])


def agree(found: dict[str, Any], name: str) -> None:
    """Each found value against the expected one of that name, at the tolerance of the check."""
    one = check(name)
    for key, value in found.items():
        np.testing.assert_allclose(value, one.expected[key], rtol=one.rtol, atol=one.atol, err_msg=f"{name}: {key}")
    assert set(found) == set(one.expected) - {"wrap"} | ({"wrap"} & set(found)), name


def reference() -> pd.DataFrame:
    """The reference trajectory, by time."""
    return pd.DataFrame(_all()["reference_trajectory"]["expected"]).set_index("t")
