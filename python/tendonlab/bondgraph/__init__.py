"""Bond graphs: a system assembled from elements that exchange power, its right-hand side and its drawing (S2)."""

from tendonlab.bondgraph.causality import Causality, causality
from tendonlab.bondgraph.draw import draw
from tendonlab.bondgraph.elements import GY, MTF, TF, Bond, C, Element, I, Junction, One, R, Se, Sf, Source, Zero
from tendonlab.bondgraph.equations import Equations, derive
from tendonlab.bondgraph.graph import BondGraph

__all__ = [
    "GY",
    "MTF",
    "TF",
    "Bond",
    "BondGraph",
    "C",
    "Causality",
    "Element",
    "Equations",
    "I",
    "Junction",
    "One",
    "R",
    "Se",
    "Sf",
    "Source",
    "Zero",
    "causality",
    "derive",
    "draw",
]
