"""What the generator has to know about a kind of rig: bodies, sensors, effects and their sizes; and its inputs."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SETTLE = 0.8  # s before a log begins
COLOUR_TIME = 0.002  # s, the period for which `Output.colour` is stated


class Slot(NamedTuple):
    """A body with friction: its name, and a usual speed, rad/s, and load, N*m, which scale the alternative laws."""

    name: str
    speed: float
    load: float


class Output(NamedTuple):
    """A sensor: how it is logged, and one unit of its noise (white sd, coloured sd and its AR1 coefficient at 2 ms)."""

    name: str
    column: str
    unit: str
    digits: str
    white: float
    coloured: float
    colour: float
    resolution: float


class Input(NamedTuple):
    """A logged input: signal and column, unit, digits, and whether it is constant from sample to sample."""

    name: str
    column: str
    unit: str
    digits: str
    hold: bool


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """One run: the first input or its reference, SI, (num_samples,); `others`: the other inputs by signal; `start` s
    within the session; `payload` kg; `repeat` label or None; `add`: what the run adds to parameters.
    """

    name: str
    reference: Array
    start: float
    split: str
    repeat: str | None = None
    payload: float = 0.0
    add: dict[str, float] = field(default_factory=dict)
    others: dict[str, Array] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Run:
    """Logged samples: `time` s (m,), `command` (m, n): the first input, `outputs` (outputs, m, n) in the system's
    order, `state` (states, m, n).
    """

    time: Array
    command: Array
    outputs: Array
    state: Array


class Push(NamedTuple):
    """What acts on the bodies, N*m: `force` (slots, n) without friction, the rest (n,). `rate`: of the cable."""

    force: Array
    drive: Array
    cable: Array
    rate: Array
    weight: Array


@dataclass(frozen=True, kw_only=True)
class Controller:
    """u_k = kp e_k + kd (e_k - e_(k-1))/T, e = reference - first output as measured, clipped to +-limit; arrays (n,),
    SI.
    """

    kp: Array
    kd: Array
    limit: Array


@dataclass(frozen=True, kw_only=True)
class Scene:
    """Inputs of n lanes. `reference`: of the first output, rad, (num_samples, n), or the command itself, N*m, where
    there is no controller.

    `num_settle` first samples are not logged. `noise`: added to the readings, (outputs, num_samples, n); `resolution`:
    (outputs, n), 0 for none. `initial`: (2 slots, n) positions, then velocities; absent: the static equilibrium.
    `known`: joint torque, N*m, (num_samples, n). `others`: further inputs by signal, SI, (num_samples, n).
    """

    reference: Array
    controller: Controller | None = None
    sample_time: float = 0.002
    num_settle: int = 0
    noise: Array | None = None
    resolution: Array | None = None
    known: Array | None = None
    initial: Array | None = None
    others: Mapping[str, Array] = field(default_factory=dict)


class Mechanics(Protocol):
    """The bodies of n lanes and what they exert on each other; positions and velocities are (bodies, n)."""

    inertia: Array

    def rest(self, scene: Scene) -> Array:
        """Positions, then velocities, of the static equilibrium under the first reference."""

    def push(self, q: Array, v: Array, drive: Array, known: Array | None) -> Push:
        """Torques on the bodies, N*m; `drive` comes from the actuator, `known` is added to the joint."""

    def load(self, push: Push) -> Array:
        """Load that each slot carries, N*m, (slots, n)."""

    def measure(self, q: Array, v: Array) -> list[Array]:
        """What perfect sensors would read."""

    def take(self, others: Mapping[str, Array]) -> None:
        """Take the further inputs of the next sample."""

    def within(self, q: Array, old: Array, new: Array, push: Push) -> tuple[list[Array], list[Array]]:
        """Outputs at the middle of a step and their change over the step; `old` and `new`: velocities around it."""


TORQUE = Input("motor_torque", "u", "N*m", "%.7f", True)


class Strengthen(Protocol):
    """Parameters of an effect or a cause ("sheath:stribeck", "unknown:creep") at `amplitude`; None where the usual
    ones will do. `seed` draws the numbers that are no amplitude and not in `shape`.
    """

    def __call__(
        self, name: str, amplitude: float, *, truth: Mapping[str, float], shape: Mapping[str, float], seed: int
    ) -> dict[str, float] | None: ...


@dataclass(frozen=True, kw_only=True)
class System:
    """One kind of rig. Names of parameters are the generator's; `contract` maps those that a dataset calls otherwise.

    `typical`: parameters, SI, drawn within 25 % except for the `exact` ones. `sizes`: truth -> size of an effect of
    amplitude 1, SI, of those that are no friction. `rivals`: effects that can look like an effect. `twins`: (effect,
    measured outputs) -> effects that give the same logs, exactly. `optional`: an output, the share of the rigs that
    lack it, and the effects that cannot be seen without it.

    `inputs`: what is logged as input, the command first. `loop`: gains and limit of a sampled position loop that acts
    on the first output, drawn for a rig; absent where the inputs are prescribed. `turns`: the parameter that says how
    far the first output turns per turn of the joint. `session`: experiments of a rig, called like
    `excitation.session`.

    `forms`, `largest`: functional forms and largest amplitudes of effects that `effects.py` does not list. `causes`:
    unknown causes. `withheld`: parameters that only an effect of the nominal simulator has, besides its own name.
    `strengthen`: parameters of what is neither the usual friction nor one of `sizes`. `mechanics`: bodies for the
    simulation in `plant`, or `simulate`: a simulation of its own. `is_quasistatic`: its logs do not tell how fast time
    passes.
    """

    kind: str
    title: str
    slots: tuple[Slot, ...]
    inputs: tuple[Input, ...] = (TORQUE,)
    outputs: tuple[Output, ...]
    optional: tuple[str, float, tuple[str, ...]] = ("", 0.0, ())
    effects: tuple[str, ...]
    nominal_effects: tuple[str, ...]
    typical: Mapping[str, float]
    exact: tuple[str, ...] = ()
    contract: Mapping[str, str]
    sizes: Callable[[Mapping[str, float]], Mapping[str, float]]
    forms: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    largest: Mapping[str, float] = field(default_factory=dict)
    causes: tuple[str, ...] = ()
    withheld: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    strengthen: Strengthen | None = None
    rivals: Mapping[str, tuple[str, ...]]
    twins: Callable[[str, tuple[str, ...]], tuple[str, ...]] = lambda effect, outputs: ()
    loop: Callable[[Mapping[str, float], np.random.Generator], dict[str, float]] | None = None
    turns: str = ""
    session: Callable[..., list[Experiment]]
    reference: str = ""
    sample_times: tuple[float, ...]
    duration: float
    coarse_step: float
    fine_step: float
    mechanics: Callable[[Lanes, float], Mechanics] | None = None
    simulate: Callable[[Lanes, Scene, float, int], Run] | None = None
    is_quasistatic: bool = False

    @property
    def commands_torque(self) -> bool:
        """Whether the command is a torque; otherwise the rig controls itself, and its mechanics has the actuator."""
        return self.inputs[0].unit == "N*m"

    @property
    def output_names(self) -> tuple[str, ...]:
        return tuple(output.name for output in self.outputs)

    def column(self, name: str) -> Array:
        """One number of every output, (outputs,)."""
        return np.array([getattr(output, name) for output in self.outputs])

    def colour(self, sample_time: float) -> Array:
        """AR1 coefficient of every output's coloured noise."""
        return np.asarray(self.column("colour") ** (sample_time / COLOUR_TIME))


@dataclass(frozen=True, kw_only=True)
class Lanes:
    """n rigs of one system: parameters by name, (n,) each (absent means 0), run-to-run friction factors (slots, n),
    functional form (n,).

    `form` 0 is the documented one. `effect` names each lane's effect ("joint:coulomb"), for effects whose other form
    is of a nominal law.
    """

    system: System
    parameters: Mapping[str, Array]
    scale: Array
    form: NDArray[np.int64]
    effect: tuple[str, ...] = field(default=())

    @property
    def size(self) -> int:
        return int(self.form.size)

    def get(self, name: str) -> Array:
        value: Array = self.parameters.get(name, np.zeros(self.size))
        return value
