"""What a folder was begun with, which a call that goes on there must not change."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any


def plain_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Settings as a JSON file holds them."""
    return dict(json.loads(json.dumps(settings)))


def refuse_other(path: Path, begun: Mapping[str, Any], asked: Mapping[str, Any]) -> None:
    """Raise ValueError where a setting is another one than the file `path` has."""
    for name, value in asked.items():
        if begun.get(name) != value:
            raise ValueError(f"{path}: {name} = {value}: expected {begun.get(name)}, with which this was begun")
