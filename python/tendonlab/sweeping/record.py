"""What every store on disk has: a record of the sweep that it belongs to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from tendonlab.sweeping.layout import Layout
from tendonlab.sweeping.storage import Storage


@dataclass(frozen=True)
class Record:
    """What a store says of itself. `size`: points per chunk; `cell`: shape of what is kept of a point; `parts`: the
    fingerprint of the sweep."""

    size: int
    cell: tuple[int, ...]
    parts: dict[str, str]

    def to_dict(self) -> dict[str, Any]:
        """As it is written."""
        return {"format": 1, "size": self.size, "cell": list(self.cell), "parts": self.parts}


def record_from(given: Mapping[str, Any]) -> Record:
    """What `to_dict` gave."""
    return Record(int(given["size"]), tuple(given["cell"]), dict(given["parts"]))


class Store(Storage, Protocol):
    """A storage on disk."""

    record: Record

    @staticmethod
    def create(folder: Path, layout: Layout, record: Record) -> None:
        """Make an empty store in a folder."""

    @classmethod
    def opened(cls, path: Path, layout: Layout) -> Store | None:
        """The store at `path`; None where something else is there."""
