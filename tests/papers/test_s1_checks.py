"""All numbers of the golden file of S1: input to output of the device, computed by a separate script."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tendonlab.mechanics.tendons import Reducer, TendonTransmission, back_driven_efficiency
from tendonlab.papers.s1 import (
    BallBearing,
    decompose,
    example_device,
    identify_joint,
    plan_identification,
    residual_error,
    true_motor_friction,
)
from tendonlab.papers.s1.bearing import RPM
from tendonlab.papers.s1.experiments import compensated

GOLDEN = json.loads((Path(__file__).parents[1] / "golden" / "papers" / "S1.json").read_text(encoding="utf-8"))
CHECKS = {check["name"]: check for check in GOLDEN["checks"]}


def named(*prefixes: str) -> list[str]:
    return [name for name in CHECKS if name.startswith(prefixes)]


def close(found: Any, check: dict[str, Any], key: str, *, atol: float = 0.0) -> None:
    np.testing.assert_allclose(found, check["output"][key], rtol=check["rtol"], atol=atol)


def ragged(rows: np.ndarray, widest: int) -> list[list[float]]:
    """The entries of a triangle that there are: row i has i + `widest`."""
    return [row[: i + widest].tolist() for i, row in enumerate(rows)]


def device_of(name: str) -> TendonTransmission:
    return example_device(reducers=name.split(".")[3:4] == ["reducer"])


def test_every_check_is_computed_here() -> None:
    here = named("kin.", "static.", "ident.", "decompose.", "reducer.", "bearing.", "free_motion.")
    assert len(here) == len(CHECKS) == 39


def test_the_device_is_that_of_the_checks() -> None:
    device, given = example_device(), GOLDEN["device"]
    np.testing.assert_array_equal(device.radius, given["R"])
    np.testing.assert_array_equal(device.motor_radius, given["r_m"])
    for name, key in (("constant", "tau0"), ("tension", "beta"), ("viscous", "nu")):
        np.testing.assert_array_equal(getattr(device.losses, name), given[key])
    assert [r.efficiency if r else 1.0 for r in device.reducers] == given["eta_d"]
    assert [r.ratio if r else 1.0 for r in device.reducers] == given["kappa"]
    np.testing.assert_allclose(np.diag(device.radius), np.multiply(given["r_pulley"], given["kappa"]), rtol=1e-15)


def test_kinematics() -> None:
    of = example_device().kinematics
    check = CHECKS["kin.joint_to_motor"]
    close(of.joint_to_motor(check["input"]["q"]), check, "q_m")
    check = CHECKS["kin.motor_to_joint"]
    close(of.motor_to_joint(check["input"]["q_m"]), check, "q")
    check = CHECKS["kin.branches"]
    for found, wanted in zip(ragged(of.branches(check["input"]["q"]), 1), check["output"]["S"], strict=True):
        np.testing.assert_allclose(found, wanted, rtol=check["rtol"])


def test_coupling_matrix() -> None:
    close(example_device().coupling, CHECKS["static.K"], "K")


@pytest.mark.parametrize("name", named("static.inverse"))
def test_inverse_statics(name: str) -> None:
    check, device = CHECKS[name], device_of(name)
    given = check["input"]
    found = device.statics.inverse(
        given["C_E"], given["qdot"], model=name.split(".")[2], sign_velocity=given["v_s"]
    )  # fmt: skip
    close(found.torque, check, "C_m")
    if "power_lost" in check["output"]:
        motor = device.kinematics.joint_to_motor(given["qdot"])
        close(found.torque @ motor - np.dot(given["C_E"], given["qdot"]), check, "power_lost", atol=1e-12)
    parts = {"tau": (found.tension, 2), "dtau": (found.loss, 1), "Sdot": (found.branch_velocity, 1)}
    for key, (triangle, widest) in parts.items():
        if key in check["output"]:
            for row, wanted in zip(ragged(triangle, widest), check["output"][key], strict=True):
                np.testing.assert_allclose(row, wanted, rtol=check["rtol"])
    if "C_own" in check["output"]:
        close(found.own, check, "C_own")


def test_direct_statics() -> None:
    check = CHECKS["static.direct.full.reducer"]
    found = example_device().statics.direct(check["input"]["C_m"], check["input"]["qdot"])
    close(found.torque, check, "C_joint")
    for row, wanted in zip(ragged(found.tension, 2), check["output"]["tau"], strict=True):
        np.testing.assert_allclose(row, wanted, rtol=check["rtol"])


@pytest.mark.parametrize("name", named("ident."))
def test_identification(name: str) -> None:
    check, device = CHECKS[name], example_device(reducers=False)
    strategy, joint = name.split(".")[1], check["input"]["motor"]
    found = identify_joint(device, joint, strategy=strategy, speeds=check["input"]["speeds"])
    close(found.constant, check, "C_m0")
    close(found.viscous, check, "nu")
    constant, viscous = true_motor_friction(device, joint)
    close(constant, check, "true_C_m0")
    close(viscous, check, "true_nu")
    plan = plan_identification(device, joint, strategy=strategy, speeds=(6.0, -6.0))
    close(plan.joint_velocity[0], check, "qdot_at_6")
    forms = {"residual_exact_at_6": "exact", "residual_first_order_at_6": "first_order",
             "residual_as_printed_at_6": "printed"}  # fmt: skip
    for key, form in forms.items():
        error = residual_error(device, joint, strategy=strategy, speed=6.0, form=form)
        close(error, check, key, atol=1e-16)  # rounding of a motor torque of 0.1 N·m where the residual is 0


def test_decomposition() -> None:
    check = CHECKS["decompose.transmission4"]
    given = check["input"]
    found = decompose(
        given["C_m0"], given["nu"], given["k"], shares_static=given["shares"], shares_viscous=given["shares"]
    )
    close(found.w_viscous, check, "gamma")
    close(found.w_static, check, "alpha")
    close(found.viscous, check, "nu_j")
    close(found.constant, check, "tau0_j")


@pytest.mark.parametrize("name", named("reducer.eta_i"))
def test_back_driven_efficiency(name: str) -> None:
    check = CHECKS[name]
    close(back_driven_efficiency(check["input"]["eta_d"]), check, "eta_i", atol=1e-15)


@pytest.mark.parametrize("name", ["reducer.drive", "reducer.back"])
def test_reducer(name: str) -> None:
    check = CHECKS[name]
    given = check["input"]
    of = Reducer(efficiency=given["eta_d"], ratio=given["kappa"])
    close(of.output_torque(given["M_in"], given["n_out"]), check, "M_out")
    np.testing.assert_allclose(of.input_torque(check["output"]["M_out"], given["n_out"]), given["M_in"], rtol=1e-12)


@pytest.mark.parametrize("name", named("bearing."))
def test_bearing(name: str) -> None:
    check = CHECKS[name]
    given = check["input"]
    of = BallBearing(f0=given["f0"], viscosity=given["nu_oil_mm2_s"], mean_diameter=given["d_m_mm"])
    close(1e3 * of.speed_torque(given["n_rpm"] * RPM), check, "h_Nmm")
    close(of.transition_speed / RPM, check, "n0_rpm")


def test_free_motion() -> None:
    check, found = CHECKS["free_motion.fig7_twin"], compensated(0.75).table
    for key, column in (("rms_off", "without"), ("rms_on", "compensated"), ("reduction", "reduction")):
        close(found[column], check, key)
