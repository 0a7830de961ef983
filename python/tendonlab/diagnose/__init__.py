"""Where the sim-to-real gap lies, which unmodelled effect causes it, and how far it shrinks once that is added."""

from tendonlab.diagnose.procedure import diagnose
from tendonlab.diagnose.result import Diagnosis, EffectFinding

__all__ = ["Diagnosis", "EffectFinding", "diagnose"]
