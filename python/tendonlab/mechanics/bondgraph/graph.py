"""A bond graph: elements, bonds and positions, checked when it is made."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

from tendonlab.errors import ParameterError
from tendonlab.mechanics.bondgraph.elements import MTF, Bond, C, Element, I, One, R, Source


@dataclass(frozen=True, kw_only=True)
class BondGraph:
    """Elements joined by bonds. `positions`: name of a position -> the 1-junction whose flow is its rate; modulated
    transformers look at them.

    Raises ParameterError for names that are used twice (by a position and an element, too) or unknown, and for elements
    with a wrong number of bonds."""

    elements: Sequence[Element]
    bonds: Sequence[Bond]
    positions: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        twice = [name for name, count in Counter(e.name for e in self.elements).items() if count > 1]
        if twice:
            raise ParameterError(f"duplicate element name {twice[0]!r}")
        if len(set(self.bonds)) < len(self.bonds):
            raise ParameterError("bonds: duplicate bond; expected at most one from an element to another")
        for bond in self.bonds:
            for end in (bond.tail, bond.head):
                if end not in self.by_name:
                    raise ParameterError(f"bond {bond.tail} -> {bond.head}: no element {end!r}")
        for element in self.elements:
            self._require_bonds(element)
        for name, junction in self.positions.items():
            if name in self.by_name:
                raise ParameterError(f"position {name!r}: an element has that name; expected a different name")
            if not isinstance(self.by_name.get(junction), One):
                raise ParameterError(f"position {name!r}: {junction!r} is no 1-junction; expected the name of one")

    @classmethod
    def of(
        cls, elements: Sequence[Element], bonds: Sequence[tuple[str, ...]], positions: Mapping[str, str] | None = None
    ) -> BondGraph:
        """A graph from chains of names: ("V", "loop", "k") is a bond from V to loop and one from loop to k."""
        pairs = [Bond(tail, head) for chain in bonds for tail, head in pairwise(chain)]
        return cls(elements=tuple(elements), bonds=tuple(pairs), positions=dict(positions or {}))

    @cached_property
    def by_name(self) -> dict[str, Element]:
        """Elements by name."""
        return {e.name: e for e in self.elements}

    @cached_property
    def at(self) -> dict[str, tuple[Bond, ...]]:
        """Bonds of every element."""
        return {e.name: tuple(b for b in self.bonds if e.name in b.ends) for e in self.elements}

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the sources without a value of their own."""
        return tuple(e.name for e in self.elements if isinstance(e, Source) and e.value is None)

    def _require_bonds(self, element: Element) -> None:
        own = self.at[element.name]
        if element.num_bonds is not None and len(own) != element.num_bonds:
            raise ParameterError(
                f"{element.kind} {element.name}: {len(own)} bonds; expected {element.num_bonds} at this kind of element"
            )
        if element.num_bonds == 2 and own[0].sign(element.name) == own[1].sign(element.name):
            raise ParameterError(f"{element.kind} {element.name}: expected one bond in and one out")
        if isinstance(element, I | C | R) and own[0].head != element.name:
            raise ParameterError(f"{element.kind} {element.name}: its bond leaves it; expected power to flow into it")
        position = element.of if isinstance(element, MTF | R) else ""
        if position not in self.positions and (position or isinstance(element, MTF)):
            raise ParameterError(f"{element.kind} {element.name}: no position {position!r} in the graph")
