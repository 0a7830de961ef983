"""Who runs the tasks: threads of this process, an executor of the caller, or a dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from tendonlab.errors import ParameterError

if TYPE_CHECKING:
    from distributed import Client

AHEAD = 2  # tasks per worker that are submitted: one runs, one waits; more would only fill the memory
_Task = TypeVar("_Task")


@dataclass(frozen=True)
class Workers:
    """`num` threads or processes behind an executor. `shares_memory`: whether they may write into the caller's."""

    executor: Executor
    num: int
    shares_memory: bool

    def map_unordered(
        self, tasks: Iterable[_Task], submit: Callable[[Executor, _Task], Future[Any]]
    ) -> Generator[tuple[_Task, Any], None, None]:
        """Each task with its result, in the order in which they end. What was not started is cancelled on the way out;
        what runs is waited for where it writes into memory of the caller."""
        waiting = iter(tasks)
        running: dict[Future[Any], _Task] = {}
        try:
            while True:
                while len(running) < AHEAD * self.num and (task := next(waiting, None)) is not None:
                    running[submit(self.executor, task)] = task
                if not running:
                    return
                for job in wait(running, return_when=FIRST_COMPLETED).done:
                    yield running.pop(job), job.result()
        finally:
            started = [job for job in running if not job.cancel()]
            if self.shares_memory:
                wait(started)


@contextmanager
def workers_of(given: Executor | Client | None) -> Iterator[Workers]:
    """Workers of an executor or a dask client, which stay open, or one thread per processor for as long as needed.
    Raises ParameterError for anything else."""
    if given is None:
        num = len(os.sched_getaffinity(0))
        with ThreadPoolExecutor(max_workers=num) as pool:
            yield Workers(pool, num, shares_memory=True)
    elif isinstance(given, Executor):
        num = getattr(given, "_max_workers", None) or os.cpu_count() or 1
        yield Workers(given, num, shares_memory=False)
    elif hasattr(given, "get_executor"):  # a dask client; importing dask to ask its type would take a second
        yield Workers(given.get_executor(), max(1, sum(given.nthreads().values())), shares_memory=False)
    else:
        expected = "a concurrent.futures executor, a dask.distributed Client, or None"
        raise ParameterError(f"executor is of type {type(given).__name__}: expected {expected}")
