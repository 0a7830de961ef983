"""Drawing a bond graph: elements as words, bonds with half arrows, causal strokes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.arguments import samples
from tendonlab.errors import ParameterError
from tendonlab.mechanics.bondgraph.assignment import Causality, causality
from tendonlab.mechanics.bondgraph.elements import Bond, Element, Junction
from tendonlab.mechanics.bondgraph.graph import BondGraph

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Place = tuple[float, float]
INK, MUTED = "#1b1f24", "#5b6570"
INTEGRAL, DIFFERENTIAL = "#0072b2", "#d55e00"  # causality of an element: Okabe–Ito blue and vermilion
_SIZE = 9.0  # of letters, points


def draw(
    graph: BondGraph, ax: Axes | None = None, *, at: Mapping[str, Place] | None = None, strokes: bool = True
) -> Axes:
    """Draw `graph` on `ax`, or on the current axes.

    `at`: place of each element, in any unit of length, one unit being about the room of a bond; distances in the graph
    decide where it is not given. `strokes`: show causality, the bar at the end that receives the effort; the bars of
    inertias whose flow is forced on them (derivative causality) are coloured.
    Raises ParameterError for a graph without elements, an element without a place, a place that is not two numbers."""
    import matplotlib.pyplot as plt

    if not graph.elements:
        raise ParameterError("graph.elements = (): expected one element or more")
    places = _spread(graph) if at is None else {name: _place(name, place) for name, place in at.items()}
    for element in graph.elements:
        if element.name not in places:
            raise ParameterError(f"at: no place for {element.name!r}; expected one for every element")
    ax = plt.gca() if ax is None else ax
    inches = _scale(ax, np.array([places[e.name] for e in graph.elements]))
    found = causality(graph) if strokes else None
    for bond in graph.bonds:
        _draw_bond(ax, bond, graph, places, found, inches)
    for element in graph.elements:
        away = [places[b.other(element.name)] - places[element.name] for b in graph.at[element.name]]
        _write(ax, element, places[element.name], _widest_gap(away), inches)
    return ax


def _place(name: str, place: Place) -> np.ndarray:
    row = samples(f"at[{name!r}]", place)
    if len(row) != 2:
        raise ParameterError(f"at[{name!r}] = {place}: expected two numbers, x and y")
    return row


def _scale(ax: Axes, xy: np.ndarray) -> float:
    """Sets the limits of `ax` around the places; inches a unit of length, so that letters and bonds keep clear."""
    margin = np.array([0.75, 0.5])
    low, high = xy.min(axis=0) - margin, xy.max(axis=0) + margin
    ax.set(aspect="equal", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    ax.axis("off")
    figure = ax.get_figure(root=True)
    assert figure is not None
    figure.draw_without_rendering()  # layouts move axes
    box = ax.get_window_extent()
    return float(min(box.width / (high[0] - low[0]), box.height / (high[1] - low[1])) / figure.dpi)


def _widest_gap(ways: list[np.ndarray]) -> np.ndarray:
    """The direction farthest from all bonds: room for a label."""
    angles = np.sort([np.arctan2(way[1], way[0]) for way in ways])
    gaps = np.diff(np.append(angles, angles[0] + 2.0 * np.pi))
    k = int(np.argmax(np.round(gaps, 6)))
    middle = float(angles[k] + 0.5 * gaps[k])
    return np.array([np.cos(middle), np.sin(middle)])


def _write(ax: Axes, element: Element, place: np.ndarray, room: np.ndarray, inches: float) -> None:
    is_junction = isinstance(element, Junction)
    weight = "bold" if is_junction else "normal"
    x, y = place
    ax.text(x, y, element.text, ha="center", va="center", fontsize=_SIZE, color=INK, fontweight=weight, zorder=3)
    if is_junction and element.label:
        aside = place + room * 0.26 / inches
        small = _SIZE - 1.0
        ax.text(aside[0], aside[1], element.label, ha="center", va="center", fontsize=small, color=MUTED, zorder=3)


def _clearance(element: Element, direction: np.ndarray) -> float:
    """How far from the middle of its text a bond ends, inch: the edge of its letters, a circle round a junction."""
    from matplotlib.textpath import TextPath

    if isinstance(element, Junction):
        return 0.13
    letters = TextPath((0.0, 0.0), element.text, size=_SIZE).get_extents()
    half = np.array([letters.width / 2.0 + 4.5, 9.0]) / 72.0
    with np.errstate(divide="ignore"):
        return float(np.min(half / np.abs(direction)))


def _draw_bond(
    ax: Axes, bond: Bond, graph: BondGraph, places: Mapping[str, np.ndarray], found: Causality | None, inches: float
) -> None:
    start, end = places[bond.tail], places[bond.head]
    along = (end - start) / np.linalg.norm(end - start)
    across = np.array([-along[1], along[0]])
    start = start + along * _clearance(graph.by_name[bond.tail], along) / inches
    end = end - along * _clearance(graph.by_name[bond.head], along) / inches
    barb = end + (-0.09 * along + 0.055 * across) / inches
    ax.plot(*np.stack([start, end]).T, color=INK, lw=0.9, solid_capstyle="butt", zorder=2)
    ax.plot(*np.stack([end, barb]).T, color=INK, lw=0.9, zorder=2)
    if found is not None:
        middle = end if found.stroke[bond] == bond.head else start
        colour = DIFFERENTIAL if bond.ends & set(found.dependent) else INTEGRAL
        bar = 0.065 * across / inches
        ax.plot(*np.stack([middle - bar, middle + bar]).T, color=colour, lw=1.8, zorder=2)


def _spread(graph: BondGraph) -> dict[str, np.ndarray]:
    """Places that keep the distances along bonds as well as a plane can (stress majorisation)."""
    names = [e.name for e in graph.elements]
    index = {name: i for i, name in enumerate(names)}
    far = np.full((len(names), len(names)), float(len(names)))
    np.fill_diagonal(far, 0.0)
    for bond in graph.bonds:
        i, j = index[bond.tail], index[bond.head]
        far[i, j] = far[j, i] = 1.0
    for k in range(len(names)):
        far = np.minimum(far, far[:, k, None] + far[None, k, :])
    xy = np.random.default_rng(0).normal(size=(len(names), 2))  # breaks symmetry, always in the same way
    for _ in range(300):
        apart = np.linalg.norm(xy[:, None] - xy[None, :], axis=2)
        pull = -np.divide(far, apart, out=np.zeros_like(far), where=apart > 0)
        np.fill_diagonal(pull, -pull.sum(axis=1))
        xy = pull @ xy / len(names)
    return {name: xy[i] for name, i in index.items()}
