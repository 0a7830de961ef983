"""Public functions that compute for long take one thread for linear algebra, and leave the others' choice alone."""

import inspect
import threading
from concurrent.futures import Future, ThreadPoolExecutor

import pytest
import scipy.linalg  # noqa: F401
from threadpoolctl import threadpool_info, threadpool_limits

import tendonlab as tl
from tendonlab.threads import with_one_blas_thread


def _threads() -> set[int]:
    return {pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas"}


def test_blas_has_one_thread_during_the_call_and_what_it_had_afterwards() -> None:
    with threadpool_limits(limits=2, user_api="blas"):
        assert with_one_blas_thread(_threads)() == {1}
        assert _threads() == {2}


def test_a_call_that_raises_leaves_the_threads_as_they_were() -> None:
    def fail() -> None:
        raise ValueError("as asked")

    with threadpool_limits(limits=2, user_api="blas"):
        with pytest.raises(ValueError, match="as asked"):
            with_one_blas_thread(fail)()
        assert _threads() == {2}


def test_calls_that_overlap_leave_the_threads_as_they_were() -> None:
    """The first call ends while the second, in another thread, still runs."""
    begun, first_ended = threading.Event(), threading.Event()

    def second() -> bool:
        begun.set()
        return first_ended.wait(10)

    def first(pool: ThreadPoolExecutor) -> Future[bool]:
        running = pool.submit(with_one_blas_thread(second))
        assert begun.wait(10)
        return running

    with threadpool_limits(limits=2, user_api="blas"), ThreadPoolExecutor(1) as pool:
        running = with_one_blas_thread(first)(pool)
        first_ended.set()
        assert running.result(timeout=10)
        assert _threads() == {2}


@pytest.mark.parametrize("call", [tl.check, tl.diagnose, tl.identify, tl.rehearse])
def test_long_calls_are_limited_and_keep_their_signature(call: object) -> None:
    assert hasattr(call, "__wrapped__")
    assert "args" not in inspect.signature(call).parameters  # type: ignore[arg-type]
