"""What is said about a wrong factor: whose it is, which confusion it suggests, what to turn or to check."""

import numpy as np
import pytest

import tendonlab as tl
from checking.pendulum import record
from tendonlab.checking.factors import _hint, factor_findings
from tendonlab.checking.regression import Fit
from tendonlab.checking.scales import Factor, _blocks

FIT = Fit(0.0, np.zeros(0), np.zeros(0), np.zeros(1), np.zeros((1, 1)), np.ones((1, 1)), 0.0)


@pytest.fixture(scope="module")
def rig(tmp_path_factory: pytest.TempPathFactory) -> tl.Dataset:
    return record().write(tmp_path_factory.mktemp("rig"))


def factor(value: float, *signals: str) -> Factor:
    return Factor(signals, value, FIT)


@pytest.mark.parametrize(
    ("value", "hint"),
    [
        (57.3, "near 180/pi: degrees and radians"),
        (1 / 57.3, "near pi/180: degrees and radians"),
        (1100.0, "near 1000: a prefix such as milli"),
        (9.5e-7, "near 1/1000000: a prefix such as micro"),
        (6.0, "near 2 pi: turns and radians"),
        (1 / 9.81, "near 1/9.81: kilogram-force and newton"),
        (0.5, "near 1/2: a diameter and a radius"),
        (2.2, "near 2: a diameter and a radius"),
        (365.0, "near 360: turns and degrees"),
        (60.0, "near 60: minutes and seconds"),
    ],
)
def test_a_known_ratio_is_named(value: float, hint: str) -> None:
    assert hint in _hint(value)


@pytest.mark.parametrize("value", [2.5, 0.4, 20.0, 1 / 20.0, 700.0, 1.0])
def test_other_ratios_suggest_nothing(value: float) -> None:
    assert _hint(value) == ""


def test_nothing_wrong_is_no_finding(rig: tl.Dataset) -> None:
    assert factor_findings([], rig) == []


def test_only_factors_of_the_same_kind_are_alternatives(rig: tl.Dataset) -> None:
    (found,) = factor_findings(
        [factor(-1.0, "joint_angle"), factor(2.0, "time"), factor(-1.1, "motor_torque"), factor(-1.0, "joint_angle")],
        rig,
    )
    assert (found.problem, found.signal, found.alternatives) == ("sign", "joint_angle", ("motor_torque",))
    assert (found.factor, found.blocks) == (-1.0, True)
    assert "turn the sign of joint_angle, or of motor_torque" in found.detail
    assert "size" not in found.detail


def test_channels_that_are_turned_together_are_told_together(rig: tl.Dataset) -> None:
    """On a rig with two angles one of them alone, turned, would be a second mistake."""
    found = factor_findings([factor(-1.0, "motor_torque"), factor(-1.0, "motor_angle", "joint_angle")], rig)
    assert [f.detail.split("; ")[1] for f in found] == [
        "turn the sign of motor_torque, or of motor_angle and joint_angle"
    ]


def test_a_sign_with_a_wrong_size_says_both(rig: tl.Dataset) -> None:
    (found,) = factor_findings([factor(-57.3, "joint_angle")], rig)
    assert "−57.3 times as stated; turn the sign of joint_angle. Their size is wrong as well" in found.detail
    assert "degrees and radians" in found.detail
    assert "size" not in factor_findings([factor(-0.7, "joint_angle")], rig)[0].detail
    assert "size" in factor_findings([factor(-0.5, "joint_angle")], rig)[0].detail


def test_a_scale_names_the_unit_and_the_constant_that_turns_the_command_into_an_effort(rig: tl.Dataset) -> None:
    (current,) = factor_findings([factor(1000.0, "motor_torque"), factor(0.001, "joint_angle")], rig)
    assert (current.problem, current.alternatives) == ("scale", ("joint_angle",))
    assert "motor_torque is 1000 times as large" in current.detail
    assert "check its unit (A) and torque_constant. joint_angle may be wrong instead" in current.detail
    (angle,) = factor_findings([factor(0.5, "joint_angle")], rig)
    assert "check its unit (rad) and the constants that scale it" in angle.detail
    (clock,) = factor_findings([factor(60.0, "time")], rig)
    assert "the time is 60 times as large" in clock.detail
    assert "check the unit of the time column" in clock.detail


def test_each_signal_of_a_shared_factor_has_its_finding(rig: tl.Dataset) -> None:
    found = factor_findings([factor(2.0, "joint_angle", "motor_torque"), factor(2.0, "joint_angle")], rig)
    assert [(f.signal, f.alternatives) for f in found] == [("joint_angle", ()), ("motor_torque", ())]


@pytest.mark.parametrize(
    ("value", "blocks"), [(1.0, False), (1.45, False), (1.55, True), (0.69, False), (0.65, True), (-1.0, True)]
)
def test_a_factor_of_less_than_1_5_is_a_parameter(value: float, blocks: bool) -> None:
    assert _blocks(value) == blocks
