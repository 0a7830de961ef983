"""The gap that is stated where wrong logs end a diagnosis."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from checking.pendulum import COULOMB, GRAVITY, INERTIA, VISCOUS, record
from tendonlab.diagnosis import fault


def test_the_nominal_gap_is_the_rms_over_all_held_out_experiments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rig = record().write(tmp_path)
    errors = iter([{"joint_angle": 1.0}, {"joint_angle": 4.0}, {"joint_angle": 7.0}])
    monkeypatch.setattr(fault, "_errors", lambda *_: next(errors))
    several = replace(rig, experiments=rig.train[:3])
    gap = fault._nominal_gap(several, rig.system(), "free")["joint_angle"]
    assert gap["nominal"] == pytest.approx(2.0)
    assert gap["noise_floor"] == pytest.approx(2e-4, rel=0.5)  # as it was added


def test_without_one_of_the_simulations_nothing_is_stated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rig = record().write(tmp_path)
    for broken in (None, {}):
        errors = iter([{"joint_angle": 1.0}, broken, {"joint_angle": 7.0}])
        monkeypatch.setattr(fault, "_errors", lambda *_, errors=errors: next(errors))
        several = replace(rig, experiments=rig.train[:3])
        assert fault._nominal_gap(several, rig.system(), "free")["joint_angle"]["nominal"] is None


def test_the_error_of_an_experiment_is_the_mean_square_of_its_own_samples(tmp_path: Path) -> None:
    """Of the pendulum without input and motion the simulator stays where it is: the error is the angle itself."""
    rig = record().write(tmp_path)
    first = rig.train[0]
    angle = 0.01 * np.sin(np.arange(len(first.data)))
    still = first.data.assign(motor_torque=0.0, joint_angle=angle)
    run = replace(first, name="still", data=still, initial={"joint_angle": 0.0, "joint_velocity": 0.0})
    (found,) = fault._errors(run, rig.system(), "free").values()  # type: ignore[union-attr]
    assert found == pytest.approx(np.mean(angle**2), rel=0.05)


def test_the_error_of_right_logs_is_small(tmp_path: Path) -> None:
    """A simulator with the true values: less than a thousandth of the power of the motion is left."""
    rig = record().write(tmp_path)
    system = rig.system().with_parameters(
        {"inertia": INERTIA, "gravity_torque": GRAVITY, "coulomb": COULOMB, "viscous": VISCOUS}
    )
    for run in rig.train[:2]:
        (found,) = fault._errors(run, system, "free").values()  # type: ignore[union-attr]
        assert found < 1e-3 * np.var(run.data["joint_angle"])
