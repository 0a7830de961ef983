"""Where a few drawn cases lie, and their truth."""

from pathlib import Path
from typing import NamedTuple


class Drawn(NamedTuple):
    cases: Path
    sealed: Path
