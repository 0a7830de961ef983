"""From a graph to its right-hand side: the end that decides an effort or a flow computes it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from tendonlab.arguments import choice, within
from tendonlab.errors import ParameterError
from tendonlab.mechanics.bondgraph.assignment import Causality, causality
from tendonlab.mechanics.bondgraph.elements import GY, MTF, TF, Bond, C, Element, I, Junction, One, R, Source, Zero
from tendonlab.mechanics.bondgraph.graph import BondGraph

_STEP = 1e-30  # of complex differentiation: nothing is subtracted, so it may be as small as we like


@dataclass(frozen=True)
class Equations:
    """The state equations of a graph. `states`: momenta of independent inertias and displacements of springs under
    the names of their elements, then the positions."""

    graph: BondGraph
    causality: Causality
    states: tuple[str, ...]

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the sources without a value of their own."""
        return self.graph.inputs

    def rates(self, state: Mapping[str, float], inputs: Mapping[str, float] | None = None) -> dict[str, float]:
        """Rate of every state. `state`, `inputs`: one value per name, SI.

        Raises ParameterError for a missing or unknown name, a value that is not finite, and for resistors that only a
        loop of equations would decide."""
        given = self._given(state, inputs or {})
        if self.causality.dependent:
            given.reactions = self._reactions(given)
        return {name: float(np.real(given.rate(name))) for name in self.states}

    def bond_values(
        self, state: Mapping[str, float], inputs: Mapping[str, float] | None = None
    ) -> dict[Bond, tuple[float, float]]:
        """Effort and flow of every bond, where power = effort * flow counts from tail to head."""
        given = self._given(state, inputs or {})
        if self.causality.dependent:
            given.reactions = self._reactions(given)
        return {b: (float(np.real(given.effort(b))), float(np.real(given.flow(b)))) for b in self.graph.bonds}

    def _given(self, state: Mapping[str, float], inputs: Mapping[str, float]) -> _At:
        for what, values, known in (("state", state, self.states), ("input", inputs, self.inputs)):
            for name, value in values.items():
                choice(what, name, known)
                within(f"{what} {name!r}", value, -np.inf, np.inf)
        return _At(self, dict(state), dict(inputs))

    def _reactions(self, given: _At) -> dict[str, float]:
        """Efforts of inertias that must follow others: (M + T' M_d T) f' = e - T' M_d T'_t f, solved for M_d (T f)'.

        T, flows of the dependent inertias per flow of the independent ones, comes column by column from the graph
        itself, its rate by a complex step along the positions."""
        self._require_undriven(given)
        free = [i for i in self._inertias if i.name in self.causality.independent]
        tied = [i for i in self._inertias if i.name in self.causality.dependent]
        masses = np.array([i.inertia for i in free])
        tied_masses = np.array([i.inertia for i in tied])
        columns = [self._flows(given, tied, {i.name: i.inertia if i is one else 0.0 for i in free}) for one in free]
        shape = np.array([c.real for c in columns]).T.reshape(len(tied), len(free))
        moving = self._flows(given.displaced(), tied, {i.name: given.state[i.name] for i in free}).imag / _STEP
        given.reactions = dict.fromkeys(self.causality.dependent, 0.0)
        pushed = np.array([float(np.real(given.rate(i.name))) for i in free])
        given.forget()
        acceleration = np.linalg.solve(
            np.diag(masses) + shape.T @ (tied_masses[:, None] * shape), pushed - shape.T @ (tied_masses * moving)
        )
        efforts = tied_masses * (shape @ acceleration + moving)
        return dict(zip((i.name for i in tied), efforts.tolist(), strict=True))

    def _flows(self, given: _At, tied: list[I], momenta: dict[str, Any]) -> np.ndarray:
        """Flows of the dependent inertias where the independent ones have these momenta and sources rest."""
        still = dict.fromkeys(self.inputs, 0.0)
        alone = _At(self, {**given.state, **momenta}, still, rest=True)
        return np.array([alone.flow(self.graph.at[i.name][0]) for i in tied], dtype=complex)

    def _require_undriven(self, given: _At) -> None:
        """A source that drives an inertia would have to be differentiated."""
        frozen = {**given.state, **{i.name: 0.0 for i in self._inertias}}
        driven = _At(self, frozen, dict.fromkeys(self.inputs, 1.0))
        for name in self.causality.dependent:
            if driven.flow(self.graph.at[name][0]) != 0:
                raise ParameterError(f"I {name}: driven by a source of flow; expected a source of effort there")

    @cached_property
    def _inertias(self) -> list[I]:
        return [e for e in self.graph.elements if isinstance(e, I)]


def derive(graph: BondGraph) -> Equations:
    """Assign causality and give the state equations. Raises ParameterError as `causality` does."""
    found = causality(graph)
    return Equations(graph, found, found.independent + tuple(graph.positions))


@dataclass
class _At:
    """One instant: efforts and flows, each worked out once."""

    of: Equations
    state: dict[str, Any]
    inputs: dict[str, Any]
    rest: bool = False
    reactions: dict[str, Any] = field(default_factory=dict)
    known: dict[tuple[str, Bond], Any] = field(default_factory=dict)

    def forget(self) -> None:
        self.known.clear()

    def displaced(self) -> _At:
        """The same instant, a complex step further along the rates of the positions."""
        moved = {name: self.state[name] + 1j * _STEP * self.rate(name) for name in self.of.graph.positions}
        return _At(self.of, {**self.state, **moved}, self.inputs)

    def rate(self, state: str) -> Any:
        graph = self.of.graph
        if state in graph.positions:
            junction = graph.positions[state]
            return self.flow(graph.at[junction][0])
        bond = graph.at[state][0]
        return self.effort(bond) if isinstance(graph.by_name[state], I) else self.flow(bond)

    def effort(self, bond: Bond) -> Any:
        return self._of("effort", bond, bond.other(self.of.causality.stroke[bond]))

    def flow(self, bond: Bond) -> Any:
        return self._of("flow", bond, self.of.causality.stroke[bond])

    def _of(self, what: str, bond: Bond, decides: str) -> Any:
        key = (what, bond)
        if key in self.known:
            if self.known[key] is None:
                raise ParameterError(f"{what} of {bond.tail} -> {bond.head}: decided by a loop; expected none")
            return self.known[key]
        self.known[key] = None
        element = self.of.graph.by_name[decides]
        value = self._two_port(what, element, bond) if element.num_bonds != 1 else self._one_port(what, element, bond)
        self.known[key] = value
        return value

    def _one_port(self, what: str, element: Element, bond: Bond) -> Any:
        if isinstance(element, Source):
            if element.value is None:
                return self._input(element.name)
            return 0.0 if self.rest and what == "flow" else element.value
        if isinstance(element, I):
            return self._state(element.name) / element.inertia if what == "flow" else self.reactions[element.name]
        if isinstance(element, C):
            return element.of(self._state(element.name))
        assert isinstance(element, R)
        position = (self._state(element.of),) if element.of else ()
        if what == "effort":
            return element.effort_of(self.flow(bond), *position)
        return element.flow_of(self.effort(bond), *position)

    def _two_port(self, what: str, element: Element, bond: Bond) -> Any:
        own = self.of.graph.at[element.name]
        if isinstance(element, Junction):
            return self._junction(what, element, bond)
        other = own[1] if bond == own[0] else own[0]
        enters = bond.head == element.name
        if isinstance(element, GY):
            return element.ratio * self.flow(other) if what == "effort" else self.effort(other) / element.ratio
        assert isinstance(element, TF | MTF)
        ratio = element.at(self._state(element.of) if isinstance(element, MTF) else None)
        if what == "effort":
            return ratio * self.effort(other) if enters else self.effort(other) / ratio
        return self.flow(other) / ratio if enters else ratio * self.flow(other)

    def _junction(self, what: str, element: Element, bond: Bond) -> Any:
        """The bond that decides the common variable passes it on; the other variable is summed to zero."""
        others = [b for b in self.of.graph.at[element.name] if b != bond]
        ask = self.effort if what == "effort" else self.flow
        common = isinstance(element, One) == (what == "flow") and isinstance(element, One | Zero)
        if common:
            stroke = self.of.causality.stroke
            rare = [b for b in others if (stroke[b] == element.name) == (what == "effort")]
            return ask(rare[0])
        return -bond.sign(element.name) * sum(b.sign(element.name) * ask(b) for b in others)

    def _state(self, name: str) -> Any:
        if name not in self.state:
            raise ParameterError(f"state {name!r}: missing; expected {', '.join(self.of.states)}")
        return self.state[name]

    def _input(self, name: str) -> Any:
        if name not in self.inputs:
            raise ParameterError(f"input {name!r}: missing; expected {', '.join(self.of.inputs)}")
        return self.inputs[name]
