"""Files that the diagnosis could open: a verdict given with the truth at hand checks nothing."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path

MOST_ENTRIES = 200_000  # files and folders; beyond them nothing is vouched for
HEAD = 4096  # bytes in which a file says what it is
TRUTH = re.compile(
    rb'^\s*format\s*=\s*["\']tendonlab-sealed/'  # what `draw` writes
    rb'|^case,effect,truth\b|"format":\s*"tendonlab-score/',  # what `score` writes tells the truth as well
    re.MULTILINE,
)


def refuse_truth(*folders: Path) -> None:
    """Raise ValueError where a file anywhere below one of `folders` holds a truth.

    That is a file with "sealed" in its name or in that of a folder on the way to it, and one that begins like what
    `draw` or `score` write, whatever its name; links are followed. Files that this process cannot open are passed over,
    because the diagnosis cannot open them either. Raises ValueError as well beyond MOST_ENTRIES files and folders."""
    for folder in folders:
        for count, path in enumerate(_below(folder), 1):
            if count > MOST_ENTRIES:
                raise ValueError(
                    f"{folder}: more than {MOST_ENTRIES} files and folders, too many to look for a sealed truth among; "
                    f"expected the cases, and the reports, in a folder of their own"
                )
            if os.path.isfile(path) and ("sealed" in str(path.relative_to(folder)).lower() or _tells(path)):
                raise ValueError(
                    f"{path}: a sealed truth, where the diagnosis could read it; expected none below {folder}: "
                    f"move it away before the run"
                )


def refuse_within_reach(sealed: Path, out: Path) -> None:
    """Raise ValueError where the folder of the truths and that of the cases and reports are one, or one lies in the
    other."""
    if sealed == out or out in sealed.parents or sealed in out.parents:
        raise ValueError(f"{sealed}: the diagnosis could read the truths there; expected a folder apart from {out}")


def _below(folder: Path) -> Iterator[Path]:
    """Every file and folder below `folder`; a folder that links lead to twice is opened once."""
    waiting, opened = [folder], set()
    while waiting:
        at = waiting.pop()
        if not os.path.isdir(at) or (real := os.path.realpath(at)) in opened:
            continue
        opened.add(real)
        try:
            found = sorted(at.iterdir())
        except FileNotFoundError:  # gone since it was listed
            continue
        except PermissionError:
            if os.access(at, os.X_OK):  # closed to a look around, open to who knows the names
                raise
            continue
        yield from found
        waiting += found


def _tells(path: Path) -> bool:
    try:
        with path.open("rb") as file:
            return TRUTH.search(file.read(HEAD)) is not None
    except (FileNotFoundError, PermissionError):
        return False
