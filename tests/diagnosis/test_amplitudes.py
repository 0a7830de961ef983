"""Whether data tell the size of an effect whose interval holds 0."""

from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.diagnosis.search.amplitudes import with_told
from tendonlab.diagnosis.search.trial import Trial
from tendonlab.errors import NumericalError

INFO = tl.system_info("cable_joint")
EFFECT = "sensor.cable_force_2:delay"
DELAY = "sensor.cable_force_2_delay"


class System:
    """A simulator with this delay."""

    info = INFO

    def __init__(self, delay: float) -> None:
        self.parameters = {DELAY: delay, "pretension": 100.0}

    def with_parameters(self, values: dict[str, float]) -> "System":
        assert set(values) == {DELAY}
        return System(values[DELAY])


def model(left: float, delay: float = 0.004) -> Any:
    return SimpleNamespace(mean_square=left, system=System(delay), added=(EFFECT,), initial=())


def told(left_by_half: float | None, *, left: float = 1.0, gain: float = 500.0, nothing: bool = True) -> bool:
    """Whether a trial that leaves `left` of the 3 that its base leaves counts, given what half of its delay leaves."""

    def fit(system: System, *, added: object, initial: object, solve: bool) -> Any:
        assert system.parameters[DELAY] == pytest.approx(0.002)
        assert not solve
        if left_by_half is None:
            raise NumericalError("stopped")
        return model(left_by_half)

    fitter: Any = SimpleNamespace(fit=fit)
    trial = Trial(EFFECT, model(left), gain, left_out_gain=gain, doubt=0.0, is_nothing=nothing)
    return not with_told(fitter, model(3.0), trial).is_nothing


def test_an_effect_of_which_half_is_too_little_is_there() -> None:
    """A staircase: the slope at its best stair says nothing, half of the delay leaves a quarter of the error."""
    assert told(1.5)
    assert told(None)


def test_an_effect_that_gains_as_much_by_half_is_none() -> None:
    """A gate that opens one sample earlier by the least of it."""
    assert not told(1.02)


def test_a_small_gain_is_not_looked_at_and_an_effect_that_tells_stays() -> None:
    assert not told(3.0, gain=20.0)
    assert not told(2.9, left=2.1)  # it explains less than half of the rest
    assert told(1.0, nothing=False)
