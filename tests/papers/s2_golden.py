"""The check values of S2 by name."""

import json
from pathlib import Path
from typing import Any

CHECKS: dict[str, dict[str, Any]] = {
    check["name"]: check
    for check in json.loads((Path(__file__).parents[1] / "golden" / "papers" / "S2.json").read_text(encoding="utf-8"))[
        "checks"
    ]
}


def named(prefix: str) -> list[str]:
    """Names of the checks that begin with `prefix`; there is at least one."""
    found = [name for name in CHECKS if name.startswith(prefix)]
    assert found, prefix
    return found
