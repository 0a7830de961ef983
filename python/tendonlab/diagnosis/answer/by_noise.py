"""How far noise alone takes a perfect simulator from the floor on held-out experiments.

An injection reads noisy logs. Where dry friction holds a part, noise of the motion and of the command decides where the
part stops, and the injection cannot move the part from there: stops leave more than the motion of which repeats told
the floor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tendonlab.diagnosis.answer import heldout
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.noise import Floor, drawn
from tendonlab.simulation.prepare import prepare
from tendonlab.simulation.reading import noise_sd
from tendonlab.simulation.system import System

ROUNDS = 1  # of replays of a replay: after more of them errors grow again
DRAWS = 4  # of the noise


def more_by_noise(case: Case, system: System, floor: Floor, held_out: Sequence[int], *, seed: int) -> float:
    """By how many times more noise alone may leave (mean square) of the experiments `held_out`, replayed by injection
    by the `system` that made them, than it leaves of those that repeat and so tell the `floor`; at least 1."""
    labels = [case.experiments[i].repeat for i in case.train]
    repeats = [i for i, label in zip(case.train, labels, strict=True) if label is not None and labels.count(label) > 1]
    if case.replay.kind != "injection" or not case.test or not repeats:
        return 1.0
    rng = np.random.default_rng(seed)
    try:
        held, told = (np.mean([_left(case, system, floor, i, rng) for i in of], axis=0) for of in (held_out, repeats))
    except NumericalError:  # what cannot be simulated explains nothing
        return 1.0
    most = float(np.max(held) / np.mean(told))  # a few stops make draws differ
    return max(1.0, most) if np.isfinite(most) else 1.0


def _left(case: Case, system: System, floor: Floor, i: int, rng: np.random.Generator) -> list[float]:
    """Mean square over the floor that a replay by the `system` leaves of logs that it made itself and that hold noise
    of the `floor`, averaged over the outputs, for each of some draws of noise."""
    truth = heldout.replay(case, [system], [i]).outputs[0]
    for _ in range(ROUNDS):
        truth = heldout.replay(_logged(case, i, truth), [system], [i]).outputs[0]
    levels = []
    for _ in range(DRAWS):
        noise = [drawn(sd, memory, truth.shape[1], rng) for sd, memory in zip(floor.sd, floor.ar, strict=True)]
        logged = _logged(case, i, truth + noise, rng)
        levels.append(heldout.level(heldout.replay(logged, [system], [i]), floor))
    return levels


def _logged(case: Case, i: int, outputs: np.ndarray, rng: np.random.Generator | None = None) -> Case:
    """The case in which experiment i logged those outputs; with `rng` the command once more with noise as it has."""
    experiment, names, command = case.experiments[i], case.outputs, case.system.info.command
    told = {names[c]: outputs[c] for c in case.measured if names[c] in experiment.data}
    if rng is not None and command is not None and command.name in experiment.data:
        read = experiment.data[command.name].to_numpy(dtype=float)
        told[command.name] = read + noise_sd(read) * rng.normal(size=len(read))
    again = prepare(replace(experiment, data=experiment.data.assign(**told)), case.system, case.replay)
    judged = np.isfinite(case.prepared[i].measured)
    ready = replace(case.prepared[i], core=again.core, measured=np.where(judged, outputs, np.nan))
    return replace(case, prepared=(*case.prepared[:i], ready, *case.prepared[i + 1 :]))
