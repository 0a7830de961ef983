"""The system "ccsrm" in the limits in which it can be worked out by hand."""

import numpy as np
import pandas as pd
import pytest

from integrate.rig import differences, relative, run
from tendonlab.errors import ParameterError
from tendonlab.simulation.system import System

K, T_P, R, WRAP, MU = 5e4, 50.0, 0.012, 1.69, 0.15
OWN = {"cable_stiffness": K, "pretension": T_P, "pulley_radius": R, "initial_wrap_angle": WRAP, "inertia": 1e-3}
DRY = ("contact:capstan",)
T = np.linspace(0.0, 8.0, 1601)


def driven(amplitude: float = 0.15, period: float = 8.0) -> pd.DataFrame:
    angle = amplitude * 0.5 * (1 - np.cos(2 * np.pi * T / period))
    return pd.DataFrame({"driver_angle": angle}, index=pd.Index(T, name="t"))


def dry(**changes: float) -> System:
    parameters = {**OWN, "friction_coefficient": MU, "smallest_level": 0.0, **changes}
    return System(kind="ccsrm", parameters=parameters, effects=DRY)


def test_dry_friction_lags_by_the_closed_form() -> None:
    """Without a bristle joint 1 slides at the error T_p tanh(mu theta_w0) / (k r) of S4 (20), whatever its angle, and
    sticks between: at the reversal both contacts of joint 1 hold it, on their own radius."""
    log = driven()
    run = dry().simulate(log, tolerance=1e-8)
    error = log["driver_angle"] - run["joint_angle"]
    lag = T_P * np.tanh(MU * WRAP) / (K * R)
    sliding = (log.index > 1.5) & (log.index < 3.0)
    assert error[sliding].mean() == pytest.approx(
        lag, rel=5e-3
    )  # it rings about it: sliding dry friction damps nothing
    back = (log.index > 6.0) & (log.index < 7.0)
    assert error[back].mean() == pytest.approx(-lag, rel=5e-3)
    stuck = run["joint_angle"][(log.index > 4.05) & (log.index < 4.3)]
    assert np.ptp(stuck) == 0.0
    assert run.num_events > 2


def test_derivatives_of_a_joint_that_sticks_are_those_of_differences() -> None:
    """At rest a contact slides in no direction, and its coefficient differs by none: no derivative may be 0/0 there."""
    effects = (*DRY, "contact:asymmetry", "contact:presliding", "joint:coulomb")
    more = {"contact_coefficient_asymmetry": 0.07, "bristle_stiffness": 1e5, "bristle_damping": 100.0}
    names = ["joint_coulomb", "friction_coefficient", "contact_coefficient_asymmetry", "cable_stiffness"]
    system = System(
        kind="ccsrm",
        parameters={**OWN, **more, "friction_coefficient": MU, "smallest_level": 1e-3, "joint_coulomb": 0.05},
        effects=effects,
    )
    time = np.linspace(0.0, 2.0, 401)
    angle = 0.075 * (1 - np.cos(np.pi * time))
    exact = run(system, time, {"driver_angle": angle}, by=names, tolerance=1e-10)
    assert exact.events >= 2
    for name in names:
        step = 1e-4 * system.parameters[name]
        wanted = differences(system, name, time, {"driver_angle": angle}, step=step, tolerance=1e-12)
        for got, slope in zip(exact.gradient[name], wanted, strict=True):
            assert relative(got, slope) < 1e-4, name


def test_without_friction_all_sections_of_a_cable_pull_alike() -> None:
    run = System(kind="ccsrm", parameters=OWN).simulate(driven(), tolerance=1e-8)
    for cable in "12":
        for section in "13":
            np.testing.assert_array_equal(run[f"tension_{cable}{section}"], run[f"tension_{cable}2"])
    np.testing.assert_allclose(run["tension_12"] + run["tension_22"], 2 * T_P, rtol=1e-12)


def test_a_cable_does_not_push() -> None:
    """Joint 1 far too heavy to follow: the error grows past T_p / (k r), and cable 1 hangs slack."""
    log = driven(amplitude=0.3, period=4.0)
    run = dry(inertia=1e3).simulate(log, tolerance=1e-7)
    error = log["driver_angle"] - run["joint_angle"]
    slack = error > T_P / (K * R)
    assert slack.any()
    assert np.all(run["tension_12"][slack] == 0.0)
    assert np.all(run["tension_11"] >= 0.0)


def test_elastic_ends_soften_a_joint_without_friction() -> None:
    """Three sections in series: the tension of the middle follows k k_e / (k_e + 2 k), once joint 1 is held."""
    ends = 2e5
    system = System(
        kind="ccsrm", parameters={**OWN, "inertia": 1e4, "contact_viscous": 5.0}, effects=("contact:viscous",)
    )
    log = driven(amplitude=0.02)
    run = system.with_effects({"ends:compliance": {"compliance": 1 / ends}}).simulate(log, tolerance=1e-8)
    series = 1 / (1 / K + 2 / ends)
    expected = T_P + series * R * (log["driver_angle"] - run["joint_angle"])
    np.testing.assert_allclose(run["tension_22"], expected, atol=1e-2)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_slip_on_elastic_ends_dies_out_beside_a_joint_that_sticks(tolerance: float) -> None:
    """At standstill slips pass zero more slowly than a guard resolves: no reason to creep through the rest."""
    parameters = {**OWN, "cable_stiffness": 3e4, "pretension": 40.0, "inertia": 0.012, "joint_coulomb": 0.045}
    parameters |= {"joint_viscous": 0.023, "friction_coefficient": 0.18, "smallest_level": 1e-3, "contact_viscous": 500}
    parameters |= {"bristle_stiffness": 1.8e6, "bristle_damping": 1.3e3}
    own = ("contact:capstan", "contact:presliding", "contact:viscous", "joint:coulomb", "joint:viscous")
    system = System(kind="ccsrm", parameters=parameters, effects=own)
    time = np.arange(0.0, 4.0, 0.01)
    x = np.clip((time - 0.2) / 0.5, 0.0, 1.0)
    log = pd.DataFrame({"driver_angle": 0.15 * x**3 * (10 - 15 * x + 6 * x**2)}, index=pd.Index(time, name="t"))
    run = system.with_effects({"ends:compliance": {"compliance": 4e-6}}).simulate(log, tolerance=tolerance)
    rest = run["joint_angle"][run["joint_angle"].index > 1.5]
    assert np.ptp(rest) < 1e-6
    assert run.num_events < 100


def test_laws_that_share_a_coefficient_state_it_once() -> None:
    info = System(kind="ccsrm", parameters=OWN).info
    assert [p.name for p in info.parameters].count("friction_coefficient") == 1
    assert info.effect("contact:stribeck").needs == ("contact:capstan",)
    with pytest.raises(ParameterError, match="contact:stribeck shares parameters with contact:capstan"):
        System(
            kind="ccsrm",
            parameters={**OWN, "static_friction_coefficient": 0.18, "stribeck_velocity": 1e-3},
            effects=("contact:stribeck",),
        )
