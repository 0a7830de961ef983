"""CPU time of tests. A busy machine stretches it, but far less than wall time, and `slowness` says by how much."""

import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

BUDGET = 5.0  # s of CPU time of a test that is neither `slow` nor allowed more by the marker `cpu`
LOOP_SECONDS = 0.12  # of CPU time of the loop in `slowness`, on a quiet core of 2024

OVER = "over budget"  # the property of a report that carries `excess`

_shared_seconds = 0.0


def cpu_seconds() -> float:
    """CPU time of this process and of its children that ended, without what was spent on shared results, s."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages) - _shared_seconds


@contextmanager
def shared() -> Iterator[None]:
    """Count what is computed inside as shared by all tests: none pays for it out of its own budget."""
    global _shared_seconds
    before = cpu_seconds()
    yield
    _shared_seconds += cpu_seconds() - before


def slowness() -> float:
    """How many times longer than on a quiet core a fixed loop takes now, at least 1."""
    began = time.process_time()
    sum(i * i for i in range(2_000_000))
    return max(1.0, (time.process_time() - began) / LOOP_SECONDS)


def excess(item: pytest.Item, spent: float) -> str:
    """What to say of a test that took more than its budget; "" for the others."""
    allowed = item.get_closest_marker("cpu")
    budget = allowed.args[0] if allowed else BUDGET
    if item.get_closest_marker("slow") or spent <= budget or spent <= budget * slowness():
        return ""
    return f"{spent:.1f} s of CPU time, {budget:g} s allowed: make it cheaper or mark it slow"
