"""Memory of large sweeps: the peak of a process of its own."""

from __future__ import annotations

import multiprocessing
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd

import tendonlab as tl
from benchmarks.options import Options
from benchmarks.sweep import masses
from benchmarks.table import Table, count_text, seconds_text

RIG = Path(__file__).resolve().parents[3] / "data" / "two_inertia"
TOLERANCE = 1e-4
COLUMNS = ("sweep", "peak of the process", "of which before the sweep", "result", "CPU time per point")
NOTES = (
    "Peak: the largest resident memory of a process that makes the sweep. Before it, the process holds Python, its "
    "packages and the table of points.",
)

Measured = tuple[float, float, float, float]  # bytes of the peak, before it and of the result, CPU seconds


def run(options: Options) -> list[Table]:
    million, rig = options.million, options.points
    found = [
        _row(f"J1, {count_text(million)} points, rms of two outputs", million, *_alone(reduced_masses, million)),
        _row(
            f"two_inertia, {count_text(rig)} points, 2 000 samples of three outputs", rig, *_alone(recorded_rigs, rig)
        ),
    ]
    return [Table(COLUMNS, tuple(found), NOTES)]


def _row(text: str, num: int, *measured: float) -> tuple[str, ...]:
    *sizes, seconds = measured
    return (text, *(f"{size / 1e6:.0f} MB" for size in sizes), seconds_text(seconds / num))


def _alone(measure: object, num: int) -> Measured:
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as process:
        return process.submit(measure, num).result()  # type: ignore[arg-type]


def reduced_masses(num: int) -> Measured:
    """The rms of every point; the table of points is not counted."""
    sweep = masses(num)
    return _measured(sweep.problem.system, sweep.table, sweep.problem.experiment, reduce="rms")


def recorded_rigs(num: int) -> Measured:
    """All samples of the bundled rig's first run, at drawn stiffness and friction."""
    rig = tl.load(RIG)
    drawn = np.random.default_rng(1).uniform(0.5, 1.5, (num, 2))
    system = rig.system()
    names = ["cable_stiffness", "joint_coulomb"]
    table = pd.DataFrame(drawn * [system.parameters[name] for name in names], columns=names)
    return _measured(system, table, rig["run-01"])


def _measured(system: tl.System, table: pd.DataFrame, experiment: object, **options: object) -> Measured:
    given = {"experiment": experiment, "tolerance": TOLERANCE, "progress": False, **options}
    tl.sweep(system, table[:2], **given)  # type: ignore[arg-type]  # loads what a sweep needs
    before, began = _peak(), time.process_time()
    found = tl.sweep(system, table, **given)  # type: ignore[arg-type]
    spent = time.process_time() - began
    return _peak(), before, float(found.nbytes), spent


def _peak() -> float:
    """The largest resident memory of this process so far, bytes; getrusage would count its parent's."""
    lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    return 1024.0 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))
