"""How fast tendonlab is beside other tools at the same error.

Every comparison takes turns (A, B, A, B, ...) in one process on one core, counts CPU time, and lets each tool run at
its cheapest setting that keeps the error. A tool that is not installed is skipped, and its row says so."""

from __future__ import annotations

import argparse
import os
from importlib import import_module

from benchmarks import page
from benchmarks.options import Options

JOBS = ("single", "sweeps", "gradients", "fits", "joint", "growth", "memory", "instructions")


def main() -> None:
    given = _arguments()
    os.sched_setaffinity(0, {given.core if given.core is not None else max(os.sched_getaffinity(0))})
    options = Options(given.rounds, given.points, given.mechanisms, given.starts, given.million)
    for job in given.jobs or JOBS:
        tables = import_module(f"benchmarks.jobs.{job}").run(options)
        text = "\n".join(table.markdown() for table in tables)
        print(f"## {job}\n\n{text}", flush=True)
        if given.write:
            page.write(job, text, rounds=options.rounds)


def _arguments() -> argparse.Namespace:
    usual = Options()
    parser = argparse.ArgumentParser(prog="python tests/benchmarks", description=__doc__)
    parser.add_argument("jobs", nargs="*", metavar="job", help=f"of {', '.join(JOBS)}; all by default")
    parser.add_argument("--rounds", type=int, default=usual.rounds, help="in which tools take turns (%(default)s)")
    parser.add_argument("--points", type=int, default=usual.points, help="of the sweep of J1 (%(default)s)")
    parser.add_argument("--mechanisms", type=int, default=usual.mechanisms, help="of the sweep of J2 (%(default)s)")
    parser.add_argument("--starts", type=int, default=usual.starts, help="of the fits (%(default)s)")
    parser.add_argument("--million", type=int, default=usual.million, help="points of the memory job (%(default)s)")
    parser.add_argument("--core", type=int, help="to run on; the last one by default")
    parser.add_argument("--write", action="store_true", help="put the tables and the figure into docs/performance.md")
    given = parser.parse_args()
    unknown = [job for job in given.jobs if job not in JOBS]
    if unknown:
        parser.error(f"unknown job {unknown[0]!r}; expected {', '.join(JOBS)}")
    return given
