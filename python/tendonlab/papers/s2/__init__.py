"""S2: bond-graph model of a cable-driven joint, and friction of a cable in a bushing."""

from tendonlab.papers.s2 import equations, graphs
from tendonlab.papers.s2.constants import Constants, constants

__all__ = ["Constants", "constants", "equations", "graphs"]
