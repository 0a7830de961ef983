"""The system `cable_joint` against the twin, against its bond graph, and in limits that are known."""

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

import tendonlab as tl
from integrate.rig import differences, relative, run
from tendonlab.data import Experiment
from tendonlab.mechanics.bondgraph import derive
from tendonlab.papers import s2

RIG = s2.constants()
PLAN = s2.reference()
PAIRS = {"joint_angle": "theta", "joint_velocity": "theta_rate", "cable_force_1": "F_act_1", "cable_force_2": "F_act_2"}


def still(angle: float, *, duration: float = 1.0) -> Experiment:
    """Nuts that do not move, and a joint that starts at rest at `angle`."""
    time = np.linspace(0.0, duration, 101)
    frame = pd.DataFrame({"actuator_velocity": 0.0, "joint_angle": angle}, index=pd.Index(time, name="t"))
    return Experiment(name="still", data=frame, initial={"joint_angle": angle, "joint_velocity": 0.0})


@pytest.mark.parametrize(
    ("effects", "twin"),
    [
        ({}, {}),
        ({"gear:ripple": {"ripple_sine": 0.1, "ripple_cosine": 0.0}}, {"ripple": 0.1}),
        ({"stiction:hold": {"hold": 1.0}}, {"sense": "hold"}),
        ({"cable:preload_variation": {"preload_variation": 3e-4 * RIG.K}}, {"path_error": 3e-4}),
    ],
)
def test_it_is_the_twin(effects: dict, twin: dict) -> None:
    """The twin's step of 1 ms holds the nut's velocity from its left end: half a step late, 3e-5 rad at 0.06 rad/s."""
    found = s2.system(RIG).with_effects(effects).simulate(s2.nut_input(RIG, PLAN), tolerance=1e-7).outputs
    wanted = s2.simulate(RIG, PLAN, **twin)
    jumps = np.zeros(len(found), dtype=bool)
    for name in ("cable_force_1", "cable_force_2"):  # a jump may fall on the sample beside it
        for at in np.flatnonzero(np.abs(np.diff(wanted[PAIRS[name]])) > 5.0):
            jumps[at - 2 : at + 4] = True
    assert np.count_nonzero(jumps) < 30
    closeness = {"joint_angle": 6e-5, "joint_velocity": 2e-4, "cable_force_1": 0.2, "cable_force_2": 0.2}
    for ours, theirs in PAIRS.items():
        error = np.abs(found[ours].to_numpy() - wanted[theirs].to_numpy())
        assert np.max(error[~jumps]) < closeness[ours], ours


def test_a_toe_makes_the_cables_as_soft_as_the_twins() -> None:
    """A joint that hangs, so that gravity changes sides, preloaded to half of where the toe ends."""
    rig = s2.constants().with_(phi=-np.pi / 2.0, T=100.0)
    toe = {"cable:toe_region": {"toe_tension": 200.0}}
    linear, soft = (
        s2.system(rig).with_effects(effect).simulate(s2.nut_input(rig, PLAN), tolerance=1e-7)["joint_angle"]
        for effect in ({}, toe)
    )
    straight, bent = (s2.simulate(rig, PLAN, toe_tension=tension)["theta"] for tension in (0.0, 200.0))
    wanted = (bent - straight).to_numpy()
    assert np.abs(wanted).max() > 2e-4
    assert (soft - linear).to_numpy() == pytest.approx(wanted, abs=0.01 * np.abs(wanted).max())


def test_nuts_that_rest_keep_the_sense_of_the_bushings() -> None:
    """What is left of the joint's creep is rounding, whose sign turned the force of a bushing by 11 N."""
    time = np.linspace(0.0, 8.0, 4001)
    velocity = np.where(time % 4.0 < 2.0, 4e-3 * np.sin(np.pi * time), 0.0)
    frame = pd.DataFrame({"actuator_velocity": velocity}, index=pd.Index(time, name="t"))
    for tolerance in (1e-5, 1e-6, 1e-8):
        force = s2.system(RIG).simulate(frame, tolerance=tolerance)["cable_force_1"].to_numpy()
        for rest in ((time > 2.2) & (time < 4.0), time > 6.2):
            assert np.abs(np.diff(force[rest])).max() < 0.1


def test_half_the_twins_step_halves_the_difference() -> None:
    """So the difference is the twin's, not ours."""
    errors = []
    for step in (1e-3, 5e-4):
        plan = s2.reference(end=8.0, step=step)
        ours = s2.system(RIG).simulate(s2.nut_input(RIG, plan), tolerance=1e-8)["joint_angle"]
        errors.append(np.sqrt(np.mean((ours - s2.simulate(RIG, plan)["theta"]) ** 2)))
    assert errors[1] == pytest.approx(0.5 * errors[0], rel=0.02)


def test_a_voltage_gives_what_the_bond_graph_gives() -> None:
    """Winding, rotor, gear, cables, bushings and joint of Fig. 2 under an independent stepper."""
    laws = [s2.bushing_law(branches) for branches in RIG.bushings]

    def friction(cable: int) -> s2.graphs.Friction:
        return lambda v, theta: float(laws[cable].force(velocity=np.real(v), wrap_angle=np.real(theta), load=RIG.T))

    graph = derive(s2.graphs.whole_graph(RIG, (friction(0), friction(1))))
    start = float(s2.equations.holding_difference(RIG, 0.0)) / (2.0 * RIG.K)
    state = {"x_1": 0.0, "x_2": 0.0, "x_4_1": start, "x_4_2": -start, "x_5": 0.0, "theta": 0.0}
    time = np.linspace(0.0, 0.04, 41)

    def rates(_: float, x: np.ndarray) -> list[float]:
        found = graph.rates(dict(zip(graph.states, x, strict=True)), {"V": 20.0})
        return [found[name] for name in graph.states]

    sizes = np.array([1e-3, 1e-3, 1e-5, 1e-5, 1e-5, 1e-3])
    wanted = solve_ivp(
        rates, (0.0, time[-1]), [state[name] for name in graph.states], "LSODA", time, rtol=1e-8, atol=1e-8 * sizes
    )
    volts = pd.DataFrame({"voltage": 20.0}, index=pd.Index(time, name="t"))
    found = s2.system(RIG).simulate(volts, tolerance=1e-9).outputs
    motor, joint = wanted.y[1] / RIG.J_m, wanted.y[4] / RIG.J_1
    assert found["motor_velocity"].to_numpy() == pytest.approx(motor, abs=2e-4 * motor.max())
    assert found["joint_velocity"].to_numpy() == pytest.approx(joint, abs=2e-4 * joint.max())
    assert found["joint_angle"].to_numpy() == pytest.approx(wanted.y[5], abs=2e-4 * wanted.y[5].max())


@pytest.mark.parametrize("angle", [-0.5, 0.0, 0.7])
@pytest.mark.parametrize("ripple", [0.0, 0.3])
def test_it_starts_where_the_nuts_hold_it(angle: float, ripple: float) -> None:
    """At rest at any angle, whatever the gear's ripple; the forces differ by what gravity asks for."""
    rig = s2.system(RIG).with_effects({"gear:ripple": {"ripple_sine": ripple, "ripple_cosine": -ripple}})
    found = rig.simulate(still(angle), ports=True)
    assert np.abs(found["joint_angle"] - angle).max() < 1e-9
    assert found.ports is not None
    difference = found.ports[("cable_1", "force")] - found.ports[("cable_2", "force")]
    assert difference.iloc[-1] == pytest.approx(float(s2.equations.holding_difference(RIG, angle)), rel=1e-6)


VARIATION = {"cable:preload_variation": {"preload_variation": 500.0}}


@pytest.mark.parametrize("angle", [-0.5, 0.7])
def test_a_path_that_grows_with_the_angle_pulls_the_joint_back(angle: float) -> None:
    """At rest both cables gain the same path, P/K (1 - cos theta), and their sum pulls against its slope."""
    found = s2.system(RIG).with_effects(VARIATION).simulate(still(angle), ports=True)
    assert np.abs(found["joint_angle"] - angle).max() < 1e-9
    assert found.ports is not None
    one, two = (found.ports[(name, "force")].iloc[-1] for name in ("cable_1", "cable_2"))
    assert one + two == pytest.approx(2.0 * (RIG.T + 500.0 * (1.0 - np.cos(angle))), rel=1e-9)
    back = 500.0 / RIG.K * np.sin(angle) * (one + two)
    torque = RIG.r * np.cos(angle) * (one - two) - back + float(s2.equations.gravity_torque(RIG, angle))
    assert torque == pytest.approx(0.0, abs=1e-6 * abs(back))


def test_what_the_path_takes_from_the_joint_is_in_the_cables() -> None:
    """Cables without damping between nuts at rest and a joint that swings: the energy of all stays."""
    time = np.linspace(0.0, 0.5, 501)
    frame = pd.DataFrame({"actuator_velocity": 0.0, "joint_angle": 0.7}, index=pd.Index(time, name="t"))
    swing = Experiment(name="swing", data=frame, initial={"joint_angle": 0.7, "joint_velocity": 0.2})
    own = {name: value for name, value in s2.parameters(RIG).items() if not name.startswith("bushing")}
    effects = ("motor:viscous", "gear:arctan")
    undamped = tl.System(kind="cable_joint", parameters={**own, "cable_damping": 0.0}, effects=effects)
    found = undamped.with_effects(VARIATION).simulate(swing, ports=True, tolerance=1e-10)
    assert found.ports is not None
    pulls = found.ports[[("cable_1", "force"), ("cable_2", "force")]].to_numpy()
    joint = s2.equations.joint_energy(RIG, found["joint_angle"].to_numpy(), found["joint_velocity"].to_numpy())
    energy = joint + np.sum(pulls**2, axis=1) / (2.0 * RIG.K)
    assert np.ptp(joint) > 1e-3
    assert np.ptp(energy) < 1e-7


def test_no_torque_moves_a_joint_that_lies_flat() -> None:
    """Without gravity both cables carry the preload."""
    found = s2.system(RIG.with_(g=0.0)).simulate(still(0.4), ports=True)
    assert found.ports is not None
    assert found.ports[[("cable_1", "force"), ("cable_2", "force")]].to_numpy() == pytest.approx(RIG.T, rel=1e-9)


def test_a_cable_never_pushes() -> None:
    """A preload of 5 N against a holding force of 22.7 N: cable 2 goes slack, and cable 1 holds alone."""
    time = np.linspace(0.0, 2.0, 201)
    frame = pd.DataFrame({"actuator_velocity": 0.0}, index=pd.Index(time, name="t"))
    found = s2.system(RIG.with_(T=5.0)).simulate(frame, ports=True)
    assert found.ports is not None
    slack, holding = (found.ports[(name, "force")].to_numpy() for name in ("cable_2", "cable_1"))
    assert np.all(slack >= 0.0)
    assert slack[-1] == 0.0
    assert holding[-1] == pytest.approx(
        float(s2.equations.holding_difference(RIG, found["joint_angle"].iloc[-1])), rel=1e-4
    )


def test_bushings_brake_the_motor_and_leave_the_joint_alone() -> None:
    plain = {"effects": ("motor:viscous", "gear:arctan")}
    own = {name: value for name, value in s2.parameters(RIG).items() if not name.startswith("bushing")}
    free = tl.System(kind="cable_joint", parameters=own, **plain)
    moved = s2.nut_input(RIG, s2.reference(end=8.0))
    one, two = (rig.simulate(moved).outputs for rig in (s2.system(RIG), free))
    assert one["joint_angle"].to_numpy() == pytest.approx(two["joint_angle"].to_numpy(), abs=1e-12)
    assert (one["cable_force_1"] - two["cable_force_1"]).abs().max() > 40.0
    volts = pd.DataFrame({"voltage": 20.0}, index=pd.Index(np.linspace(0.0, 0.5, 101), name="t"))
    braked, easy = (rig.simulate(volts)["motor_velocity"].iloc[-1] for rig in (s2.system(RIG), free))
    difference = sum(s * s2.equations.bushing_force(RIG.bushings[i], 0.0, 1.0, RIG.T) for i, s in ((0, 1.0), (1, -1.0)))
    slope = RIG.c_m + RIG.k_m**2 / RIG.R_m + RIG.alpha * RIG.beta / (1.0 + (RIG.beta * braked) ** 2)
    assert easy - braked == pytest.approx(RIG.N * float(difference) / slope, rel=0.05)


def test_ripple_is_what_its_equation_says() -> None:
    """u' = v (1 + s sin(2 pi u/p) + c cos(2 pi u/p)), integrated independently over six turns of the screw."""
    sine, cosine, turn = 0.2, -0.3, 2.0 * np.pi

    def rate(_: float, phi: np.ndarray) -> np.ndarray:
        return 1.0 + sine * np.sin(phi) + cosine * np.cos(phi)

    angle = np.linspace(0.0, 6.0 * turn, 50)
    wanted = solve_ivp(rate, (0.0, angle[-1]), [0.0], "DOP853", angle, rtol=1e-12, atol=1e-12).y[0]
    law = tl.transmission.Ripple(ripple_sine=sine, ripple_cosine=cosine)
    assert law.stretch(position=angle) == pytest.approx(wanted, abs=1e-9)


BY = (
    "motor_viscous",
    "gear_friction",
    "gear_friction_slope",
    "torque_constant",
    "motor_resistance",
    "motor_inductance",
)
BY += (
    "cable_stiffness",
    "cable_damping",
    "pretension",
    "link_2_mass",
    "anchor_distance",
    "mounting_angle",
    "bushing_1_a1",
)


@pytest.mark.parametrize("name", BY)
def test_derivatives_of_a_step_of_voltage(name: str) -> None:
    """By the system's own parameters, with the geometry moving and the bushings as identified; nothing turns back."""
    time = np.linspace(0.0, 0.3, 61)
    volts = {"voltage": 20.0 + 5.0 * np.sin(20.0 * time)}
    system = s2.system(s2.constants(viscous_reading="C"))
    got = run(system, time, volts, by=[name], tolerance=1e-10).gradient[name]
    step = 1e-5 * (abs(system.parameters[name]) or 1.0)
    wanted = differences(system, name, time, volts, step=step, tolerance=1e-11)
    for ours, theirs, output in zip(got, wanted, run(system, time, volts, tolerance=1e-10).table, strict=True):
        noise = 1e-9 * np.sqrt(np.mean(output**2)) / step
        assert relative(ours, theirs) < 1e-4 or np.max(np.abs(ours - theirs)) < noise
