"""Blind check of the diagnosis: an independent generator of synthetic rigs, the runner that never sees the truth,
the scorer.

The generator shares only the data format with the rest of tendonlab: no law, no stepper, no catalogue.
"""

from importlib import import_module as _import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .drawing import draw
    from .runner import run
    from .scoring import Score, score

__all__ = ["Score", "draw", "run", "score"]

_HOME_OF = {"draw": "drawing", "run": "runner", "Score": "scoring", "score": "scoring"}

if not TYPE_CHECKING:  # loaded when first used, so that `tendonlab --help` takes no time

    def __getattr__(name: str) -> object:
        if name not in _HOME_OF:
            raise AttributeError(f"module 'tendonlab.blind' has no attribute {name!r}")
        return getattr(_import_module(f".{_HOME_OF[name]}", __name__), name)
