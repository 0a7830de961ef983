"""Of several starts the fit of least cost counts; what failed is told only where nothing is left."""

from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.errors import NumericalError
from tendonlab.identification.identify import _best


def done(outcome: Any) -> Future[Any]:
    job: Future[Any] = Future()
    if isinstance(outcome, Exception):
        job.set_exception(outcome)
    elif outcome is None:
        job.cancel()
    else:
        job.set_result(outcome)
    return job


def test_the_fit_of_least_cost_counts_and_the_first_among_equals() -> None:
    fits = [SimpleNamespace(cost=cost) for cost in (3.0, 1.0, 1.0)]
    assert _best([done(None), done(NumericalError("no")), *map(done, fits)]) is fits[1]


def test_where_nothing_is_left_the_first_failure_is_raised() -> None:
    with pytest.raises(NumericalError, match="first"):
        _best([done(None), done(NumericalError("first")), done(NumericalError("second"))])
    with pytest.raises(KeyboardInterrupt):
        _best([done(None)])
