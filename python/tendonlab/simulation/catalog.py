"""What systems, effects and parameters there are: the tables of the compiled core, and look-ups in them."""

from __future__ import annotations

from functools import cache
from html import escape
from typing import TypeVar

from tendonlab import _core
from tendonlab._core import EffectInfo, ElementInfo, InputInfo, OutputInfo, ParameterInfo, PortInfo
from tendonlab.errors import ParameterError, expected_one_of

__all__ = ["EffectInfo", "ElementInfo", "InputInfo", "OutputInfo", "ParameterInfo", "PortInfo", "SystemInfo"]

AXES = ("rotary", "linear")
LEVEL, FACTOR, MEMORY = 2, 4, 16  # roles of laws, as core/law.hpp numbers them
REFINES, WHOLE, SIGNAL, DRY = 32, 64, 256, 512
DEFAULTED = ("command_gain", "motor_inertia_share")  # roles of parameters that are typical unless stated
DIMENSIONS = _core.dimensions()
PORT_QUANTITIES = tuple(_core.port_quantities())  # that can be recorded of each port
Row = TypeVar("Row", ParameterInfo, EffectInfo, ElementInfo)


def is_dry(effect: EffectInfo) -> bool:
    """Whether an effect is dry friction by itself."""
    return bool(effect.roles & (LEVEL | DRY)) and not effect.roles & REFINES


class SystemInfo(_core.SystemInfo):
    """Everything that a system states about itself: signals, parameters, effects, and the places of laws."""

    def __init__(self, kind: str) -> None:
        super().__init__(kind)
        self._parameters = {row.name: row for row in self.parameters}
        self._effects = {row.name: row for row in self.effects}
        self._elements = {row.name: row for row in self.elements}
        place = {name: k for k, name in enumerate(self._parameters)}
        self.amplitudes: dict[str, list[int] | None] = {  # places of each effect's amplitudes; None: always acts
            e.name: None if e.structural else [place[n] for n in e.parameters if self._parameters[n].amplitude]
            for e in self.effects
        }

    def parameter(self, name: str) -> ParameterInfo:
        """The row of that name; ParameterError, with the nearest name, where there is none."""
        return _named(self._parameters, name, f"parameter of {self.kind}")

    def effect(self, name: str) -> EffectInfo:
        """The effect of that name; ParameterError, with the nearest name, where there is none."""
        return _named(self._effects, name, f"effect of {self.kind}")

    def element(self, name: str) -> ElementInfo:
        """The element of that name; ParameterError, with the nearest name, where there is none."""
        return _named(self._elements, name, f"element of {self.kind}")

    def is_friction(self, p: ParameterInfo) -> bool:
        """Whether a parameter is the size of dry friction, or any damping."""
        if p.dimension == "damping":
            return True
        law = self._effects.get(f"{p.element}:{p.effect}")
        return p.dimension == "effort" and p.amplitude and law is not None and bool(law.roles & LEVEL)

    @property
    def signals(self) -> tuple[InputInfo | OutputInfo, ...]:
        """Inputs, then outputs."""
        return (*self.inputs, *self.outputs)

    def with_role(self, role: str) -> ParameterInfo | None:
        """The parameter in that role: "command_gain", "payload", "motor_inertia_share"; None where there is none."""
        return next((p for p in self.parameters if p.role == role), None)

    @property
    def command(self) -> InputInfo | None:
        """The command of the actuator, where it is an effort or what `command_gain` converts to one."""
        return next((signal for signal in self.inputs if signal.dimension == "command"), None)

    def __reduce__(self) -> tuple[object, tuple[str]]:
        return system_info, (self.kind,)

    def __repr__(self) -> str:
        inputs, outputs = (", ".join(s.name for s in signals) for signals in (self.inputs, self.outputs))
        return f"SystemInfo({self.kind}: {inputs} -> {outputs}; {len(self.effects)} effects)"

    def _repr_html_(self) -> str:
        signals = [("input", s.name, unit(s.dimension, "rotary"), s.meaning) for s in self.inputs]
        signals += [("output", s.name, unit(s.dimension, "rotary"), s.meaning) for s in self.outputs]
        own = [p for p in self.parameters if p.effect is None]
        rows = [("parameter", p.name, parameter_unit(self, p, "rotary"), p.meaning) for p in own]
        rows += [("effect", e.name, "", e.summary) for e in self.effects]
        cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in (*signals, *rows))
        lines = "".join(f"<tr>{row}</tr>" for row in cells)
        head = "<tr><th></th><th>name</th><th>unit (rotary axis)</th><th>meaning</th></tr>"
        return f"<p><b>{self.kind}</b>: {escape(self.equation)}</p><table>{head}{lines}</table>"


def kinds() -> tuple[str, ...]:
    """Names of all systems."""
    return tuple(_core.kinds())


@cache
def system_info(kind: str) -> SystemInfo:
    """The tables of the system `kind`; ParameterError names the nearest kind where there is none."""
    if kind not in kinds():
        raise ParameterError(f"system kind = {kind!r}: {expected_one_of(kind, kinds())}")
    return SystemInfo(kind)


def unit(dimension: str, axis: str) -> str:
    """Unit of a dimension on a "rotary" or "linear" axis, e.g. unit("effort", "linear") = "N"."""
    if axis not in AXES:
        raise ParameterError(f"axis = {axis!r}: expected one of {', '.join(AXES)}")
    if dimension not in DIMENSIONS:
        raise ParameterError(f"dimension = {dimension!r}: expected one of {', '.join(DIMENSIONS)}")
    return DIMENSIONS[dimension].rotary if axis == "rotary" else DIMENSIONS[dimension].linear


def parameter_unit(info: SystemInfo, parameter: ParameterInfo, axis: str) -> str:
    """Unit of a parameter of a system on `axis`, or of its element on an axis of its own; a sensor's bias has its
    signal's."""
    if parameter.element is None:
        return unit(parameter.dimension, axis)
    if parameter.dimension != "output":
        return unit(parameter.dimension, info.element(parameter.element).axis or axis)
    signal = parameter.element.removeprefix("sensor.")
    return unit(next(s.dimension for s in info.outputs if s.name == signal), axis)


def _named(rows: dict[str, Row], name: str, what: str) -> Row:
    if name not in rows:
        raise ParameterError(f"{name!r} is no {what}; {expected_one_of(name, rows)}")
    return rows[name]
