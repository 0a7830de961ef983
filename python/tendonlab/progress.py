"""Progress of long work: a bar in a terminal or a notebook, now and then a line in a log."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Iterator
from importlib.util import find_spec
from typing import Any, Generic, TypeVar

INTERVAL = 10.0  # s between two lines of a log
_Item = TypeVar("_Item")


def track(
    items: Iterable[_Item],
    *,
    label: str,
    total: int,
    done: int = 0,
    unit: str = "step",
    shown: bool = True,
    stays: bool = True,
) -> Iterable[_Item]:
    """`items`, with progress and the time left shown on the way unless not `shown`; a bar that `stays` is there when
    the work is done. `done`: how many of `total` were done before."""
    if not shown:
        return items
    if _in_notebook():
        return _notebook_bar(items, desc=label, total=total, initial=done, unit=unit, leave=stays)
    if sys.stderr.isatty():
        from tqdm import tqdm

        shown_bar: Iterable[_Item] = tqdm(items, desc=label, total=total, initial=done, unit=unit, leave=stays)
        return shown_bar
    return LogLines(items, label=label, total=total, done=done, unit=unit)


class LogLines(Generic[_Item]):
    """Items with a line on stderr for every `INTERVAL` seconds, whichever work prints it."""

    _printed = time.monotonic()

    def __init__(self, items: Iterable[_Item], *, label: str, total: int, unit: str, done: int = 0) -> None:
        self._items, self._label, self._total, self._unit, self._done = items, label, total, unit, done

    def __iter__(self) -> Iterator[_Item]:
        began = time.monotonic()
        for count, item in enumerate(self._items, start=1):
            yield item
            now = time.monotonic()
            if now - LogLines._printed >= INTERVAL:
                LogLines._printed = now
                done = self._done + count
                left = duration((now - began) / count * (self._total - done))
                text = f"{self._label}: {done} of {self._total} {self._unit}s, {left} left"
                print(text, file=sys.stderr, flush=True)


def duration(seconds: float) -> str:
    """A duration in words, such as "40 s", "12 min" or "3.5 h"."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _in_notebook() -> bool:
    return "ipykernel" in sys.modules


def _notebook_bar(items: Iterable[_Item], **given: Any) -> Iterable[_Item]:
    """A widget, or text among the results where widgets are not installed: a notebook shows stderr as an error."""
    if find_spec("ipywidgets") is not None:
        from tqdm.notebook import tqdm as bar
    else:
        from tqdm import tqdm as bar

        given["file"] = sys.stdout
    shown: Iterable[_Item] = bar(items, **given)
    return shown
