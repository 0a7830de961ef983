"""A simulator: a system of the library with numbers in it and the effects it contains."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from tendonlab import _core
from tendonlab.arguments import choice, interval_text, within
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.simulation.catalog import (
    AXES,
    DEFAULTED,
    LEVEL,
    MEMORY,
    PORT_QUANTITIES,
    SystemInfo,
    parameter_unit,
    system_info,
)
from tendonlab.simulation.frozen import FrozenNumbers
from tendonlab.simulation.records import Controller

if TYPE_CHECKING:
    import pandas as pd

    from tendonlab.simulation.records import Experiment
    from tendonlab.simulation.trajectory import Trajectory


@dataclass(frozen=True)
class System:
    """A simulator of one `kind` (see `kinds`) on a "rotary" or "linear" axis. `parameters` holds the value, SI, of each
    parameter of the system and of its `effects` ("joint:stribeck"); `controller` closes its loop in a replay where it
    is known. It never changes: `with_parameters` and `with_effects` give a new one.

    Raises ParameterError for an unknown or missing name or a value outside its bounds."""

    kind: str
    _: KW_ONLY
    parameters: Mapping[str, float] = field(default_factory=dict)
    effects: tuple[str, ...] = ()
    axis: str = "rotary"
    controller: Controller | None = None

    def __post_init__(self) -> None:
        _check_types(self)
        object.__setattr__(self, "effects", tuple(self.effects))
        for name in self.effects:
            self._require_company(name)
        known = self._own_names
        for name, value in self.parameters.items():
            if name not in known:
                raise ParameterError(f"{name} = {value}: {self._why_unknown(name, known)}")
        usual = [p for p in self.info.parameters if p.purpose == "condition" or p.role in DEFAULTED]
        given = {**{p.name: p.typical for p in usual if p.name in known}, **self.parameters}
        self._require_all(known, given)
        checked = FrozenNumbers({name: self._within(name, value) for name, value in given.items()})
        object.__setattr__(self, "parameters", checked)

    @property
    def info(self) -> SystemInfo:
        """The tables of this kind of system."""
        return system_info(self.kind)

    def unit(self, name: str) -> str:
        """Unit of a parameter on this system's axis, as in "N*m*s/rad". Raises ParameterError for an unknown one."""
        return parameter_unit(self.info, self.info.parameter(name), self.axis)

    def with_parameters(self, values: Mapping[str, float]) -> System:
        """The same simulator with other values, SI, for some parameters. Raises ParameterError as System does."""
        return replace(self, parameters={**self.parameters, **values})

    def with_effects(self, effects: Mapping[str, Mapping[str, float]]) -> System:
        """The simulator with effects added: {"joint:stribeck": {"static_excess": 0.1, "stribeck_velocity": 0.05}}.

        Parameters go by their own or their full name, values are SI. An effect whose amplitude is exactly 0 changes
        nothing, to the last bit. Raises ParameterError for an unknown effect or parameter, or where one is missing."""
        if not isinstance(effects, Mapping) or not all(isinstance(given, Mapping) for given in effects.values()):
            raise ParameterError(f"effects = {effects!r}: expected {{effect: {{parameter: value}}}}")
        values = dict(self.parameters)
        names = list(self.effects)
        for name, given in effects.items():
            effect = self.info.effect(name)
            own = {self.info.parameter(full).own: full for full in effect.parameters}
            for key, value in given.items():
                full = own.get(key, key)
                if full not in effect.parameters:
                    raise ParameterError(f"{key} = {value}: no parameter of {name}; {expected_one_of(key, own)}")
                values[full] = value
            if name not in names:
                names.append(name)
        return replace(self, parameters=values, effects=tuple(names))

    def values(self) -> list[float]:
        """One value per parameter of the core, in its order; effects that are off get any allowed number."""
        return list(self._values)

    @cached_property
    def _values(self) -> tuple[float, ...]:
        own = set(self._own_names)
        return tuple(
            float(self.parameters.get(p.name, p.typical if p.purpose == "share" else 0.0))
            if p.name in own
            else min(max(0.0 if p.purpose == "amplitude" else p.typical, p.lower), p.upper)
            for p in self.info.parameters
        )

    def active(self, *, keep_zero: bool = False) -> list[bool]:
        """One flag per effect of the core. An effect whose amplitude is exactly 0 is off, unless `keep_zero`."""
        if keep_zero:
            return [e.structural or e.name in self.effects for e in self.info.effects]
        return list(self._active)

    @cached_property
    def _active(self) -> tuple[bool, ...]:
        return tuple(self.active_at(np.array(self._values)).tolist())

    def active_at(self, values: np.ndarray) -> np.ndarray:
        """One flag per effect, shape (..., effects), for values as `values` gives them, shape (..., parameters)."""
        active = np.zeros((*values.shape[:-1], len(self.info.amplitudes)), dtype=bool)
        for e, (name, amplitudes) in enumerate(self.info.amplitudes.items()):
            if amplitudes is None:
                active[..., e] = True
            elif name in self.effects:
                active[..., e] = (values[..., amplitudes] != 0.0).any(axis=-1)
        return active

    def simulate(
        self,
        experiment: Experiment | pd.DataFrame,
        *,
        tolerance: float = 1e-6,
        ports: bool = False,
        replay: str = "auto",
    ) -> Trajectory:
        """Simulate what `experiment` applied, and give outputs at its instants.

        `experiment`: an experiment of a dataset (its conditions fix parameters, its `add` adds to them), or a frame
        indexed by time, s, with one column per input. `replay`: "controller" (rig and known controller in free run),
        "free" (logged inputs only) or "auto" (the controller where the simulator knows it and the reference was
        logged). `tolerance`: relative error of a step. `ports`: also what each port sees and does.
        Raises DatasetError for a missing input or one that is no number, NumericalError where the integration fails."""
        from tendonlab.simulation.prepare import as_experiment, choose_loop, prepare
        from tendonlab.simulation.trajectory import trajectory_of

        record = as_experiment(experiment)
        system = self.under(record)
        ready = prepare(record, system, choose_loop(record, self.controller, replay))
        settings = ready.settings(tolerance, ports=PORT_QUANTITIES if ports else ())
        run = _core.simulate(self.kind, system.values(), system.active(), ready.core, [], settings)
        return trajectory_of(run, self.info, axis=self.axis, time=record.time)

    def under(self, experiment: Experiment) -> System:
        """The simulator with the conditions of an experiment, and its additions on top; other names are covariates."""
        there = {n: value for n, value in experiment.conditions.items() if n in self.parameters}
        for name, more in experiment.add.items():
            if name in self.parameters:
                there[name] = there.get(name, self.parameters[name]) + more
        return self.with_parameters(there) if there else self

    def to_dict(self) -> dict[str, Any]:
        """Kind, axis, effects and parameters as plain types."""
        effects, parameters = list(self.effects), dict(self.parameters)
        return {"kind": self.kind, "axis": self.axis, "effects": effects, "parameters": parameters}

    def __repr__(self) -> str:
        return f"System({self.kind}, {self.axis}, effects: {', '.join(self.effects) or 'none'})"

    def _repr_html_(self) -> str:
        cells = [(escape(name), f"{value:.6g}", escape(self.unit(name))) for name, value in self.parameters.items()]
        rows = "".join(f"<tr><td>{name}</td><td>{value}</td><td>{unit}</td></tr>" for name, value, unit in cells)
        return f"<p>{escape(repr(self))}</p><table><tr><th>parameter</th><th>value</th><th>unit</th></tr>{rows}</table>"

    def _require_company(self, name: str) -> None:
        """Raise where an effect needs another one: a memory of dry friction needs a level of it (Role::memory)."""
        effect = self.info.effect(name)
        levels = [e.name for e in self.info.effects if e.element == effect.element and e.roles & LEVEL]
        if effect.roles & MEMORY and not set(levels) & set(self.effects):
            raise ParameterError(f"{name} shapes dry friction, and none is there: add one of {', '.join(levels)}")
        for other in effect.needs:
            if other not in self.effects:
                raise ParameterError(f"{name} shares parameters with {other}: add {other} too")

    def _why_unknown(self, name: str, known: Collection[str]) -> str:
        """Why this name is no parameter, and what was expected."""
        lacking = [e.name for e in self.info.effects if name in e.parameters]
        if lacking:
            return f"parameter of {' or '.join(lacking)}, which this {self.kind} lacks; expected that effect as well"
        return f"no parameter of {self.kind} with its effects; {expected_one_of(name, known)}"

    def _require_all(self, names: list[str], given: Mapping[str, float]) -> None:
        """Raise where one of the parameters `names` has no value and no default."""
        for row in map(self.info.parameter, names):
            if row.name not in given and row.purpose != "share":
                expected = interval_text(row.lower, row.upper, self.unit(row.name))
                raise ParameterError(f"{row.name}: missing; expected {expected} ({row.meaning})")

    def _within(self, name: str, value: float) -> float:
        """The value of a parameter. Raises where it is outside the bounds."""
        row = self.info.parameter(name)
        return within(name, value, row.lower, row.upper, self.unit(name))

    @cached_property
    def _own_names(self) -> list[str]:
        """Parameters of the system itself, of what is structural, and of its effects."""
        info = self.info
        on = {e.name for e in info.effects if e.structural} | set(self.effects)
        held = {name for e in info.effects if e.name in on for name in e.parameters}
        return [p.name for p in info.parameters if p.effect is None or p.name in held]


def require_system(given: object) -> System:
    """The system itself. Raises ParameterError for anything else, such as a dataset."""
    if not isinstance(given, System):
        raise ParameterError(f"system = {given!r:.60}: expected a System, such as dataset.system()")
    return given


def _check_types(system: System) -> None:
    """Raise ParameterError where a field of a system is of the wrong type."""
    if not isinstance(system.kind, str):
        raise ParameterError(f"kind = {system.kind!r:.60}: expected the name of a system, such as 'two_inertia'")
    choice("axis", system.axis, AXES)
    if not isinstance(system.effects, tuple | list):
        example = [system.effects] if isinstance(system.effects, str) else ["joint:stribeck"]
        raise ParameterError(f"effects = {system.effects!r:.60}: expected a list such as {example}")
    if not isinstance(system.parameters, Mapping):
        raise ParameterError(f"parameters = {system.parameters!r:.60}: expected a mapping of names to values")
    if not isinstance(system.controller, Controller | None):
        raise ParameterError(f"controller = {system.controller!r:.60}: expected a Controller or None")
