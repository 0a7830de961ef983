"""Every number of the check values of S2, by the twin's equations and by the library's laws, system and graphs."""

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from papers.s2_golden import CHECKS, named
from tendonlab.data import Experiment
from tendonlab.mechanics.bondgraph import derive
from tendonlab.papers import s2

RIG = s2.constants()
equations = s2.equations


def of(name: str) -> tuple[dict, dict, float]:
    check = CHECKS[name]
    return check["input"], check["output"], check["rtol"]


def test_every_check_has_a_test() -> None:
    prefixes = ("transmission.", "gear_friction.", "joint.inertia_gravity.", "joint.x5dot.", "joint.positions.")
    prefixes += ("actuator.", "cable.", "bushing.sine.", "bushing.eq11.", "time_constants", "joint.free_swing")
    prefixes += ("twin.implicit_step", "twin.ripple")
    assert sorted(name for prefix in prefixes for name in named(prefix)) == sorted(CHECKS)


def test_transmission() -> None:
    _, out, rtol = of("transmission.NgNs")
    assert pytest.approx(out["value"], rel=rtol) == RIG.N


@pytest.mark.parametrize("name", named("gear_friction."))
def test_gear_friction(name: str) -> None:
    given, out, rtol = of(name)
    law = tl.friction.Arctan(friction=given["alpha"], friction_slope=given["beta"])
    for found in (law.force(velocity=given["omega"]), equations.gear_torque(RIG, given["omega"])):
        assert found == pytest.approx(out["tau_f"], rel=rtol)


@pytest.mark.parametrize("name", named("joint.inertia_gravity."))
def test_inertia_and_gravity(name: str) -> None:
    given, out, rtol = of(name)
    rig = RIG.with_(g=given["g"])
    assert equations.inertia(rig, given["theta"]) == pytest.approx(out["I"], rel=rtol)
    assert equations.gravity_torque(rig, given["theta"]) == pytest.approx(out["tau_g"], rel=rtol)
    assert equations.potential(rig, given["theta"]) == pytest.approx(out["V"], rel=rtol)


@pytest.mark.parametrize("name", named("joint.x5dot."))
def test_joint_rate(name: str) -> None:
    given, out, rtol = of(name)
    rig, theta, x_5, pull = RIG.with_(g=given["g"]), given["theta"], given["x5"], given["dF_r"]
    found = equations.joint_rate(rig, theta, x_5, pull)
    assert found == pytest.approx(out["x5_dot"], rel=rtol)
    assert found / rig.J_1 == pytest.approx(out["theta_ddot"], rel=rtol)
    printed = equations.joint_rate(rig, theta, x_5, pull, coriolis="printed")
    assert printed == pytest.approx(out["x5_dot_as_printed"], rel=rtol)
    graph = derive(s2.graphs.joint_graph(rig)).rates({"x_5": x_5, "theta": theta}, {"F_r_1": pull, "F_r_2": 0.0})
    assert graph["x_5"] == pytest.approx(out["x5_dot"], rel=rtol)


def test_positions() -> None:
    given, out, rtol = of("joint.positions.0.4")
    found = equations.positions(RIG, given["theta"])
    for name, place in out.items():
        assert found[name] == pytest.approx(place, rel=rtol)


def test_actuator() -> None:
    given, out, rtol = of("actuator.rhs")
    rig = RIG.with_(c_m=given["c_m"], alpha=given["alpha"], beta=given["beta"])
    state = {"x_1": given["x1"], "x_2": given["x2"]}
    forces = {"F_act_1": given["F_act1_minus_F_act2"], "F_act_2": 0.0}
    graph = derive(s2.graphs.motor_graph(rig)).rates(state, {"V": given["V"], **forces})
    assert given["x1"] / rig.L_m == pytest.approx(out["i"], rel=rtol)
    assert given["x2"] / rig.J_m == pytest.approx(out["omega"], rel=rtol)
    assert equations.winding_rate(rig, given["x1"], given["x2"], given["V"]) == pytest.approx(out["x1_dot"], rel=rtol)
    assert equations.motor_rate(rig, given["x1"], given["x2"], given["F_act1_minus_F_act2"]) == pytest.approx(
        out["x2_dot"], rel=rtol
    )
    assert (graph["x_1"], graph["x_2"]) == pytest.approx((out["x1_dot"], out["x2_dot"]), rel=rtol)
    winding = tl.actuation.Winding(torque_constant=rig.k_m, resistance=rig.R_m, inductance=rig.L_m)
    assert winding.torque_constant * out["i"] == pytest.approx(0.1024, rel=1e-12)


@pytest.mark.parametrize("name", named("cable."))
def test_cable(name: str) -> None:
    given, out, rtol = of(name)
    rig = RIG.with_(T=given["T"])
    law = tl.transmission.TautCompliance(pretension=rig.T, stiffness=rig.K, damping=rig.c)
    for found in (
        equations.cable_force(rig, given["x4"], given["x4_dot"]),
        law.force(position=given["x4"], velocity=given["x4_dot"]),
    ):
        assert found == pytest.approx(out["F_r"], rel=rtol)


@pytest.mark.parametrize("name", named("bushing.sine."))
def test_bushing_by_the_bisector_and_by_the_capstan(name: str) -> None:
    given, out, rtol = of(name)
    seen = {"velocity": given["v"], "wrap_angle": given["theta"], "load": given["T"]}
    assert equations.bushing_reaction(given["T"], given["theta"]) == pytest.approx(out["R"], rel=rtol)
    assert np.linalg.norm(equations.bushing_reaction(given["T"], given["theta"])) == pytest.approx(out["N"], rel=rtol)
    sine = tl.friction.BushingSine(sine_coefficient=given["mu"])
    capstan = tl.friction.BushingCapstan(capstan_coefficient=given["mu"])
    assert sine.force(**seen) == pytest.approx(out["F_a"], rel=rtol)
    assert capstan.force(**seen) == pytest.approx(out["F_a_capstan"], rel=rtol)


@pytest.mark.parametrize("name", named("bushing.eq11."))
def test_bushing_branches(name: str) -> None:
    given, out, rtol = of(name)
    law = s2.bushing_law(given["params"])
    for way, key in ((1.0, "v_positive"), (-1.0, "v_negative")):
        found = law.force(velocity=way, wrap_angle=given["theta"], load=given["T"])
        assert found == pytest.approx(out[key], rel=rtol)
        twin = equations.bushing_force(given["params"], given["theta"], way, given["T"])
        assert twin == pytest.approx(out[key], rel=rtol)
    parts = s2.split_common_friction(given["params"], given["theta"], given["T"])
    assert (parts["common"], parts["friction"]) == pytest.approx((out["common"], out["friction"]), rel=rtol)


def test_time_constants() -> None:
    _, out, rtol = of("time_constants")
    assert RIG.time_constants() == pytest.approx(out, rel=rtol)


def free_joint() -> tl.System:
    """The library's joint without cables, bushings and motor friction."""
    gone = ("bushing", "motor_viscous", "gear_friction")
    own = {name: value for name, value in s2.parameters(RIG).items() if not name.startswith(gone)}
    return tl.System(
        kind="cable_joint", parameters={**own, "cable_stiffness": 0.0, "cable_damping": 0.0, "pretension": 0.0}
    )


def test_free_swing() -> None:
    """By Dormand-Prince, and by the library's stepper at a tolerance of 1e-9; energy is conserved within 1e-8 J."""
    given, out, rtol = of("joint.free_swing_1s")
    wanted = (out["theta"], out["theta_dot"])
    alone = s2.free_swing(RIG, theta=given["theta0"], theta_rate=given["theta_dot0"], duration=given["t"])
    assert alone.iloc[-1][["theta", "theta_rate"]].tolist() == pytest.approx(wanted, rel=rtol)
    time = np.linspace(0.0, 3.0, 601)
    frame = pd.DataFrame({"actuator_velocity": 0.0}, index=pd.Index(time, name="t"))
    start = {"joint_angle": given["theta0"], "joint_velocity": given["theta_dot0"]}
    frame["joint_angle"] = given["theta0"]
    run = free_joint().simulate(Experiment(name="swing", data=frame, initial=start), tolerance=1e-9).outputs
    assert run.iloc[200][["joint_angle", "joint_velocity"]].tolist() == pytest.approx(wanted, rel=rtol)
    energy = equations.joint_energy(RIG, run["joint_angle"].to_numpy(), run["joint_velocity"].to_numpy())
    assert np.max(np.abs(energy - energy[0])) < 1e-8


def test_implicit_step() -> None:
    given, out, rtol = of("twin.implicit_step")
    plan = s2.reference(step=given["h"])
    run = s2.simulate(RIG, plan)
    at = [round(t / given["h"]) for t in given["t"]]
    for name, column in (("theta", "theta"), ("theta_dot", "theta_rate"), ("e", "elongation")):
        assert run[column].to_numpy()[at] == pytest.approx(out[name], rel=rtol)
    assert plan.angle[at] == pytest.approx(out["theta_ref"], rel=rtol)


def test_ripple() -> None:
    given, out, rtol = of("twin.ripple")
    assert pytest.approx(given["period_m"]) == RIG.p
    plan = s2.reference(end=given["t_end"])
    run = s2.simulate(RIG, plan, ripple=given["ripple"])
    error = (run["theta_rate"].to_numpy() - plan.velocity)[plan.cruise()]
    assert np.std(error) / 0.06 == pytest.approx(out["rel_std_cruise"], rel=rtol)
