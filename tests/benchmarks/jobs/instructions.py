"""Instructions of simulations, counted by valgrind, beside the most that a core could retire.

The count is the difference between two processes that differ only in the number of simulations."""

from __future__ import annotations

import os
import pickle
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import tendonlab as tl
from benchmarks import mass, mechanism
from benchmarks.options import Options
from benchmarks.problem import Problem
from benchmarks.table import Table, seconds_text
from tendonlab import _core

TOLERANCE = 1e-4
PER_CYCLE = 4.0  # instructions that a core of today retires at most in the long run
COLUMNS = ("job", "steps tried", "instructions", "per step", "CPU time", "instructions per ns")
TIMED = """
import pickle, sys, time
from tendonlab import _core
with open(sys.argv[1], "rb") as file:
    *given, options = pickle.load(file)
least = float("inf")
for _ in range(int(sys.argv[3])):
    began = time.process_time()
    for _ in range(int(sys.argv[2])):
        _core.simulate(*given, [], _core.Settings(**options))
    least = min(least, (time.process_time() - began) / int(sys.argv[2]))
print(least)
"""
SINGLE = """
import pickle, sys
from tendonlab import _core
with open(sys.argv[1], "rb") as file:
    *given, options = pickle.load(file)
for _ in range(int(sys.argv[2])):
    _core.simulate(*given, [], _core.Settings(**options))
"""


def run(options: Options) -> list[Table]:
    if shutil.which("valgrind") is None:
        return [Table(COLUMNS, (), ("Skipped: valgrind is not installed.",))]
    found = [
        _single(mass.driven(force=False), 100, options.rounds),
        _single(mass.driven(force=True), 100, options.rounds),
        _single(mechanism.coupled(tensions=True), 10, options.rounds),
    ]
    note = (
        f"Tolerance {TOLERANCE:.0e}, outputs at 1 kHz included, by the build for AVX2: valgrind knows no AVX-512. A "
        f"core retires about {PER_CYCLE:g} instructions per cycle at most{_clock()}. Divisions and chains of dependent "
        "operations keep real code below that."
    )
    return [Table(COLUMNS, tuple(found), (note,))]


def _single(problem: Problem, runs: int, rounds: int) -> tuple[str, ...]:
    system = problem.system
    given = (system.kind, system.values(), system.active(), problem.core_experiment())
    steps = _core.simulate(*given, [], _core.Settings(tolerance=TOLERANCE))["attempts"]
    options = {"tolerance": TOLERANCE, "ports": problem.ports, "outputs": problem.reads}
    count = _counted(SINGLE, (*given, options), (1, runs + 1)) / runs
    seconds = _seconds((*given, options), runs, rounds)
    thousand, per_ns = f"{count / 1e3:.0f} thousand", f"{count / seconds / 1e9:.1f}"
    return (problem.name, str(steps), thousand, f"{count / steps:.0f}", seconds_text(seconds), per_ns)


def _seconds(given: object, runs: int, rounds: int) -> float:
    """The least CPU time of a simulation by the build whose instructions are counted."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "given"
        path.write_bytes(pickle.dumps(given))
        command = [sys.executable, "-c", TIMED, str(path), str(runs), str(rounds)]
        return float(subprocess.run(command, env=_environment(), capture_output=True, text=True, check=True).stdout)


def _counted(script: str, given: object, numbers: tuple[int, int]) -> int:
    """Instructions that the second number costs more than the first."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "given"
        path.write_bytes(pickle.dumps(given))
        few, many = (_instructions(script, path, num) for num in numbers)
    return many - few


def _instructions(script: str, path: Path, num: int) -> int:
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    command = [*tool, sys.executable, "-c", script, str(path), str(num)]
    done = subprocess.run(command, env=_environment(), capture_output=True, text=True, check=True)
    return int(re.findall(r"Collected : (\d+)", done.stderr)[0])


def _environment() -> dict[str, str]:
    package = str(Path(tl.__file__).parents[1])
    return {**os.environ, "PYTHONPATH": package, "PYTHONHASHSEED": "0", "TENDONLAB_CORE": "base"}


def _clock() -> str:
    """The nominal clock of the core as the system states it."""
    path = Path("/proc/cpuinfo")
    rates = re.findall(r"cpu MHz\s*: ([\d.]+)", path.read_text(encoding="utf-8")) if path.exists() else []
    return (
        f", {PER_CYCLE * float(rates[0]) / 1e3:.0f} per ns at the nominal {float(rates[0]) / 1e3:.1f} GHz"
        if rates
        else ""
    )
