"""Ctrl-C in the middle of a sweep, for the tests of the sweep and of its command."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest


@contextmanager
def small_tasks_and_ctrl_c(monkeypatch: pytest.MonkeyPatch, *, after: int) -> Iterator[None]:
    """Sweeps take one point a task, and Ctrl-C arrives once so many runs are noted."""

    def interrupted(steps: Any, **_: Any) -> Any:
        for done, step in enumerate(steps):
            if done == after:
                raise KeyboardInterrupt
            yield step

    with monkeypatch.context() as during:
        during.setattr("tendonlab.sweeping.sweep.track", interrupted)
        for seconds in ("FIRST_SECONDS", "TASK_SECONDS"):
            during.setattr(f"tendonlab.sweeping.sizes.{seconds}", 0.0)
        yield
