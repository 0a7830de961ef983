"""Drawing a bond graph: elements as words, bonds with half arrows, causal strokes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.bondgraph.causality import Causality, causality
from tendonlab.bondgraph.elements import Bond, Element, Junction
from tendonlab.bondgraph.graph import BondGraph
from tendonlab.errors import ParameterError
from tendonlab.plot.style import COLOURS, INK, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Place = tuple[float, float]


def draw(
    graph: BondGraph, ax: Axes | None = None, *, at: Mapping[str, Place] | None = None, strokes: bool = True
) -> Axes:
    """Draw `graph` on `ax`, or on the current axes.

    `at`: place of each element, in any unit of length, one unit being about the room of a bond; distances in the graph
    decide where it is not given. `strokes`: show causality, the bar at the end that receives the effort; the bars of
    inertias whose flow is forced on them (derivative causality) are coloured.
    Raises ParameterError for an element without a place."""
    import matplotlib.pyplot as plt

    ax = plt.gca() if ax is None else ax
    places = _spread(graph) if at is None else {name: np.array(place, dtype=float) for name, place in at.items()}
    for element in graph.elements:
        if element.name not in places:
            raise ParameterError(f"at: no place for {element.name!r}; expected one for every element")
    found = causality(graph) if strokes else None
    xy = np.array([places[e.name] for e in graph.elements])
    for bond in graph.bonds:
        _draw_bond(ax, bond, graph, places, found)
    for element in graph.elements:
        _write(ax, element, places[element.name])
    ax.set(aspect="equal", xlim=(xy[:, 0].min() - 0.6, xy[:, 0].max() + 0.6))
    ax.set_ylim(xy[:, 1].min() - 0.45, xy[:, 1].max() + 0.45)
    ax.axis("off")
    return ax


def _write(ax: Axes, element: Element, place: np.ndarray) -> None:
    is_junction = isinstance(element, Junction)
    weight = "bold" if is_junction else "normal"
    ax.text(
        place[0], place[1], element.text, ha="center", va="center", fontsize=9, color=INK, fontweight=weight, zorder=3
    )
    if is_junction and element.label:
        ax.text(place[0] + 0.07, place[1] - 0.06, element.label, ha="left", va="top", fontsize=8, color=MUTED, zorder=3)


def _clearance(element: Element, direction: np.ndarray) -> float:
    """How far from the middle of its text a bond ends: the edge of the box of its letters."""
    shown = element.text.replace("$", "").replace("\\", "").replace("_", "").replace("{", "").replace("}", "")
    half = np.array([0.07 + 0.037 * len(shown), 0.13])
    with np.errstate(divide="ignore"):
        return float(np.min(half / np.abs(direction)))


def _draw_bond(
    ax: Axes, bond: Bond, graph: BondGraph, places: Mapping[str, np.ndarray], found: Causality | None
) -> None:
    start, end = places[bond.tail], places[bond.head]
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    start = start + along * _clearance(graph.by_name[bond.tail], along)
    end = end - along * _clearance(graph.by_name[bond.head], along)
    ax.plot(*np.stack([start, end]).T, color=INK, lw=0.9, solid_capstyle="butt", zorder=2)
    barb = end - 0.11 * along + 0.07 * across
    ax.plot(*np.stack([end, barb]).T, color=INK, lw=0.9, zorder=2)
    if found is not None:
        stroke = found.stroke[bond]
        middle = end if stroke == bond.head else start
        tied = bond.ends & set(found.dependent)
        colour = COLOURS["with_effect"] if tied else COLOURS["refitted"]
        ax.plot(*np.stack([middle - 0.08 * across, middle + 0.08 * across]).T, color=colour, lw=1.8, zorder=2)


def _spread(graph: BondGraph) -> dict[str, np.ndarray]:
    """Places that keep the distances along bonds as well as a plane can (classical scaling)."""
    names = [e.name for e in graph.elements]
    index = {name: i for i, name in enumerate(names)}
    far = np.full((len(names), len(names)), float(len(names)))
    np.fill_diagonal(far, 0.0)
    for bond in graph.bonds:
        i, j = index[bond.tail], index[bond.head]
        far[i, j] = far[j, i] = 1.0
    for k in range(len(names)):
        far = np.minimum(far, far[:, k, None] + far[None, k, :])
    centre = np.eye(len(names)) - 1.0 / len(names)
    values, vectors = np.linalg.eigh(-0.5 * centre @ far**2 @ centre)
    xy = vectors[:, -2:][:, ::-1] * np.sqrt(np.maximum(values[-2:][::-1], 0.0))
    return {name: xy[i] for name, i in index.items()}
