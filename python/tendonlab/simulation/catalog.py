"""What systems, effects and parameters there are: the tables of the compiled core, as plain Python."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TypeVar

from tendonlab import _core
from tendonlab.errors import ParameterError, expected_one_of

AXES = ("rotary", "linear")
LEVEL, MEMORY, REFINES, WHOLE = 2, 16, 32, 64  # roles of laws, as the core numbers them (core/law.hpp)
UNITS = _core.units()


@dataclass(frozen=True)
class Parameter:
    """A row of a law's or system's table. `typical` is in units of the rig's own scale of that dimension (its rms
    effort, speed, travel), absolute for ratios and times. `purpose`: "structure", "amplitude", "share",
    "shape" or "condition" (each experiment states it)."""

    name: str
    element: str | None
    effect: str | None
    own: str
    dimension: str
    purpose: str
    typical: float
    lower: float
    upper: float
    meaning: str

    @property
    def amplitude(self) -> bool:
        """Does the effect vanish where this is 0?"""
        return self.purpose in ("amplitude", "share")


@dataclass(frozen=True)
class Effect:
    """A law in a place, "joint:stribeck". `phrase`: what reports call it, "Stribeck friction at the joint"; `noun`: the
    same without the place. `structural` ones are part of the system and always on; `needs`: effects whose parameters it
    shares."""

    name: str
    element: str
    effect: str
    noun: str
    phrase: str
    equation: str
    source: str
    summary: str
    parameters: tuple[str, ...]
    needs: tuple[str, ...]
    structural: bool
    roles: int


Named = TypeVar("Named", Parameter, Effect)


@dataclass(frozen=True)
class Signal:
    """An input or output; `axis` is the degree of freedom whose position it is, None for anything else. `between`: what
    an input is between its samples, "hold", "linear" or "smooth"; `unless`: an input that takes its place if logged;
    `missed`: one that a rig may lack, but not where a measured output depends on it."""

    name: str
    dimension: str
    required: bool
    hold: bool
    meaning: str
    axis: int | None
    between: str
    unless: str | None
    missed: bool


@dataclass(frozen=True)
class Port:
    """Where a slot sits; ports of one element carry the same laws. `load`: dimension of what it sees as its load."""

    name: str
    element: str
    load: str


@dataclass(frozen=True)
class SystemInfo:
    """Everything a system states about itself. `commanded`: input 0 is the command of an actuator; `sampled`: outputs
    follow sample by sample, without a differential equation; `steady`: and no sample depends on another, so that rows
    need no time; `element_axes`: of elements with an axis of their own; `places`: each
    element in words, "at the joint"."""

    kind: str
    equation: str
    dof: int
    inputs: tuple[Signal, ...]
    outputs: tuple[Signal, ...]
    parameters: tuple[Parameter, ...]
    effects: tuple[Effect, ...]
    elements: tuple[str, ...]
    element_axes: dict[str, str]
    places: dict[str, str]
    ports: tuple[Port, ...]
    default_nominal_effects: tuple[str, ...]
    commanded: bool
    sampled: bool
    steady: bool

    def parameter(self, name: str) -> Parameter:
        """The row of that name; ParameterError, with the nearest name, where there is none."""
        return _named(self.parameters, name, f"parameter of {self.kind}")

    def effect(self, name: str) -> Effect:
        """The effect of that name; ParameterError, with the nearest name, where there is none."""
        return _named(self.effects, name, f"effect of {self.kind}")


def kinds() -> tuple[str, ...]:
    """Names of all systems."""
    return tuple(_core.kinds())


@cache
def system_info(kind: str) -> SystemInfo:
    """The tables of the system `kind`; ParameterError names the nearest kind where there is none."""
    if kind not in kinds():
        raise ParameterError(f"system kind = {kind!r}: {expected_one_of(kind, kinds())}")
    raw = _core.system_info(kind)
    return SystemInfo(
        kind=raw["kind"],
        equation=raw["equation"],
        dof=raw["dof"],
        inputs=tuple(_signal(s) for s in raw["inputs"]),
        outputs=tuple(_signal(s) for s in raw["outputs"]),
        parameters=tuple(
            Parameter(**{**p, "element": p["element"] or None, "effect": p["effect"] or None})
            for p in raw["parameters"]
        ),
        effects=tuple(
            Effect(
                **{
                    "noun": e["effect"],
                    "phrase": e["name"],
                    **e,
                    "parameters": tuple(e["parameters"]),
                    "needs": tuple(e["needs"]),
                }
            )
            for e in raw["effects"]
        ),
        elements=tuple(name for name, *_ in raw["elements"]),
        element_axes={name: axis for name, axis, *_ in raw["elements"] if axis},
        places={name: place for name, _, *of in raw["elements"] for place in of},
        ports=tuple(Port(*of) for of in raw["ports"]),
        default_nominal_effects=tuple(raw["nominal"]),
        commanded=raw["commanded"],
        sampled=raw["sampled"],
        steady=raw["steady"],
    )


def unit(dimension: str, axis: str) -> str:
    """Unit of a dimension on a "rotary" or "linear" axis, e.g. unit("effort", "linear") = "N"."""
    if axis not in AXES:
        raise ParameterError(f"axis = {axis!r}: expected one of {', '.join(AXES)}")
    if dimension not in UNITS:
        raise ParameterError(f"dimension = {dimension!r}: expected one of {', '.join(UNITS)}")
    return UNITS[dimension][AXES.index(axis)]


def parameter_unit(info: SystemInfo, parameter: Parameter, axis: str) -> str:
    """Unit of a parameter of a system on `axis`, or of its element on an axis of its own; a sensor's bias has its
    signal's."""
    if parameter.dimension != "output":
        return unit(parameter.dimension, info.element_axes.get(parameter.element or "", axis))
    signal = (parameter.element or "").removeprefix("sensor.")
    return unit(next(s.dimension for s in info.outputs if s.name == signal), axis)


def _signal(raw: dict[str, object]) -> Signal:
    axis = raw["axis"]
    dimension = str(raw["dimension"])
    return Signal(
        name=str(raw["name"]),
        dimension=dimension,
        required=bool(raw["required"]),
        hold=raw["between"] == "hold",
        meaning=str(raw["meaning"]),
        axis=axis if isinstance(axis, int) and axis >= 0 else None,
        between=str(raw["between"]),
        unless=str(raw["unless"]) or None,
        missed=bool(raw["missed"]),
    )


def _named(items: tuple[Named, ...], name: str, what: str) -> Named:
    for item in items:
        if item.name == name:
            return item
    raise ParameterError(f"{name!r} is no {what}; {expected_one_of(name, [i.name for i in items])}")
