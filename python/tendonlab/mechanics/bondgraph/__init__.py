"""Bond graphs: a system assembled from elements that exchange power, its right-hand side and its drawing (S2)."""

from tendonlab.mechanics.bondgraph.assignment import Causality, causality
from tendonlab.mechanics.bondgraph.drawing import draw
from tendonlab.mechanics.bondgraph.elements import (
    GY,
    MTF,
    TF,
    Bond,
    C,
    Element,
    I,
    Junction,
    One,
    R,
    Se,
    Sf,
    Source,
    Zero,
)
from tendonlab.mechanics.bondgraph.equations import Equations, derive
from tendonlab.mechanics.bondgraph.graph import BondGraph

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
