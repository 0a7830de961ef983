"""The same bits whoever runs the tasks, and memory that is bounded by a chunk."""

from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from sweeps import SIM, blas_threads, extremes, many, pushed

import tendonlab as tl
from tendonlab.sweeping import sizes
from tendonlab.sweeping.chunk import Chunk
from tendonlab.sweeping.executors import Workers

HERE = str(Path(__file__).parent)


@pytest.mark.parametrize("seconds", [0.0, 1e-3, 10.0])
def test_the_size_of_tasks_changes_no_bit(seconds: float, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tl.sweep(SIM, many(200), experiment=pushed(), progress=False)
    monkeypatch.setattr(sizes, "THREAD_SECONDS", seconds)
    monkeypatch.setattr(sizes, "FIRST_SECONDS", 0.0)
    assert whole.identical(tl.sweep(SIM, many(200), experiment=pushed(), progress=False))


@pytest.mark.parametrize("num_threads", [1, 3])
def test_the_number_of_threads_changes_no_bit(num_threads: int, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = tl.sweep(SIM, many(200), experiment=pushed(), progress=False)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: set(range(num_threads)))
    assert whole.identical(tl.sweep(SIM, many(200), experiment=pushed(), progress=False))


@pytest.mark.parametrize("processes", [False, True])
def test_a_function_multiplies_matrices_in_one_thread(processes: bool) -> None:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) if processes else nullcontext() as executor:
        found = tl.sweep(SIM, many(3), experiment=pushed(), reduce=blas_threads, executor=executor, progress=False)
    assert (found["blas_threads"] == 1.0).all()


def test_tasks_that_travel_take_at_least_half_a_second_unless_their_results_are_large() -> None:
    with ThreadPoolExecutor(1) as pool:
        lent = Workers(pool, 2, shares_memory=False)
        light = Chunk(np.empty((10, 2)), [""] * 10, seconds=10 * 50e-6)
        assert sizes.chunk_size(light, 10**6, lent, on_disk=False) * 50e-6 >= 0.5
        heavy = Chunk(np.empty((10, 3, 2000)), [""] * 10, seconds=10 * 50e-6)
        assert sizes.chunk_size(heavy, 10**6, lent, on_disk=False) * heavy.kept[0].nbytes <= 32e6
        slow = Chunk(np.empty((1, 3, 2000)), [""], seconds=7.0)
        assert sizes.chunk_size(slow, 10, lent, on_disk=True) == 1


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_bits(tmp_path: Path) -> None:
    """Two workers, processes of one thread each."""
    from distributed import Client, LocalCluster

    table, given = many(3000), {"experiment": pushed(), "progress": False}
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        client.run(sys.path.insert, 0, HERE)
        for kept in ({}, {"reduce": extremes}):
            far = tl.sweep(SIM, table, executor=client, **given, **kept)
            assert far.identical(tl.sweep(SIM, table, **given, **kept))
        stored = tl.sweep(SIM, table, executor=client, out=tmp_path / "runs.zarr", **given)
        assert stored.compute().identical(tl.sweep(SIM, table, **given))
        assert client.submit(int, "3").result() == 3  # a client that was lent stays open


MEASURED = f"""
import resource, sys; sys.path.insert(0, {HERE!r})
import xarray
import tendonlab as tl
from sweeps import SIM, many, pushed
def sweep(n): tl.sweep(SIM, many(n), experiment=pushed(), reduce="rms", progress=False)
sweep(100)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
sweep(20_000)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@pytest.mark.cpu(15)
def test_a_summary_needs_no_memory_for_the_runs() -> None:
    """20 000 runs of 2 x 200 samples are 64 MB; what is kept, and blocks of 4 MB in each thread, are far less."""
    done = subprocess.run([sys.executable, "-c", MEASURED], capture_output=True, text=True, check=True)
    assert int(done.stdout) < 30_000  # kB
