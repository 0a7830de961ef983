"""Where a rehearsal keeps its cases: one JSON line each, next to a record of the settings that they belong to."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tendonlab.errors import DatasetError
from tendonlab.report.write import prepare_folder

FORMAT = "tendonlab-rehearsal-cases/1"
SETTINGS, CASES = "settings.json", "cases.jsonl"


class Store:
    """Cases that were diagnosed, by key. Without a folder they are kept in memory alone."""

    def __init__(self, out: Path | None, settings: Mapping[str, str]) -> None:
        """Open the folder `out`, or begin it. Raises DatasetError where it belongs to a rehearsal of other settings,
        ParameterError where it is a file."""
        self._file: Path | None = None
        self.rows: dict[str, dict[str, Any]] = {}
        if out is None:
            return
        prepare_folder(out)
        self._file = out / CASES
        if (out / SETTINGS).exists():
            _require_same(out, settings)
            self.rows = {row["case"]: row for row in _lines(self._file)}
        else:
            text = json.dumps({"format": FORMAT, "settings": dict(settings)}, indent=1)
            (out / SETTINGS).write_text(text + "\n", encoding="utf-8")
            self._file.write_text("", encoding="utf-8")

    def add(self, row: dict[str, Any]) -> None:
        """Keep a case, on disk at once."""
        self.rows[row["case"]] = row
        if self._file is not None:
            with self._file.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row, allow_nan=False) + "\n")


def _require_same(out: Path, settings: Mapping[str, str]) -> None:
    try:
        stored = json.loads((out / SETTINGS).read_text(encoding="utf-8"))
        theirs = stored["settings"] if stored["format"] == FORMAT else None
    except (ValueError, KeyError, TypeError):
        theirs = None
    if not isinstance(theirs, dict):
        raise DatasetError(f"{out / SETTINGS}: no record of a rehearsal; expected a new folder, or that of a rehearsal")
    other = [part for part, value in settings.items() if theirs.get(part) != value]
    if other:
        differs = f"belongs to another rehearsal (it differs in {' and '.join(other)})"
        raise DatasetError(f"{out}: {differs}; expected the same settings, or a new folder")


def _lines(file: Path) -> list[dict[str, Any]]:
    """The complete lines of the file. A line that an interruption cut short is removed from it."""
    if not file.exists():
        return []
    rows = []
    text = file.read_text(encoding="utf-8")
    for line in text.splitlines():
        try:
            rows.append(json.loads(line))
        except ValueError:
            continue
    whole = "".join(json.dumps(row, allow_nan=False) + "\n" for row in rows)
    if whole != text:
        file.write_text(whole, encoding="utf-8")
    return rows
