"""How far noise alone takes a perfect simulator from the floor on held-out experiments.

An injection reads noisy logs. Where dry friction holds a part, noise of the motion and of the command decides where the
part stops, and the injection cannot move the part from there: stops leave more than the motion of which repeats told
the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tendonlab.diagnosis.answer import heldout
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.noise import Floor
from tendonlab.simulation.prepare import prepare
from tendonlab.simulation.reading import noise_sd
from tendonlab.simulation.signals import spline_near
from tendonlab.simulation.system import System

DRAWS = 4  # of the noise
LITTLE = 0.1  # of the floor: what noise leaves of training experiments tells nothing of the noise below


@dataclass(frozen=True)
class ByNoise:
    """Mean squares over the floor that noise alone leaves: of held-out experiments on average, `left`, and at most over
    that of the experiments that repeat and so tell the floor, `more`; both at least 1."""

    left: float = 1.0
    more: float = 1.0


NO_NOISE = ByNoise()


def left_by_noise(case: Case, system: System, floor: Floor, held_out: Sequence[int], *, seed: int) -> ByNoise:
    """What noise alone leaves of the experiments `held_out`, replayed by injection by the `system` that made them.

    What a log shows as noise need not be: a command may have been that rough. Noise then leaves nothing, of training
    experiments either, and counts as far as those show its errors."""
    labels = [case.experiments[i].repeat for i in case.train]
    repeats = [i for i, label in zip(case.train, labels, strict=True) if label is not None and labels.count(label) > 1]
    if case.replay.kind != "injection" or not case.test or not repeats:
        return NO_NOISE
    rng = np.random.default_rng(seed)
    try:
        left = {i: _left(case, system, floor, i, rng) for i in (*held_out, *case.train)}
        shown = np.mean([heldout.level(heldout.replay(case, [system], [i]), floor) for i in case.train]) - 1.0
    except NumericalError:  # what cannot be simulated explains nothing
        return NO_NOISE
    trained, told, held = (np.array([left[i] for i in of]).mean(axis=0) for of in (case.train, repeats, held_out))
    share = min(1.0, (max(0.0, float(shown)) + LITTLE) / (float(trained.mean()) + LITTLE))
    most = (1.0 + share * float(held.max())) / (1.0 + share * float(told.mean()))  # a few stops make draws differ
    return ByNoise(1.0 + share * float(held.mean()), max(1.0, most))


def _left(case: Case, system: System, floor: Floor, i: int, rng: np.random.Generator) -> list[float]:
    """Mean square over the floor, averaged over the outputs, by which a replay by the `system` of logs that it made
    itself changes where these hold noise as those of experiment i do, for each of some draws of the noise."""
    command, experiment = case.system.info.command, case.experiments[i]
    signals = {case.outputs[c]: case.prepared[i].measured[c] for c in case.measured}
    if command is not None and command.name in experiment.data:
        signals[command.name] = experiment.data[command.name].to_numpy(dtype=float)
    noise = {name: noise_sd(values) for name, values in signals.items()}
    clean = {name: _without_noise(experiment.time, values) for name, values in signals.items()}

    def replayed(told: dict[str, np.ndarray]) -> heldout.Replayed:
        return heldout.replay(_logged(case, i, told), [system], [i])

    def made(by: heldout.Replayed) -> dict[str, np.ndarray]:
        return clean | {case.outputs[c]: by.outputs[0][c] for c in case.measured}

    own = made(replayed(clean))
    before, levels = replayed(own), []
    for _ in range(DRAWS):
        after = replayed({name: v + noise[name] * rng.normal(size=len(v)) for name, v in own.items()})
        changed = zip(after.outputs, before.outputs, case.prepared[i].measured[None], strict=True)
        levels.append(heldout.level(replace(after, residuals=tuple(a - b + 0.0 * m for a, b, m in changed)), floor))
    return levels


def _without_noise(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """What may have been there before noise came to it."""
    kept = np.isfinite(values)
    return np.asarray(spline_near(time[kept], values[kept])(time))


def _logged(case: Case, i: int, told: dict[str, np.ndarray]) -> Case:
    """The case in which experiment i logged these samples of its signals."""
    experiment = case.experiments[i]
    known = {name: values for name, values in told.items() if name in experiment.data}
    again = prepare(replace(experiment, data=experiment.data.assign(**known)), case.system, case.replay)
    ready = replace(case.prepared[i], core=again.core)
    return replace(case, prepared=(*case.prepared[:i], ready, *case.prepared[i + 1 :]))
