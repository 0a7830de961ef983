"""How a rig's sensors read: their noise, its memory and their resolution, and the scatter of friction between runs."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from tendonlab import _core
from tendonlab.data import Dataset
from tendonlab.diagnosis.diagnose import best_model
from tendonlab.diagnosis.floor import first_floor
from tendonlab.errors import DatasetError, NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.floor import Sensitivities, remaining, sensitivities
from tendonlab.fitting.noise import BURN_IN, RUN_TO_RUN, Floor, drawn, remembered, without_rounding
from tendonlab.fitting.rough import rough_fit
from tendonlab.simulation.reading import noise_sd

if TYPE_CHECKING:
    from tendonlab.simulation.records import SignalSpec


@dataclass(frozen=True)
class Sensor:
    """The sensor of one output, SI. `noise`: sd of what drives the noise; `memory`: its autoregression, newest sample
    first; `resolution`: 0 where readings are not rounded."""

    name: str
    noise: float
    memory: tuple[float, ...] = ()
    resolution: float = 0.0

    @property
    def total(self) -> float:
        """Sd of the noise, with its memory."""
        return total_sd(self.noise, self.memory)

    def drawn(self, num: int, random: np.random.Generator) -> np.ndarray:
        """Noise of `num` samples."""
        return drawn(self.noise, self.memory, num, random)

    def rounded(self, read: np.ndarray) -> np.ndarray:
        """Readings, shape (n,), to its resolution."""
        return np.asarray(np.round(read / self.resolution) * self.resolution if self.resolution else read)


@dataclass(frozen=True)
class Noise:
    """All that makes two runs of one experiment differ: the sensors, and the sd of the logarithm of each element's
    friction. `repeated`, `modelled`: whether repeats of the rig showed it, or what a model leaves. `command`: sd of
    white noise in the logged command, SI, that does not move the rig."""

    sensors: tuple[Sensor, ...]
    scatter: float
    repeated: bool
    command: float = 0.0
    modelled: bool = False

    @property
    def words(self) -> str:
        """Where it comes from."""
        if self.repeated:
            return "what the repeats of the rig do not repeat"
        return "what the best model leaves of the logs" if self.modelled else "the sensors' white noise"


def noise_of_rig(rig: Dataset, case: Case, floor: Floor | None) -> Noise:
    """What the `floor` of the logs holds; without one the sensors' white noise, as stated or estimated from the logs,
    and the library's default scatter of friction."""
    sensors = []
    for c in case.measured:
        signal = rig.signals[case.outputs[c]]
        resolution = signal.resolution or 0.0
        if floor is not None:
            own = _without_rounding(floor.sd[c], floor.ar[c], resolution)
            sensors.append(Sensor(signal.name, own, tuple(floor.ar[c]), resolution))
        else:
            sensors.append(Sensor(signal.name, _white(signal, case, c), (), resolution))
    if floor is None:
        return Noise(tuple(sensors), RUN_TO_RUN, repeated=False)
    return Noise(tuple(sensors), floor.tau, floor.repeated, modelled=not floor.repeated)


def stated_noise(rig: Dataset) -> Noise:
    """As dataset.toml states it, for a rig without logs. Raises DatasetError for an output without `noise_sd` and
    without `resolution`."""
    sensors = []
    for name in rig.outputs:
        signal = rig.signals[name]
        if signal.noise_sd is None and signal.resolution is None:
            raise DatasetError(
                f"dataset.toml, key signals.{name}.noise_sd: is missing; expected the sensor's noise, in "
                f"{signal.unit}, because there are no logs to estimate it from"
            )
        sensors.append(Sensor(name, signal.noise_sd or 0.0, (), signal.resolution or 0.0))
    return Noise(tuple(sensors), RUN_TO_RUN, repeated=False)


def floor_of_logs(rig: Dataset, case: Case, *, progress: bool = False) -> Floor | None:
    """What the repeats of the rig leave; where nothing repeats, what the best model of a diagnosis leaves, with its
    memory: the noise of most rigs has a slow part, which no stated `noise_sd` holds. None where no model runs."""
    labels = [e.repeat for e in rig if e.repeat is not None]
    if len(labels) > len(set(labels)):
        with ThreadPoolExecutor() as pool:
            floor, _ = first_floor(case, rough_fit(case, _core.Cancel()), pool)
        if floor.repeated:
            return floor
    try:
        best = best_model(rig, progress=progress)
    except (DatasetError, NumericalError):
        return None
    return remaining(case, at_the_fit(case, best))


def at_the_fit(case: Case, model: Fitted) -> list[Sensitivities]:
    """Of each training experiment at a model, which may have been fitted without the controller and with friction that
    differs from run to run."""
    system = replace(model.system, controller=case.system.controller)
    own = [initial[: len(case.own_mean(i))] for i, initial in zip(case.train, model.initial, strict=True)]
    return [sensitivities(case, system, i, start) for i, start in zip(case.train, own, strict=True)]


def noise_of_command(rig: Dataset, name: str) -> float:
    """Sd of the white noise in the logs of a command, SI."""
    return float(np.median([noise_sd(e.data[name].to_numpy(dtype=float)) for e in rig]))


def total_sd(innovation: float, memory: Sequence[float]) -> float:
    """Sd of noise that `innovation` drives through an autoregression."""
    response = remembered(np.eye(1, BURN_IN)[0], memory)
    return innovation * float(np.sqrt(response @ response))


def _without_rounding(innovation: float, memory: list[float], resolution: float) -> float:
    """The sd that drives noise with memory, before rounding: what repeats differ by holds that of the rounding."""
    total = total_sd(innovation, memory)
    return innovation * float(np.sqrt(max(0.0, 1.0 - resolution**2 / 12.0 / total**2)))


def _white(signal: SignalSpec, case: Case, c: int) -> float:
    """White noise before rounding: an estimate from rounded readings holds that of the rounding already."""
    if signal.noise_sd is not None:
        return signal.noise_sd
    return without_rounding(float(case.noise[c]), signal)
