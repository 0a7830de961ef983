"""Outputs that were read at a lower rate than they were logged, each reading held until the next."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.data import Dataset, Experiment

FEWEST = 20  # changes of a record that is judged
IN_STEP = 0.95  # share of the changes at multiples of the period
LARGER, VARIED = 1.5, 0.2  # of the smallest change; share of the changes that must be so large


def held_findings(dataset: Dataset) -> Iterator[Finding]:
    """One finding for each output that changes at every n-th sample only, in all experiments where it moves."""
    for name, spec in dataset.signals.items():
        if spec.role != "output":
            continue
        periods = {e.name: held_for(e, name) for e in dataset if name in e.data.columns}
        held = {experiment: num for experiment, num in periods.items() if num > 1}
        if held:
            num = int(np.median(list(held.values())))
            text = f"{name} changes only every {num} samples, as a sensor that is read at a lower rate and held; keep "
            text += "the samples at which it is read and leave the others empty"
            only = next(iter(held)) if len(held) == 1 < len(periods) else None
            yield Finding(problem="sampling", signal=name, experiment=only, detail=text)


def held_for(experiment: Experiment, name: str) -> int:
    """The samples for which each reading is held; 1 where no regular pattern shows.

    A coarse sensor in slow motion repeats its readings too, but then each change is a single step: one that moved by
    several steps within a sample would also change at the next one."""
    values = experiment.data[name].to_numpy(dtype=float)
    there = np.flatnonzero(np.isfinite(values))
    sizes = np.abs(np.diff(values[there]))
    moved = sizes > 0
    if moved.sum() < FEWEST:
        return 1
    time = experiment.time
    instants = np.round((time - time[0]) / np.median(np.diff(time)))[there][1:][moved].astype(int)
    lengths, counts = np.unique(np.diff(instants), return_counts=True)
    num = int(lengths[np.argmax(counts)])
    in_step = np.bincount(instants % num).max() / len(instants) if num > 1 else 0.0
    is_repeated = np.mean(~moved) > IN_STEP * (1.0 - 1.0 / num)  # not missing between the readings
    is_varied = np.mean(sizes[moved] > LARGER * sizes[moved].min()) > VARIED
    return num if in_step > IN_STEP and is_repeated and is_varied else 1
