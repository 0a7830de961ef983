"""From an experiment to what the core simulates: signals, the loop that is closed, the initial state."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.arguments import within
from tendonlab.errors import DatasetError, ParameterError
from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.command import fed_noise
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.sense import EXACT, last_sense
from tendonlab.simulation.signals import (
    averaged,
    hold,
    linear,
    scales_of,
    sloped,
    smooth,
    smoothed,
    smoothed_within_noise,
)
from tendonlab.simulation.start import Start, start_of

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from tendonlab.simulation.catalog import InputInfo
    from tendonlab.simulation.records import Controller
MAX_ATTEMPTS, ATTEMPTS_PER_SAMPLE = 1_000_000, 1_000  # of the stepper: beyond them a parameter is far too stiff
REPLAYS = ("auto", "controller", "free")  # of `System.simulate`; an injection needs the gains of a dataset


class Simulator(Protocol):
    """What preparing an experiment needs of a `System`: its tables, its numbers and its controller."""

    @property
    def kind(self) -> str: ...
    @property
    def controller(self) -> Controller | None: ...
    @property
    def info(self) -> SystemInfo: ...
    def values(self) -> list[float]: ...
    def active(self) -> list[bool]: ...


@dataclass(frozen=True)
class Replay:
    """How experiments are replayed, the same for every model compared.

    "controller": rig and known controller in free run; `feeds_noise`: what the noise of the logged reading added to the
    command is added again, because it shakes the rig. "injection": the logged command, and a spring `kp` and damper
    `kd` (command per displacement, per speed) that pull the simulated motor to the logged one. "free": the logged
    command alone."""

    kind: str
    kp: float | None = None
    kd: float | None = None
    output: str | None = None
    feeds_noise: bool = False

    @property
    def carries_noise(self) -> bool:
        """Whether noise of a sensor reaches the simulated rig."""
        return self.kind == "injection" or self.feeds_noise

    def to_dict(self) -> dict[str, Any]:
        """As report.json has it."""
        return {"kind": self.kind, "kp": self.kp, "kd": self.kd}


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """An experiment as the core simulates it. `measured`: (outputs, samples), NaN where missing. `start`: how it
    begins for any parameters. `initial`: the parts of the initial state that are nuisances, with the sd of their
    priors."""

    name: str
    core: _core.Experiment
    measured: np.ndarray
    start: Start
    initial: tuple[tuple[str, int], ...]
    initial_sd: tuple[float, ...]
    position_scale: float
    velocity_scale: float

    @property
    def initial_mean(self) -> np.ndarray:
        """Means of those parts of the initial state."""
        start = {"position": self.core.position, "velocity": self.core.velocity, "reading": self.core.reading}
        return np.array([start[of][axis] for of, axis in self.initial])

    def settings(
        self, tolerance: float, *, ports: Sequence[str] = (), outputs: Sequence[int] | None = None
    ) -> _core.Settings:
        """How the core is to step at a relative error `tolerance` per step, and what it is to record: quantities of
        ports, and the outputs of these indices (default: all)."""
        return _core.Settings(
            tolerance=within("tolerance", tolerance, 1e-14, 0.1),
            position_scale=self.position_scale,
            velocity_scale=self.velocity_scale,
            max_attempts=MAX_ATTEMPTS + ATTEMPTS_PER_SAMPLE * self.measured.shape[1],
            ports=list(ports),
            outputs=None if outputs is None else list(outputs),
        )


def prepare(experiment: Experiment, system: Simulator, replay: Replay) -> Prepared:
    """The experiment for the core: its inputs, its loop and an initial state estimated from the first samples.

    Raises DatasetError where a signal that the replay needs was not logged, or is no row of numbers in time."""
    _require_time(experiment)
    data, time = experiment.data, experiment.time
    outputs = system.info.outputs
    measured = np.full((len(outputs), len(time)), np.nan)
    for c, signal in enumerate(outputs):
        if signal.name in data.columns:
            measured[c] = _samples(experiment, signal.name)
    start = start_of(experiment, system.info, measured)
    shape = np.array(_core.rigid_motion(system.kind, system.values(), system.active())[0])
    position, velocity = start.state(shape)
    free, sd = start.nuisances(shape)
    core = _core.Experiment(
        kind=system.kind,
        time=time.tolist(),
        inputs=_inputs(experiment, system, replay),
        loop=_loop(experiment, system, replay, measured),
        position=position.tolist(),
        velocity=velocity.tolist(),
        taken=start.taken(shape),
        reading=start.reading,
    )
    scale = scales_of(time, measured[[s.axis is not None for s in outputs]])
    ready = Prepared(
        name=experiment.name, core=core, measured=measured, start=start, initial=free, initial_sd=sd,
        position_scale=scale[0], velocity_scale=scale[1],
    )  # fmt: skip

    def simulate(sense: float, num: int) -> np.ndarray:
        begun = core.last_moved(sense).until(num)
        run = _core.simulate(system.kind, system.values(), system.active(), begun, [], ready.settings(EXACT))
        return np.asarray(run["outputs"])

    return replace(ready, core=core.last_moved(last_sense(experiment, system.info, measured, simulate)))


def as_experiment(given: Experiment | pd.DataFrame) -> Experiment:
    """The experiment, or one made of a frame. Raises ParameterError for anything else, such as a name, DatasetError for
    a frame whose time is a column."""
    if isinstance(given, Experiment):
        return given
    if not isinstance(given, pd.DataFrame):
        expected = "an experiment of a dataset, such as dataset['run-1'], or a frame indexed by time"
        raise ParameterError(f"experiment is of type {type(given).__name__}: expected {expected}")
    if "t" in given.columns:
        raise DatasetError("column 't' is not the index: expected a frame indexed by time; use set_index('t')")
    return Experiment(name="given", data=given)


def choose_loop(experiment: Experiment, controller: Controller | None, replay: str) -> Replay:
    """The replay that `System.simulate` is asked for; "auto" closes the loop where that is possible."""
    if replay not in REPLAYS:
        raise ParameterError(f"replay = {replay!r}: expected one of {', '.join(REPLAYS)}")
    closes = controller is not None and controller.reference in experiment.data.columns
    if replay == "controller" and not closes:
        raise ParameterError("replay = 'controller': the system has no controller, or its reference was not logged")
    return Replay("controller" if closes and replay != "free" else "free")


def _inputs(experiment: Experiment, system: Simulator, replay: Replay) -> list[_core.Signal]:
    data, time = experiment.data, experiment.time
    signals = []
    for k, given in enumerate(system.info.inputs):
        if given.name in data.columns:
            values = _finite(experiment, given.name)
            signals.append(_between(experiment, given, system)(time, values))
        elif given.required and given.replaced_by not in data.columns and not (k == 0 and replay.kind == "controller"):
            raise DatasetError(
                f"input {given.name!r} was not logged; the {replay.kind} replay of {system.kind} needs it"
            )
        else:
            signals.append(_core.Signal())
    return signals


def is_held(experiment: Experiment, given: InputInfo) -> bool:
    """Whether an input keeps each value until the next sample."""
    return experiment.holds.get(given.name, given.between == "hold")


def _between(
    experiment: Experiment, given: InputInfo, system: Simulator
) -> Callable[[np.ndarray, np.ndarray], _core.Signal]:
    """How an input goes from sample to sample. A switch has no mean that is smooth; a system that goes from sample to
    sample sees no kink between them."""
    if experiment.averaged and given.dimension != "ratio":
        return averaged
    if is_held(experiment, given):
        return hold
    near = smoothed_within_noise if system.info.sampled else smoothed
    return {"smooth": near, "sloped": sloped}.get(given.between, linear)


def _require_time(experiment: Experiment) -> None:
    """Raise DatasetError unless the frame is indexed by instants, s, that increase."""
    index = experiment.data.index
    if index.dtype.kind not in "iuf":
        raise DatasetError(f"{experiment.name}: the index is of type {index.dtype}; expected time in s, as numbers")
    time = experiment.time
    if len(time) > 1 and not np.all(np.diff(time) > 0):  # NaN fails here too
        k = int(np.argmin(np.diff(time) > 0)) + 1
        raise DatasetError(f"{experiment.name}: time[{k}] = {time[k]} s after {time[k - 1]} s; expected it to increase")


def _samples(experiment: Experiment, name: str) -> np.ndarray:
    """The samples of a signal, NaN where it was not measured."""
    column = experiment.data[name]
    if column.ndim != 1:
        raise DatasetError(f"{experiment.name}: {column.shape[1]} columns are named {name}; expected one")
    if column.dtype.kind not in "biuf":
        raise DatasetError(f"{experiment.name}: {name} is of type {column.dtype}; expected real numbers")
    return np.asarray(column.to_numpy(dtype=float, na_value=np.nan))


def _finite(experiment: Experiment, name: str) -> np.ndarray:
    """The samples of an input, all of them numbers."""
    values, time = _samples(experiment, name), experiment.time
    broken = np.flatnonzero(~np.isfinite(values))
    if broken.size:
        k = int(broken[0])
        raise DatasetError(f"{experiment.name}: {name} = {values[k]} at t = {time[k]:g} s; expected a finite number")
    return values


def _loop(experiment: Experiment, system: Simulator, replay: Replay, measured: np.ndarray) -> _core.Loop:
    if replay.kind == "free":
        return _core.Loop()
    names = [s.name for s in system.info.outputs]
    if replay.kind == "injection":
        c = names.index(str(replay.output))
        if np.isfinite(measured[c]).sum() < 2:
            reason = "the injection replay needs it in every experiment"
            raise DatasetError(f"{experiment.name}: {names[c]}: fewer than 2 measured samples; {reason}")
        return _core.Loop(
            kind="injection",
            axis=system.info.outputs[c].axis or 0,
            output=c,
            proportional=replay.kp or 0.0,
            derivative=replay.kd or 0.0,
            reference_weight=1.0,
            limit=np.inf,
            sample_time=0.0,
            reference=smoothed(experiment.time, measured[c]),
            disturbance=_core.Signal(),
        )
    controller = system.controller
    if controller is None:
        raise ParameterError("replay = 'controller': the system has no controller")
    disturbance = _disturbance(experiment, controller)
    if replay.feeds_noise:
        fed = fed_noise(controller, experiment, system.info.inputs[0].name)
        disturbance = hold(*fed) if fed else disturbance
    return _controller_loop(experiment, system, controller, disturbance)


def _disturbance(experiment: Experiment, controller: Controller) -> _core.Signal:
    """What is added to the controller's command, as it was stated."""
    if controller.disturbance is None:
        return _core.Signal()
    time, values = experiment.time, _finite(experiment, controller.disturbance)
    return hold(time, values) if experiment.holds.get(controller.disturbance, True) else linear(time, values)


def _controller_loop(
    experiment: Experiment, system: Simulator, controller: Controller, disturbance: _core.Signal
) -> _core.Loop:
    time, held = experiment.time, experiment.holds
    c = [s.name for s in system.info.outputs].index(controller.measured)
    cascade = controller.kind == "cascade"
    reference = _finite(experiment, controller.reference)
    differentiated = not cascade and controller.derivative_on == "error" and controller.sample_time == 0.0
    # A reference that is differentiated needs a slope without jumps; else it goes between samples as the contract says.
    make = hold if held.get(controller.reference, False) else smooth if differentiated else linear
    return _core.Loop(
        kind="controller",
        axis=system.info.outputs[c].axis or 0,
        output=c,
        proportional=controller.kd * controller.kp if cascade else controller.kp,
        derivative=controller.kd,
        reference_weight=1.0 if not cascade and controller.derivative_on == "error" else 0.0,
        limit=controller.limit,
        sample_time=controller.sample_time,
        reference=make(time, reference),
        disturbance=disturbance,
    )
