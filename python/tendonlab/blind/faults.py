"""Mistakes that people make with logs: a wrong sign, a wrong unit, a run that is late, a file that was saved twice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .description import Array
from .rig import Rig

DRAWN = ("sign", "scale", "scale", "clock", "copy")
TIME = "time"
LATE = (0.02, 0.06)  # s
# Logged over true, by the unit of the signal: degrees, revolutions a minute, a constant twice or half, milli for one.
FACTORS = {"rad": (180 / np.pi, np.pi / 180), "rad/s": (180 / np.pi, 30 / np.pi), TIME: (1000.0,)}
OTHERS = (2.0, 0.5, 1000.0, 0.001)
Logs = dict[str, dict[str, Array]]  # by experiment and signal; "time" is one of them


@dataclass(frozen=True, kw_only=True)
class Fault:
    """A mistake in the logs of a rig.

    `problem`: as `tendonlab check` calls it. `signals`: the wrong one first, then what is as guilty; none where it is a
    matter of whole runs. `experiment`: "" for all. `factor`: what is logged over what is true. `seconds`: how late the
    outputs of the experiment are. `original`: the experiment that a copy repeats.
    """

    problem: str
    signals: tuple[str, ...] = ()
    experiment: str = ""
    factor: float = 1.0
    seconds: float = 0.0
    original: str = ""

    def to_dict(self) -> dict[str, object]:
        """As the truth file has it."""
        return {
            "problem": self.problem,
            "signals": list(self.signals),
            "experiments": [name for name in (self.experiment, self.original) if name],
            "factor": self.factor,
            "seconds": self.seconds,
        }


def draw_fault(rig: Rig, draw: np.random.Generator) -> Fault:
    """One of the mistakes, at random."""
    problem = str(draw.choice(DRAWN))
    names = [experiment.name for experiment in rig.experiments]
    if problem == "copy":
        original, copy = (names[i] for i in draw.permutation(len(names))[:2])
        return Fault(problem=problem, experiment=copy, original=original)
    if problem == "clock":
        samples = max(1, round(float(draw.uniform(*LATE)) / rig.sample_time))
        return Fault(problem=problem, experiment=str(draw.choice(names)), seconds=samples * rig.sample_time)
    units = {rig.system.inputs[0].name: rig.system.inputs[0].unit}
    units |= {output.name: output.unit for output in rig.system.outputs if output.name in rig.outputs}
    if problem == "sign":
        signal = str(draw.choice(list(units)))
        guilty = tuple(units) if len(units) == 2 else ()  # an input and one output: turning either is the same
        return Fault(problem=problem, signals=tuple(dict.fromkeys((signal, *guilty))), factor=-1.0)
    if not rig.system.is_quasistatic:
        units[TIME] = TIME
    signal = str(draw.choice(list(units)))
    factor = float(draw.choice(FACTORS.get(units[signal], OTHERS)))
    return Fault(problem=problem, signals=(signal,), factor=factor)


def spoiled(logs: Mapping[str, Mapping[str, Array]], fault: Fault, *, outputs: tuple[str, ...]) -> Logs:
    """`logs` with the mistake in them; `outputs`: the signals that a late run has late."""
    wrong = {name: dict(log) for name, log in logs.items()}
    if fault.problem == "copy":
        wrong[fault.experiment] = dict(wrong[fault.original])
    elif fault.problem == "clock":
        log = wrong[fault.experiment]
        late = round(fault.seconds / float(log[TIME][1] - log[TIME][0]))
        for name in outputs:  # the motion before the record is that of its first samples, backwards
            log[name] = np.concatenate([log[name][:late][::-1], log[name][:-late]])
    else:
        for log in wrong.values():
            log[fault.signals[0]] = fault.factor * log[fault.signals[0]]
    return wrong
