"""One thread for linear algebra: our matrices are small, and threads that wait for the next one burn whole cores."""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def with_one_blas_thread(call: Callable[P, R]) -> Callable[P, R]:
    """`call`, during which numpy and scipy multiply matrices in one thread, in the whole process."""

    @functools.wraps(call)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        import scipy.linalg  # noqa: F401  scipy's own BLAS must be there to be limited
        from threadpoolctl import threadpool_limits

        with threadpool_limits(limits=1, user_api="blas"):
            return call(*args, **kwargs)

    return limited
