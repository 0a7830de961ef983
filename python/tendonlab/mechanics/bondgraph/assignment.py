"""Which end of a bond decides its effort: sequential assignment (sources, storages, then resistors)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from tendonlab.errors import ParameterError
from tendonlab.mechanics.bondgraph.elements import GY, MTF, TF, Bond, C, Element, I, One, R, Se, Sf, Zero
from tendonlab.mechanics.bondgraph.graph import BondGraph


@dataclass(frozen=True)
class Causality:
    """`stroke`: the end of each bond that receives the effort and answers with the flow, where a drawing puts the bar.
    `independent`: storages in integral causality, whose p or q is a state; `dependent`: inertias whose flow is forced
    on them by others (derivative causality)."""

    stroke: dict[Bond, str]
    independent: tuple[str, ...]
    dependent: tuple[str, ...]


class _ContradictionError(Exception):
    pass


def causality(graph: BondGraph) -> Causality:
    """Assign causality. Storages take integral causality in the order of the graph's elements, so the first of two
    coupled inertias is the independent one.

    Raises ParameterError where sources contradict one another or a spring is forced into derivative causality."""
    stroke: dict[Bond, str] = {}
    for element in graph.elements:
        if isinstance(element, Se | Sf):
            bond = graph.at[element.name][0]
            end = element.name if isinstance(element, Sf) else bond.other(element.name)
            stroke = _try(graph, stroke, bond, end) or _refuse(element)
    independent: list[Element] = []
    dependent: list[Element] = []
    for element in graph.elements:
        if isinstance(element, I | C):
            bond = graph.at[element.name][0]
            wanted = element.name if isinstance(element, I) else bond.other(element.name)
            if bond not in stroke:
                stroke = _try(graph, stroke, bond, wanted) or stroke
            (independent if stroke.get(bond) == wanted else dependent).append(element)
    for spring in dependent:
        if isinstance(spring, C):
            raise ParameterError(f"C {spring.name}: its displacement is forced on it; expected an independent spring")
    for element in graph.elements:
        if isinstance(element, R) and graph.at[element.name][0] not in stroke:
            stroke = _first_that_fits(graph, stroke, graph.at[element.name][0])
    for bond in graph.bonds:
        if bond not in stroke:
            stroke = _first_that_fits(graph, stroke, bond)
    return Causality(stroke, tuple(e.name for e in independent), tuple(e.name for e in dependent))


def _first_that_fits(graph: BondGraph, stroke: dict[Bond, str], bond: Bond) -> dict[Bond, str]:
    for end in (bond.head, bond.tail):
        found = _try(graph, stroke, bond, end)
        if found:
            return found
    raise ParameterError(f"bond {bond.tail} -> {bond.head}: no causality fits; expected a graph whose junctions agree")


def _try(graph: BondGraph, stroke: dict[Bond, str], bond: Bond, end: str) -> dict[Bond, str] | None:
    """`stroke` with one more bond and all that follows from it, None where that contradicts itself."""
    found = dict(stroke)
    todo = [(bond, end)]
    try:
        while todo:
            one, at = todo.pop()
            if found.get(one, at) != at:
                return None
            if one not in found:
                found[one] = at
                todo += [each for name in (one.tail, one.head) for each in _forced(graph.by_name[name], graph, found)]
    except _ContradictionError:
        return None
    return found


def _forced(element: Element, graph: BondGraph, stroke: dict[Bond, str]) -> Iterator[tuple[Bond, str]]:
    """Causality that the constraint of one element forces on its other bonds."""
    bonds = graph.at[element.name]
    near = [b for b in bonds if stroke.get(b) == element.name]
    far = [b for b in bonds if b in stroke and stroke[b] != element.name]
    free = [b for b in bonds if b not in stroke]
    if isinstance(element, Zero):
        yield from _one_of(element, near, free, len(bonds), near_is_rare=True)
    elif isinstance(element, One):
        yield from _one_of(element, far, free, len(bonds), near_is_rare=False)
    elif isinstance(element, TF | MTF):
        if len(near) == 2 or len(far) == 2:
            raise _ContradictionError
        yield from ((b, b.other(element.name) if near else element.name) for b in free if near or far)
    elif isinstance(element, GY):
        if near and far:
            raise _ContradictionError
        yield from ((b, element.name if near else b.other(element.name)) for b in free if near or far)


def _one_of(
    element: Element, rare: list[Bond], free: list[Bond], count: int, *, near_is_rare: bool
) -> Iterator[tuple[Bond, str]]:
    """A junction: exactly one of its bonds is unlike the others."""
    if len(rare) > 1 or (not rare and not free and count):
        raise _ContradictionError
    if rare:
        yield from ((b, b.other(element.name) if near_is_rare else element.name) for b in free)
    elif len(free) == 1:
        yield free[0], element.name if near_is_rare else free[0].other(element.name)


def _refuse(element: Element) -> dict[Bond, str]:
    raise ParameterError(f"{element.kind} {element.name}: contradicts another source; expected one to decide each flow")
