"""Types of the compiled core. Laws come from the C++ tables, so a new one needs no line here."""

from collections.abc import Mapping, Sequence
from types import ModuleType
from typing import Any, Final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]

class Law:
    """What the law classes share; each has the methods of its `roles` and a read-only attribute a parameter."""

    name: str
    equation: str
    source: str
    summary: str
    roles: tuple[str, ...]
    noun: str
    parameters: tuple[ParameterInfo, ...]

    def __init__(self, **parameters: float) -> None: ...
    def __getattr__(self, name: str) -> Any: ...

class Laws(ModuleType):
    """A group of laws: `friction.Stribeck` is a class of `Law`."""

    def __getattr__(self, name: str) -> type[Law]: ...

actuation: Laws
ends: Laws
friction: Laws
loading: Laws
sensing: Laws
sheath: Laws
transmission: Laws

class DimensionInfo:
    name: Final[str]
    rotary: Final[str]
    linear: Final[str]
    scale: Final[str | None]
    per: Final[str | None]

class InputInfo:
    name: Final[str]
    meaning: Final[str]
    dimension: Final[str]
    required: Final[bool]
    between: Final[str]
    replaced_by: Final[str | None]
    warn_if_absent: Final[bool]
    limit: Final[bool]

class OutputInfo:
    name: Final[str]
    meaning: Final[str]
    dimension: Final[str]
    axis: Final[int | None]
    held: Final[bool]

class PortInfo:
    name: Final[str]
    element: Final[str]
    load: Final[str]

class ElementInfo:
    name: Final[str]
    axis: Final[str | None]
    place: Final[str]
    acts_on: Final[str]

class ParameterInfo:
    name: Final[str]
    element: Final[str | None]
    effect: Final[str | None]
    own: Final[str]
    dimension: Final[str]
    purpose: Final[str]
    role: Final[str | None]
    typical: Final[float]
    lower: Final[float]
    upper: Final[float]
    meaning: Final[str]
    amplitude: Final[bool]

class EffectInfo:
    name: Final[str]
    element: Final[str]
    effect: Final[str]
    group: Final[str]
    noun: Final[str]
    phrase: Final[str]
    equation: Final[str]
    source: Final[str]
    summary: Final[str]
    parameters: Final[tuple[str, ...]]
    needs: Final[tuple[str, ...]]
    roles: Final[int]
    sees: Final[int]
    structural: Final[bool]
    law: Final[type[Law]]

class SystemInfo:
    def __init__(self, kind: str) -> None: ...
    kind: Final[str]
    equation: Final[str]
    dof: Final[int]
    commanded: Final[bool]
    sampled: Final[bool]
    steady: Final[bool]
    default_nominal_effects: Final[tuple[str, ...]]
    inputs: Final[tuple[InputInfo, ...]]
    outputs: Final[tuple[OutputInfo, ...]]
    parameters: Final[tuple[ParameterInfo, ...]]
    effects: Final[tuple[EffectInfo, ...]]
    elements: Final[tuple[ElementInfo, ...]]
    ports: Final[tuple[PortInfo, ...]]

def dimensions() -> dict[str, DimensionInfo]: ...
def laws() -> tuple[tuple[str, str], ...]: ...
def kinds() -> list[str]: ...
def rigid_motion(kind: str, values: Sequence[float], active: Sequence[bool]) -> tuple[list[float], float, float]: ...

class TendonRouting:
    def __init__(
        self,
        *,
        radius: ArrayLike,
        motor_radius: Sequence[float],
        constant_loss: ArrayLike,
        tension_loss: ArrayLike,
        viscous_loss: ArrayLike,
        reducers: tuple[Sequence[float], Sequence[float]],
        motor_reducers: tuple[Sequence[float], Sequence[float]],
        at_rest: str,
    ) -> None: ...
    def statics(
        self,
        *,
        torque: ArrayLike,
        joint_velocity: ArrayLike,
        losses: Sequence[str],
        sign_velocity: float,
        to_motors: bool,
    ) -> dict[str, Floats]: ...
    def joint_motion(self, motor: ArrayLike) -> Floats: ...
    def branch_motion(self, joint: ArrayLike) -> Floats: ...

class TendonPair:
    @property
    def alpha(self) -> float: ...
    @property
    def beta(self) -> float: ...
    @property
    def psi_alpha(self) -> float: ...
    @property
    def psi_beta(self) -> float: ...
    @property
    def torque_gain(self) -> float: ...
    @property
    def pretension_gain(self) -> float: ...
    @property
    def pretension_moment(self) -> float: ...
    @property
    def offset(self) -> float: ...
    def tensions(self, input_torque: float, backwards: bool) -> list[float]: ...
    def elongations(self, input_torque: float, backwards: bool, cable_stiffness: float) -> list[float]: ...

class Sheaths:
    def __init__(
        self,
        *,
        arc_length: Sequence[float],
        turning: Sequence[float],
        pretension: float,
        input_radius: float,
        output_radius: float,
        uniform_pretension: bool,
    ) -> None: ...
    def at(self, friction_coefficient: float) -> TendonPair: ...
    def transmit(
        self,
        *,
        input_torque: ArrayLike,
        velocity: ArrayLike,
        friction: Sequence[float],
        periods: float,
        start: float,
        release: float,
    ) -> dict[str, Floats]: ...

class Signal:
    @overload
    def __init__(self) -> None: ...
    @overload
    def __init__(self, knots: ArrayLike, coefficients: ArrayLike, holds: bool) -> None: ...

class Loop:
    @overload
    def __init__(self) -> None: ...
    @overload
    def __init__(
        self,
        *,
        kind: str,
        axis: int,
        output: int,
        proportional: float,
        derivative: float,
        reference_weight: float,
        limit: float,
        sample_time: float,
        reference: Signal,
        disturbance: Signal,
    ) -> None: ...

class Experiment:
    def __init__(
        self,
        *,
        kind: str,
        time: Sequence[float],
        inputs: Sequence[Signal],
        loop: Loop,
        position: Sequence[float],
        velocity: Sequence[float],
        taken: Sequence[tuple[int, int, float]] = ...,
        reading: Sequence[float] = ...,
    ) -> None: ...
    @property
    def time(self) -> list[float]: ...
    @property
    def position(self) -> list[float]: ...
    @property
    def velocity(self) -> list[float]: ...
    @property
    def reading(self) -> list[float]: ...
    @property
    def sense(self) -> float: ...
    def started(self, position: Sequence[float], velocity: Sequence[float], reading: Sequence[float]) -> Experiment: ...
    def last_moved(self, sense: float) -> Experiment: ...
    def until(self, samples: int) -> Experiment: ...

class Settings:
    def __init__(
        self,
        *,
        tolerance: float = 1e-6,
        position_scale: float = 1e-2,
        velocity_scale: float = 1e-2,
        max_attempts: int = 20_000_000,
        ports: Sequence[str] = (),
        outputs: Sequence[int] | None = None,
    ) -> None: ...

def port_quantities() -> list[str]: ...
def simulate(
    kind: str,
    values: Sequence[float],
    active: Sequence[bool],
    experiment: Experiment,
    seeds: Sequence[tuple[str, int]],
    settings: Settings,
) -> dict[str, Any]: ...
def simulate_many(
    kind: str,
    values: np.ndarray,
    active: np.ndarray,
    experiment: Experiment,
    position: np.ndarray,
    velocity: np.ndarray,
    settings: Settings,
    channels: Sequence[int],
    out: np.ndarray,
) -> list[str]: ...
def balance(
    kind: str,
    values: Floats,
    active: Sequence[bool],
    experiment: Experiment,
    position: Floats,
    velocity: Floats,
) -> dict[str, Floats]: ...

class Whitening:
    def __init__(
        self,
        ar: Sequence[Sequence[float]],
        sd: Sequence[float],
        measured: Floats,
        directions: Floats | None = None,
        spread: Sequence[float] = ...,
    ) -> None: ...
    def rows(self) -> int: ...
    def cells(self) -> NDArray[np.int32]: ...
    def apply(self, signals: Floats) -> Floats: ...
    def apply_many(self, signals: Floats) -> Floats: ...
    def residual(self, outputs: Floats) -> Floats: ...

def regress(
    residual: Floats,
    columns: Floats,
    belief: Floats,
    logarithm: Sequence[bool],
    positive: Sequence[bool],
    share: Floats,
    level: Floats,
    steps: int,
) -> dict[str, Any]: ...

class RandomEffect:
    def __init__(self, directions: Floats) -> None: ...
    def whiten(self, rows: Floats) -> Floats: ...
    @property
    def volume(self) -> float: ...

class Cancel:
    def __init__(self) -> None: ...
    def set(self) -> None: ...
    def is_set(self) -> bool: ...

class Task:
    def __init__(
        self,
        experiment: Experiment,
        whitening: Whitening,
        *,
        fixed: Mapping[int, float] = ...,
        added: Mapping[int, float] = ...,
        initial: Sequence[tuple[str, int]] = ...,
        initial_sd: Sequence[float] = ...,
        scatter: Sequence[tuple[Sequence[int], float]] = ...,
    ) -> None: ...
    def rows(self) -> int: ...

class Free:
    def __init__(
        self,
        *,
        name: str,
        index: int,
        log: bool,
        scale: float,
        start: float,
        mean: float = 0.0,
        sd: float = ...,
        lower: float = ...,
        upper: float = ...,
    ) -> None: ...
    @property
    def name(self) -> str: ...
    @property
    def index(self) -> int: ...
    @property
    def log(self) -> bool: ...
    @property
    def scale(self) -> float: ...
    @property
    def start(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def sd(self) -> float: ...
    @property
    def lower(self) -> float: ...
    @property
    def upper(self) -> float: ...
    def value(self, x: float) -> float: ...
    def coordinate(self, value: float) -> float: ...
    def slope(self, x: float) -> float: ...
    def started(self, value: float) -> Free: ...

def linearise(
    kind: str,
    values: Sequence[float],
    active: Sequence[bool],
    tasks: Sequence[Task],
    free: Sequence[Free],
    settings: Settings,
    *,
    initial: Sequence[Sequence[float]] = ...,
) -> dict[str, Any]: ...
def fit(
    kind: str,
    values: Sequence[float],
    active: Sequence[bool],
    tasks: Sequence[Task],
    free: Sequence[Free],
    settings: Settings,
    *,
    initial: Sequence[Sequence[float]] = ...,
    max_iterations: int = 50,
    tolerance: float = 1e-8,
    cancel: Cancel | None = None,
    goal: float = ...,
    goal_within: int = 1,
) -> dict[str, Any]: ...
