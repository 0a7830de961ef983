"""How many points a task has."""

from __future__ import annotations

from tendonlab.sweeping.chunk import Chunk
from tendonlab.sweeping.executors import Workers

FIRST_SECONDS = 0.01  # of simulations by which the length of tasks is chosen
MOST_FIRST = 10_000  # of them
TASK_SECONDS = 1.0  # of a task that travels to another process or onto disk: at least half of it is kept, see below
THREAD_SECONDS = 0.05  # of a task of our own threads: it costs a call
MOST_BYTES = 32e6  # of the results of a task that travels: a few of them wait in memory


def chunk_size(first: Chunk, num_runs: int, workers: Workers, *, on_disk: bool) -> int:
    """Points per chunk by the time that the `first` points took; the first calls are slow, so tasks may turn out
    shorter, hence a target of twice the half second that a task needs to be worth its travel."""
    travels = on_disk or not workers.shares_memory
    num = len(first.messages)
    size = (TASK_SECONDS if travels else THREAD_SECONDS) * num / max(first.seconds, 1e-9)
    if travels:
        size = min(size, MOST_BYTES * num / max(first.kept.nbytes, 1))
    if workers.shares_memory:  # every thread has work to the end
        size = min(size, num_runs / (4 * workers.num))
    return max(1, int(size))
