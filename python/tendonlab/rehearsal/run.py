"""Diagnose the simulated rigs: in this process or in several, within the time, each stored as it is done."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from tendonlab.data import Dataset
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.progress import track
from tendonlab.rehearsal.cases import RehearsalCase, case_row, number_that_fits
from tendonlab.rehearsal.judge import judged
from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.rehearsal.store import Store
from tendonlab.report.diagnosis import Diagnosis

PILOTS = 2  # cases per process that tell how long one takes
Diagnose = Callable[[Dataset], Diagnosis]
Row = dict[str, Any]


@dataclass(frozen=True)
class Work:
    """What every case needs: the rigs, the seed, and the function that diagnoses."""

    rigs: SimulatedRig
    seed: int
    diagnose: Diagnose

    def row(self, case: RehearsalCase) -> Row:
        """Simulate one rig, diagnose it and judge the answer. What the library cannot do counts as a failure."""
        began = time.monotonic()
        try:
            found = judged(self.diagnose(self.rigs.drawn(case.random(self.seed), case.effects)), case.effect)
        except (NumericalError, DatasetError, ParameterError) as error:
            found = {"outcome": "failed", "message": f"{type(error).__name__}: {error}", "right": False}
            found |= {"verdict": None, "named": [], "on_truth": 0.0, "stated": None}
        return case_row(case, **found, seconds=round(time.monotonic() - began, 2))


@dataclass(frozen=True)
class Progress:
    """How a run ended. `num_left_out`: cases for which there was no time; `interrupted`: by Ctrl-C."""

    num_left_out: int
    seconds: float
    interrupted: bool


def run_cases(
    work: Work, cases: Sequence[RehearsalCase], store: Store, *, seconds: float, jobs: int, progress: bool
) -> Progress:
    """Diagnose the cases that the store lacks, in their order, as many as fit into `seconds`. Ctrl-C ends it."""
    todo = [case for case in cases if case.key not in store.rows]
    began, interrupted = time.monotonic(), False
    pilots, rest = todo[: PILOTS * jobs], todo[PILOTS * jobs :]
    try:
        with _workers(work, jobs) as rows_of:
            shown = track(rows_of(pilots), label="first rigs", total=len(pilots), unit="rig", shown=progress)
            durations = [_kept(store, row) for row in shown]
            if rest:
                left = seconds - (time.monotonic() - began)
                rest = rest[: number_that_fits(durations, left, jobs)]
                in_time = _until(rest, began + seconds - sum(durations) / len(durations))
                for row in track(rows_of(in_time), label="rehearsal", total=len(rest), unit="rig", shown=progress):
                    _kept(store, row)
    except KeyboardInterrupt:
        interrupted = True
    num_left_out = sum(case.key not in store.rows for case in cases)
    return Progress(num_left_out, time.monotonic() - began, interrupted)


def _kept(store: Store, row: Row) -> float:
    """Store a case; the seconds that it took."""
    store.add(row)
    return float(row["seconds"])


def _until(cases: Iterable[RehearsalCase], deadline: float) -> Iterator[RehearsalCase]:
    for case in cases:
        if time.monotonic() > deadline:
            return
        yield case


@contextmanager
def _workers(work: Work, jobs: int) -> Iterator[Callable[[Iterable[RehearsalCase]], Iterable[Row]]]:
    """A function that gives the row of each case as it is done: here, or in `jobs` processes."""
    if jobs == 1:
        yield lambda cases: map(work.row, cases)
        return
    context = multiprocessing.get_context("spawn")  # a process that has threads must not be forked
    pool = ProcessPoolExecutor(jobs, mp_context=context, initializer=_begin, initargs=(work,))
    try:
        yield lambda cases: _as_done(pool, jobs, cases)
    except BrokenProcessPool as error:
        advice = "with `out`, the same call goes on from there; fewer `jobs` need less memory"
        raise NumericalError(f"one of {jobs} processes died, perhaps for want of memory; {advice}") from error
    finally:
        pool.shutdown(cancel_futures=True)


def _as_done(pool: ProcessPoolExecutor, jobs: int, cases: Iterable[RehearsalCase]) -> Iterator[Row]:
    """Rows in the order in which they end. A case is taken when a process is free for it."""
    waiting, running = iter(cases), set[Future[Row]]()
    while True:
        while len(running) < jobs and (case := next(waiting, None)) is not None:
            running.add(pool.submit(_row, case))
        if not running:
            return
        done, running = wait(running, return_when=FIRST_COMPLETED)
        for job in done:
            yield job.result()


_work: Work  # of a worker process: sent once, not with every case


def _begin(work: Work) -> None:
    """Ctrl-C is for the process that the user started; it ends the workers."""
    global _work
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _work = work


def _row(case: RehearsalCase) -> Row:
    return _work.row(case)
