"""The check values of S3 by their id, and what its tests share."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

FILE = Path(__file__).resolve().parents[1] / "golden" / "papers" / "S3.json"
CHECKS: dict[str, Any] = {check["id"]: check for check in json.loads(FILE.read_text(encoding="utf-8"))["checks"]}


def given(name: str) -> Any:
    """Inputs of a check."""
    return CHECKS[name]["input"]


def require(name: str, key: str, found: Any) -> None:
    """That `found` is the expected value of a check, within its own tolerances."""
    check = CHECKS[name]
    np.testing.assert_allclose(found, check["expected"][key], rtol=check["rtol"], atol=check["atol"], err_msg=key)
