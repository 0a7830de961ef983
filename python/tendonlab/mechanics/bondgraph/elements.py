"""Elements of a bond graph: sources, storages, resistors, transformers, gyrators, junctions."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

from tendonlab.arguments import within
from tendonlab.errors import ParameterError

Law = Callable[[Any], Any]


@dataclass(frozen=True, kw_only=True)
class Element:
    """A node of a graph. `label`: text of the drawing next to the kind; default: the name."""

    name: str
    label: str = ""
    kind: ClassVar[str] = ""
    num_bonds: ClassVar[int | None] = 1  # None: any number

    @property
    def text(self) -> str:
        """What a drawing writes: "I: L_m", "TF: 1/80", or "1" with its label below."""
        shown = self.label or self.name
        return self.kind if isinstance(self, Junction) else f"{self.kind}: {shown}"


@dataclass(frozen=True, kw_only=True)
class Source(Element):
    """Imposes `value` on its bond, or, where `value` is None, the input of that name."""

    value: float | None = None

    def __post_init__(self) -> None:
        _require_finite(self, "value", self.value)


class Se(Source):
    """Source of effort: a voltage, V, a force, N, a torque, N*m. A bond that enters it makes it a load."""

    kind = "Se"


class Sf(Source):
    """Source of flow: a current, A, a velocity, m/s or rad/s. A bond that enters it takes that flow away."""

    kind = "Sf"


@dataclass(frozen=True, kw_only=True)
class I(Element):  # noqa: E742 - the field's name
    """Inertia or inductance: p' = effort, flow = p / `inertia`. `symbol` names it in written equations."""

    inertia: float
    kind = "I"

    def __post_init__(self) -> None:
        _require_positive(self.name, self.inertia)


@dataclass(frozen=True, kw_only=True)
class C(Element):
    """Spring or capacitor: q' = flow, effort = `effort`(q). A number is a stiffness: effort = number * q."""

    effort: float | Law
    kind = "C"

    def __post_init__(self) -> None:
        _require_finite(self, "effort", self.effort)

    def of(self, displacement: Any) -> Any:
        """Effort at a displacement."""
        return self.effort(displacement) if callable(self.effort) else self.effort * displacement


@dataclass(frozen=True, kw_only=True)
class R(Element):
    """Resistor: effort = `effort`(flow), a number is a linear resistance; where `of` names a position, `effort`(flow,
    position). `flow`: the inverse law, needed where the graph imposes the effort; a linear resistor needs none."""

    effort: float | Callable[..., Any]
    flow: Callable[..., Any] | None = None
    of: str = ""
    kind = "R"

    def __post_init__(self) -> None:
        _require_finite(self, "effort", self.effort)

    def effort_of(self, flow: Any, *position: Any) -> Any:
        """Effort at a flow."""
        return self.effort(flow, *position) if callable(self.effort) else self.effort * flow

    def flow_of(self, effort: Any, *position: Any) -> Any:
        """Flow at an effort. Raises ParameterError where the law has no inverse."""
        if self.flow is not None:
            return self.flow(effort, *position)
        if callable(self.effort) or self.effort == 0:
            raise ParameterError(f"R {self.name}: its effort is imposed; expected the inverse of its law as `flow`")
        return effort / self.effort


@dataclass(frozen=True, kw_only=True)
class TF(Element):
    """Transformer: flow out = `ratio` * flow in, effort in = `ratio` * effort out. No power is lost."""

    ratio: float
    kind = "TF"
    num_bonds = 2

    def __post_init__(self) -> None:
        _require_ratio(self, self.ratio)

    def at(self, position: Any) -> Any:
        """The ratio, at whatever position."""
        return self.ratio


@dataclass(frozen=True, kw_only=True)
class MTF(Element):
    """Modulated transformer: its ratio is `ratio`(q) of the graph's position `of`. `ratio` must take complex numbers
    (numpy functions do): its slope is a complex step."""

    ratio: Law
    of: str
    kind = "MTF"
    num_bonds = 2

    def at(self, position: Any) -> Any:
        """The ratio at a position."""
        return self.ratio(position)


@dataclass(frozen=True, kw_only=True)
class GY(Element):
    """Gyrator: effort out = `ratio` * flow in, effort in = `ratio` * flow out; k of a motor."""

    ratio: float
    kind = "GY"
    num_bonds = 2

    def __post_init__(self) -> None:
        _require_ratio(self, self.ratio)


class Junction(Element):
    """Joins any number of bonds without loss."""

    num_bonds = None


class Zero(Junction):
    """0-junction: one effort, flows sum to zero."""

    kind = "0"


class One(Junction):
    """1-junction: one flow, efforts sum to zero."""

    kind = "1"


@dataclass(frozen=True)
class Bond:
    """Power counts positive from `tail` to `head`, names of elements."""

    tail: str
    head: str
    ends: frozenset[str] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "ends", frozenset((self.tail, self.head)))

    def other(self, end: str) -> str:
        """The element at the other end."""
        return self.head if end == self.tail else self.tail

    def sign(self, at: str) -> float:
        """+1 where power flows into `at`, -1 where it leaves."""
        return 1.0 if at == self.head else -1.0


def _require_positive(name: str, value: float) -> None:
    if not (math.isfinite(value) and value > 0):
        raise ParameterError(f"{name} = {value}: expected a positive inertia")


def _require_finite(element: Element, name: str, value: float | Callable[..., Any] | None) -> None:
    """Raise ParameterError for a number that is not finite. Laws and named inputs are not checked."""
    if value is not None and not callable(value):
        within(f"{element.kind} {element.name}: {name}", value, -math.inf, math.inf)


def _require_ratio(element: Element, ratio: float) -> None:
    if within(f"{element.kind} {element.name}: ratio", ratio, -math.inf, math.inf) == 0:
        raise ParameterError(f"{element.kind} {element.name}: ratio = {ratio}: expected a number other than 0")
