"""Delays that are shorter than stamps can tell are no answer."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.search import workshop
from tendonlab.diagnosis.search.delays import (
    LEAST,
    RESOLVED,
    trouble_with_delays,
    twin_delays,
    value_and_interval,
    with_twins_even,
)
from tendonlab.diagnosis.search.trial import Trial
from tendonlab.diagnosis.search.workshop import Refitted
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

NAME = "actuation:delay"


def delayed(fitter: Fitter, steps: float) -> Fitted:
    """The bundled rig with its command late by so many steps of its logs."""
    step = float(np.median(np.diff(fitter.case.experiments[0].time)))
    system = fitter.case.system.with_effects({NAME: {"delay": steps * step}})
    return fitter.fit(system, added=(NAME,), solve=False)


@pytest.mark.parametrize(("steps", "is_told"), [(0.2 * LEAST, False), (2.0 * LEAST, True)])
def test_a_delay_counts_from_a_part_of_a_step_on(fitter: Fitter, steps: float, is_told: bool) -> None:
    assert (trouble_with_delays(fitter.case, delayed(fitter, steps), NAME) == "") is is_told


@pytest.mark.parametrize("steps", [0.0, 1e-9])
def test_a_delay_that_vanishes_is_not_printed_as_0_ms(fitter: Fitter, steps: float) -> None:
    """The least delay of logs at 500 Hz is 0.1 ms, and a hundredth of it the shortest that is printed."""
    text = trouble_with_delays(fitter.case, delayed(fitter, steps), NAME)
    assert text.startswith(
        "its delay of less than 0.001 ms is shorter than 0.1 ms, finer than logs with steps of 2 ms "
    )


def test_a_system_that_answers_by_samples_tells_time_less_closely(fitter: Fitter) -> None:
    """Its stamps tell as much as those of any other, and yet a delay of an eighth of a step is none."""
    late = delayed(fitter, 0.125)
    by_samples: Any = SimpleNamespace(dof=0, effect=fitter.case.system.info.effect)
    system: Any = SimpleNamespace(info=by_samples)
    assert trouble_with_delays(fitter.case, late, NAME) == ""
    case = replace(fitter.case, system=system)
    assert "finer than logs" in trouble_with_delays(case, late, NAME)
    assert trouble_with_delays(case, delayed(fitter, 0.2), NAME) == ""


def test_logs_that_were_thinned_had_finer_stamps(fitter: Fitter) -> None:
    case: Case = fitter.case
    thinned = replace(case, experiments=tuple(replace(e, averaged=True) for e in case.experiments))
    assert trouble_with_delays(thinned, delayed(fitter, 0.2 * LEAST), NAME) == ""


def test_other_effects_have_no_delay(fitter: Fitter, nominal: Fitted) -> None:
    assert trouble_with_delays(fitter.case, nominal, "joint:stribeck") == ""


def alone(case: Case, **replay: Any) -> Case:
    """The case as if the joint angle and the motor torque were all that was logged."""
    noise = np.where(np.array(case.outputs) == "joint_angle", case.noise, np.nan)
    signals = {n: s for n, s in case.dataset.signals.items() if n in ("motor_torque", "joint_angle")}
    dataset = replace(case.dataset, signals=signals, controller=None)
    return replace(case, noise=noise, dataset=dataset, replay=replace(case.replay, **replay))


def test_a_late_command_and_the_only_sensor_late_are_twins_beside_a_logged_command(fitter: Fitter) -> None:
    twins = {"actuation:delay", "sensor.joint_angle:delay"}
    case = alone(fitter.case, kind="injection")
    assert twin_delays(case) == twins
    assert twin_delays(alone(fitter.case, kind="controller")) == set()  # the loop answers a late sensor
    assert twin_delays(replace(case, noise=fitter.case.noise)) == set()  # the motor is measured as well
    gains = {"sensor.joint_angle:delay": 90.0, "joint:presliding": 70.0, "actuation:delay": 60.0}
    trials: Any = [Trial(name, None, gain, 1.0, 0.0) for name, gain in gains.items()]  # type: ignore[arg-type]
    trials[2] = replace(trials[2], left_out_gain=-5.0)  # one of them must not miss what the other reaches
    assert [t.left_out_gain for t in with_twins_even(case, trials)[:2]] == [1.0, 1.0]
    even = [(t.effect, t.evidence_gain) for t in with_twins_even(case, trials)]
    assert even == [("sensor.joint_angle:delay", 90.0), ("actuation:delay", 90.0), ("joint:presliding", 70.0)]


def test_twins_stay_even_where_trials_are_joined(fitter: Fitter, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(workshop, "counted_alike", lambda trials, _: sorted(trials, key=lambda t: -t.evidence_gain))
    late, other = (
        Refitted([Trial(name, None, gain, 1.0, 0.0)], {name: "no fit"})  # type: ignore[arg-type]
        for name, gain in (("sensor.joint_angle:delay", 90.0), ("actuation:delay", 60.0))
    )
    nothing: Any = None
    joined = late.with_others(other, nothing, alone(fitter.case, kind="injection"))
    assert [t.evidence_gain for t in joined.trials] == [90.0, 90.0]
    assert set(joined.failed) == {"sensor.joint_angle:delay", "actuation:delay"}


def test_the_interval_of_a_delay_is_no_finer_than_logs_tell_time(fitter: Fitter) -> None:
    """In quadrature with what residuals tell; other parameters keep theirs."""
    model = delayed(fitter, 2.0)
    finest = RESOLVED * float(np.median(np.diff(fitter.case.experiments[0].time)))
    for name in (f.name for f in model.free):
        value, (lower, upper) = model.value(name)
        told, ends = value_and_interval(fitter.case, model, name)
        assert told == value
        if name == "actuation_delay":
            assert ends[1] - value == pytest.approx(np.hypot(upper - value, finest))
            assert ends[0] == pytest.approx(max(0.0, value - np.hypot(value - lower, finest)))
        else:
            assert ends == (lower, upper)
