"""Every number of the check file of S3, against the library's own functions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from s3_checks import CHECKS, given, require

from tendonlab.papers.s3 import (
    BumpShape,
    FrictionParameters,
    Shape,
    Trajectory,
    TransmissionCoefficients,
    capstan_tension,
    mean_squared_error,
    predict,
)
from tendonlab.procedures import MarkerSpline, pretension_from_load_cells

COEFFICIENTS = ("alpha", "beta", "Psi_alpha", "Psi_beta", "K_in", "K_TO", "C_TO", "offset")
SKEW = {"linear_curvature": 1.0, "linear_curvature_mirrored": -1.0}


def coefficients(name: str) -> TransmissionCoefficients:
    of = given(name)
    shape = Shape.skewed(of["theta"], length=of["L"], skew=SKEW.get(name, 0.0))
    return TransmissionCoefficients.of(
        shape, mu=of["mu"], T_s=of["T_s"], r_in=of["r_in"], r_out=of.get("r_out", of["r_in"])
    )


def friction(name: str) -> FrictionParameters:
    mu_d, mu_s, v_s, v_thres, s_v = given(name)["p"]
    return FrictionParameters(mu_d=mu_d, mu_s=mu_s, v_s=v_s, v_thres=v_thres, s_v=s_v)


def test_there_are_28() -> None:
    assert len(CHECKS) == 28


def test_pretension_from_readings() -> None:
    of = given("ts_from_loadcells")
    require("ts_from_loadcells", "T_s_N", pretension_from_load_cells(of["load_in_kg"], of["load_out_kg"], g=of["g"]))
    readings = np.array(given("ts_fig5b")["load_kg"])
    require("ts_fig5b", "T_s_N", pretension_from_load_cells(readings, readings))


def test_stribeck_coefficient() -> None:
    of = given("stribeck_mu")
    p = FrictionParameters(mu_d=of["mu_d"], mu_s=of["mu_s"], v_s=of["v_s"], v_thres=0.884, s_v=1283.334)
    v = np.array(of["v"])
    shape = Shape.even(3.6, length=0.8)
    require("stribeck_mu", "mu", predict(np.zeros(len(v)), v, shape=shape, T_s=264.77955, p=p, dt=1e-3).mu)


@pytest.mark.parametrize("name", ["v_hys_fitted", "v_hys_soft"])
def test_gate(name: str) -> None:
    of = given(name)
    p = FrictionParameters(mu_d=0.056, mu_s=0.062, v_s=0.546, v_thres=of["v_thres"], s_v=of["s_v"])
    v = np.array(of["v"])
    require(name, "v_hys", predict(np.zeros(len(v)), v, shape=Shape.even(3.6, length=0.8), T_s=1.0, p=p, dt=1e-3).gate)


@pytest.mark.parametrize("name", ["const_curv_coeffs", *SKEW])
def test_coefficients(name: str) -> None:
    found = coefficients(name)
    for key in COEFFICIENTS:
        if key in CHECKS[name]["expected"]:
            require(name, key, getattr(found, key))


@pytest.mark.parametrize("name", ["mu_limit_0", "mu_limit_1e-12", "mu_limit_1e-06"])
def test_no_friction_is_no_cancellation(name: str) -> None:
    found = coefficients(name)
    for key in CHECKS[name]["expected"]:
        require(name, key, getattr(found, key))


def test_tensions() -> None:
    name = "const_curv_tensions"
    found, torque = coefficients(name), given(name)["tau_in"]
    for key, tension in zip(("T1", "T2", "T3", "T4"), found.tensions(torque), strict=True):
        require(name, key, tension)
    require(name, "tau_out", found.output_torque(torque))


def test_elongations_balance() -> None:
    found, of = coefficients("elongation"), given("elongation")
    upper, lower = found.elongations(of["tau_in"], EA=of["EA"])
    require("elongation", "dL_upper", upper)
    require("elongation", "dL_lower", lower)
    assert upper + lower == pytest.approx(0.0, abs=1e-18)


def test_branches_of_the_loop() -> None:
    found, torque = coefficients("loop_branches"), np.array(given("loop_branches")["tau_in"])
    require("loop_branches", "tau_out_v_pos", found.output_torque(torque))
    require("loop_branches", "tau_out_v_neg", found.output_torque(torque, direction=-1))


def test_reversal_keeps_the_gain_and_turns_the_offset() -> None:
    """Solved backwards (alpha and beta, Psi_alpha and Psi_beta exchanged, C_TO kept), not only by the sign."""
    found, torque = coefficients("reversal_swap"), given("reversal_swap")["tau_in"]
    require("reversal_swap", "tau_out", found.output_torque(torque, direction=-1))
    one, two, three, four = found.tensions(torque, direction=-1)
    require("reversal_swap", "tau_out", 0.05 * (two - four))
    assert 0.05 * (one - three) == pytest.approx(torque, rel=1e-12)


def test_radius_ratio() -> None:
    found = coefficients("radius_ratio")
    require("radius_ratio", "K_in", found.K_in)
    require("radius_ratio", "tau_out", found.output_torque(given("radius_ratio")["tau_in"]))


def test_capstan() -> None:
    of = given("capstan_lambda")
    found = [capstan_tension(of["T_in"], of["mu"], of["theta"], direction=sign) for sign in of["lam"]]
    require("capstan_lambda", "T_out", found)
    assert capstan_tension(50.0, 0.1, 2.0) == pytest.approx(50.0 * np.exp(-0.2))  # what the sheath pulls, unless told


def test_slack_limit() -> None:
    of = given("slack_limit")
    law = TransmissionCoefficients.of(
        Shape.even(3.6, length=0.8), mu=0.056, T_s=of["T_s"], r_in=of["r_in"], r_out=of["r_in"]
    )
    require("slack_limit", "tau_slack", law.slack_torque)
    assert law.tensions(law.slack_torque)[2] == pytest.approx(0.0, abs=1e-9)


def test_quarter_circle_of_markers() -> None:
    of = given("quarter_circle_markers")
    spline = MarkerSpline(np.array(of["markers_m"]), num_samples=of["N"])
    for rule, end in (("left", "left"), ("trapezoid", "trap")):
        require("quarter_circle_markers", f"L_{end}", spline.arc_length(rule=rule)[-1])
        require("quarter_circle_markers", f"theta_{end}", spline.wrap_angle(rule=rule))
    require("quarter_circle_markers", "kappa_mid", spline.curvature()[of["N"] // 2])


def test_helix_of_markers() -> None:
    t = np.linspace(0.0, 2.0 * np.pi, 13)
    spline = MarkerSpline(np.column_stack([0.1 * np.cos(t), 0.1 * np.sin(t), 0.05 * t]))
    require("helix_markers_3d", "L_trap", spline.arc_length()[-1])
    require("helix_markers_3d", "theta_trap", spline.wrap_angle())


def test_one_bump() -> None:
    of = given("bump_shape_d6")
    bump = BumpShape.with_end_distance(of["d"], length=of["L"])
    spline = MarkerSpline(bump.markers(of["n_markers"]), num_samples=of["N"])
    require("bump_shape_d6", "phi", bump.phi)
    require("bump_shape_d6", "theta_exact", bump.wrap_angle)
    require("bump_shape_d6", "theta_spline_trap", spline.wrap_angle())
    require("bump_shape_d6", "L_spline_trap", spline.arc_length()[-1])


def test_all_bumps() -> None:
    of = given("bump_theta_all")
    angles = [BumpShape.with_end_distance(d, length=of["L"]).wrap_angle for d in of["d"]]
    require("bump_theta_all", "theta", angles)


@pytest.mark.parametrize("name", ["memory_law", "memory_law_soft"])
def test_memory_law(name: str) -> None:
    of = given(name)
    found = predict(
        np.array(of["tau_in"]), np.array(of["v"]), shape=Shape.even(of["theta"], length=of["L"]), T_s=of["T_s"],
        p=friction(name), dt=1e-3, y0=of["y0"],
    )  # fmt: skip
    require(name, "tau_out", found.tau_out)


def test_superposed_torque() -> None:
    of = given("f_sup")
    require("f_sup", "tau_in", Trajectory("superposed", of["A"], of["T_p"]).torque(np.array(of["t"])))
    peak = Trajectory("superposed", given("f_sup_peak")["A"], given("f_sup_peak")["T_p"])
    require("f_sup_peak", "max", peak.torque(np.linspace(0.0, 10.0, 100001)).max())
    require("f_sup_peak", "at_T2_over_4", peak.torque(2.5))


def test_frequencies() -> None:
    found = [Trajectory("sine", 1.0, period).frequency for period in given("frequencies")["periods_s"]]
    require("frequencies", "f_Hz", found)


def test_objective() -> None:
    of = given("mse")
    require("mse", "mse", mean_squared_error(np.array(of["y"]), np.array(of["yhat"])))


def test_every_check_is_used() -> None:
    text = Path(__file__).read_text(encoding="utf-8")
    assert [name for name in CHECKS if f'"{name}"' not in text] == []
