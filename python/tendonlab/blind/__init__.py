"""Blind check of the diagnosis: an independent generator of synthetic rigs, the runner that never sees the truth,
the scorer.

The generator shares only the data format with the rest of tendonlab: no law, no stepper, no catalogue.
"""

from .drawing import draw
from .runner import run
from .scoring import Score, score

__all__ = ["Score", "draw", "run", "score"]
