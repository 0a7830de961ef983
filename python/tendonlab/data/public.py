"""Writing the dataset folder of a public recording."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from tendonlab.errors import DatasetError


def write_folder(out: Path, description: str, records: Mapping[str, str]) -> None:
    """Write the text `records` by file name, then dataset.toml, into `out`. Raises DatasetError where `out` holds
    another dataset.toml."""
    existing = out / "dataset.toml"
    if existing.exists() and existing.read_text(encoding="utf-8") != description:
        raise DatasetError(
            f"{existing}: is there and differs from what would be written; remove it or give another out"
        )
    out.mkdir(parents=True, exist_ok=True)
    for name, text in records.items():
        _replace(out / name, text)
    _replace(existing, description)


def _replace(path: Path, text: str) -> None:
    """Write at once or not at all, so that an interrupted run leaves no half file."""
    partial = path.with_name(f"{path.name}.partial")
    partial.write_text(text, encoding="utf-8", newline="")
    os.replace(partial, path)
