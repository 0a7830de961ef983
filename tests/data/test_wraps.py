"""Angles that wrap: taken back to the motion that was made, on motions that are known."""

import numpy as np
import pandas as pd
import pytest

from tendonlab.data import load
from tendonlab.data.wraps import jumps, unwrapped

TIME = np.arange(0.0, 6.0, 0.01)
FAR, NEAR = 4.5 * np.sin(TIME), 0.5 * np.sin(TIME)


def wrapped(angle, low=-np.pi):
    return (angle - low) % (2.0 * np.pi) + low


@pytest.fixture
def rig(draft):
    """A joint that turns far in the first of two experiments, and in the second little."""
    for name, angle in (("one.csv", FAR), ("two.csv", NEAR)):
        draft.frames[name] = pd.DataFrame({"t": TIME, "u": np.cos(TIME), "q": angle})
    del draft.toml["signals"]["joint_velocity"]
    return draft


@pytest.mark.parametrize(("unit", "scale"), [("rad", 1.0), ("deg", 180.0 / np.pi)])
@pytest.mark.parametrize("low", [-np.pi, 0.0])
def test_an_angle_that_wraps_is_unwrapped_and_named(rig, write, unit, scale, low):
    """On a scale from 0, the second experiment jumps at each pass through its middle."""
    for name in rig.frames:
        rig.frames[name]["q"] = scale * wrapped(rig.frames[name]["q"], low)
    rig.toml["signals"]["joint_angle"]["unit"] = unit
    found = load(write(rig))
    np.testing.assert_allclose(found["one"].data["joint_angle"], FAR, atol=1e-12)
    np.testing.assert_allclose(found["two"].data["joint_angle"], NEAR, atol=1e-12)
    (warning,) = found.warnings
    assert warning.startswith("joint_angle wraps")
    assert warning.endswith("one" if low < 0.0 else "one, two")


def test_a_record_on_the_other_side_of_the_jump_is_set_to_the_turn_of_the_others(rig, write):
    """The second experiment stays below the jump of a scale from 0 and never passes it; its initial angle is stated."""
    rig.frames["one.csv"]["q"] = wrapped(NEAR, 0.0)
    rig.frames["two.csv"]["q"] = wrapped(0.2 * NEAR - 0.3, 0.0)
    rig.toml["experiments"][1]["initial"] = {"joint_angle": float(2.0 * np.pi - 0.3)}
    found = load(write(rig))
    np.testing.assert_allclose(found["two"].data["joint_angle"], 0.2 * NEAR - 0.3, atol=1e-12)
    assert found["two"].initial["joint_angle"] == pytest.approx(-0.3)


def test_missing_samples_stay_missing(rig, write):
    rig.frames["one.csv"]["q"] = wrapped(FAR)
    rig.frames["one.csv"].loc[[5, 80, 81], "q"] = np.nan
    found = load(write(rig))["one"].data["joint_angle"]
    assert list(np.flatnonzero(found.isna())) == [5, 80, 81]
    np.testing.assert_allclose(found.dropna(), np.delete(FAR, [5, 80, 81]), atol=1e-12)


def test_a_length_never_wraps(rig, write):
    rig.toml["system"]["axis"] = "linear"
    rig.toml["signals"]["motor_torque"]["unit"] = "N"
    rig.toml["signals"]["joint_angle"]["unit"] = "m"
    rig.frames["one.csv"]["q"] = wrapped(FAR)
    found = load(write(rig))
    np.testing.assert_array_equal(found["one"].data["joint_angle"], rig.frames["one.csv"]["q"])
    assert found.warnings == ()


@pytest.mark.parametrize(
    "angle", [FAR, np.where(TIME > 3.0, 4.0, 0.0), np.where(TIME > 3.0, 9.0, 0.0), 100.0 * np.sin(100.0 * TIME)]
)
def test_steps_of_another_size_and_fast_motion_are_no_wraps(angle):
    assert not jumps(angle)
    np.testing.assert_array_equal(unwrapped(angle), angle)


def with_reference(rig, asked):
    """The rig under a controller whose first experiment was `asked` for this."""
    rig.toml["controller"] = {"kind": "pd", "kp": 3.0, "kd": 0.1, "measured": "joint_angle", "reference": "asked"}
    rig.toml["signals"]["asked"] = {"column": "r", "unit": "rad"}
    rig.frames["one.csv"]["r"], rig.frames["two.csv"]["r"] = asked, NEAR
    return rig


@pytest.mark.parametrize("lead", [0.05, -0.05])
def test_a_reference_that_wraps_goes_with_the_angle_that_follows_it(rig, write, lead):
    """The motion begins beside the jump, on the one side or the other of it."""
    motion = FAR + np.pi - 0.02
    rig.frames["one.csv"]["q"] = wrapped(motion)
    found = load(write(with_reference(rig, wrapped(motion + lead))))
    data = found["one"].data
    np.testing.assert_allclose(data["asked"] - data["joint_angle"], lead, atol=1e-12)
    assert np.abs(np.diff(data["joint_angle"])).max() < 0.1
    assert {warning.split()[0] for warning in found.warnings} == {"asked", "joint_angle"}


def test_a_reference_may_ask_for_a_whole_turn_at_once(rig, write):
    asked = np.where(TIME > 1.0, 2.0 * np.pi, 0.0)
    rig.frames["one.csv"]["q"] = np.where(TIME > 1.0, 2.0 * np.pi * (1.0 - np.exp(1.0 - TIME)), 0.0)
    found = load(write(with_reference(rig, asked)))
    np.testing.assert_array_equal(found["one"].data["asked"], asked)
    assert found.warnings == ()


def test_two_angles_that_move_as_one_lie_at_one_turn(two_inertia, write):
    """Without a gear, motor and joint begin on the two sides of the jump."""
    two_inertia.toml["system"]["parameters"]["gear_ratio"]["value"] = 1.0
    two_inertia.toml["signals"]["motor_angle"] = {"column": "m", "unit": "rad"}
    for name in two_inertia.frames:
        joint = FAR + np.pi - 0.02
        angles = {"q": wrapped(joint), "m": wrapped(joint + 0.04)}
        two_inertia.frames[name] = pd.DataFrame({"t": TIME, "u": np.cos(TIME), **angles})
    for experiment in load(write(two_inertia)):
        data = experiment.data
        np.testing.assert_allclose(data["motor_angle"] - data["joint_angle"], 0.04, atol=1e-12)


def test_a_record_that_is_nowhere_near_the_others_stays_on_its_turn(rig, write):
    """The first experiment passes the jump; the second, far from where the first one moved, does not."""
    rig.frames["one.csv"]["q"] = wrapped(3.0 + np.sin(TIME))
    rig.frames["two.csv"]["q"] = -1.0 + 0.3 * np.sin(TIME)
    found = load(write(rig))
    np.testing.assert_allclose(found["two"].data["joint_angle"], -1.0 + 0.3 * np.sin(TIME), atol=1e-12)
