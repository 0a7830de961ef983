"""Analytic limits of the systems: what pen and paper give."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrate.rig import FRICTION, INERTIAS, NOMINAL, joint, pair, run

TIGHT = 1e-10


def test_terminal_velocity():
    """J v' = u - F_c - b v: v -> (u - F_c) / b with time constant J / b."""
    t = np.linspace(0.0, 10.0, 201)
    done = run(joint(("joint:coulomb", "joint:viscous"), coulomb=1.0, viscous=0.5), t, 1.6, tolerance=TIGHT)
    assert done["joint_velocity"] == pytest.approx(1.2 * (1.0 - np.exp(-0.5 * t)), abs=1e-9)


def test_pendulum_swings_with_its_energy():
    """J q'' = -g sin q: J v^2 / 2 - g cos q stays, over fifty swings."""
    t = np.linspace(0.0, 100.0, 2001)
    done = run(joint(gravity_torque=10.0), t, position=[2.0], tolerance=TIGHT)
    energy = 0.5 * done["joint_velocity"] ** 2 - 10.0 * np.cos(done["joint_angle"])
    assert energy == pytest.approx(-10.0 * np.cos(2.0), abs=10.0 * 1e-6)  # 1e-10 a step, a few thousand steps


def test_torque_constant_scales_the_command():
    t = np.linspace(0.0, 1.0, 11)
    done = run(joint().with_parameters({"torque_constant": -3.0}), t, 0.5)
    assert done["joint_velocity"] == pytest.approx(-1.5 * t, rel=1e-12, abs=1e-14)


def elastic(damping):
    """Frequency, 1/s, and decay, 1/s, of the pair's oscillation: stiffness over the reduced inertia of the stretch."""
    p = INERTIAS
    inverse = 1.0 / (p["motor_inertia"] * p["gear_ratio"] ** 2) + 1.0 / p["joint_inertia"]
    decay = 0.5 * damping * inverse
    return np.sqrt(p["cable_stiffness"] * inverse - decay**2), decay


@pytest.mark.parametrize("damping", [0.0, 0.05, 0.3])
def test_free_oscillation_of_the_pair(damping):
    """The stretch rings with e^{-a t} cos: from a stretch at rest."""
    t = np.linspace(0.0, 1.0, 501)
    frequency, decay = elastic(damping)
    done = run(pair(cable_damping=damping), t, position=[0.1, 0.0], tolerance=TIGHT)
    stretch = done["motor_angle"] / 10.0 - done["joint_angle"]
    expected = 0.01 * np.exp(-decay * t) * (np.cos(frequency * t) + decay / frequency * np.sin(frequency * t))
    assert stretch == pytest.approx(expected, abs=0.01 * 1e-5)


def test_energy_and_momentum_of_the_pair_without_friction():
    """Two hundred oscillations keep the energy; without a command J_m q_m' + J_l q_l' / N stays as well."""
    frequency, _ = elastic(0.0)
    t = np.linspace(0.0, 200 * 2 * np.pi / frequency, 4001)
    done = run(pair(cable_damping=0.0), t, position=[0.1, 0.0], velocity=[3.0, 0.2], ports=True, tolerance=TIGHT)
    wm, wl = done.ports["motor"][0], done.ports["joint"][0]
    energy = 0.5 * 1.2e-4 * wm**2 + 0.5 * 0.02 * wl**2 + 0.5 * done["cable_torque"] ** 2 / 50.0
    assert energy == pytest.approx(np.full_like(t, energy[0]), rel=1e-5)
    momentum = 1.2e-4 * wm + 0.02 * wl / 10.0
    assert momentum == pytest.approx(np.full_like(t, momentum[0]), rel=1e-9)


def test_friction_takes_the_energy_that_is_lost():
    """Energy of the pair plus the work of all frictions is what it was: by the trapezoid over fine samples."""
    t = np.linspace(0.0, 0.5, 50001)
    done = run(pair(NOMINAL, **FRICTION), t, position=[0.3, 0.0], velocity=[8.0, 0.5], ports=True, tolerance=TIGHT)
    wm, wl = done.ports["motor"][0], done.ports["joint"][0]
    stretch = done["motor_angle"] / 10.0 - done["joint_angle"]
    energy = 0.5 * 1.2e-4 * wm**2 + 0.5 * 0.02 * wl**2 + 0.5 * 50.0 * stretch**2
    power = done.ports["motor"][3] * wm + done.ports["joint"][3] * wl + 0.05 * (wm / 10.0 - wl) ** 2
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(t))])
    assert energy + work == pytest.approx(np.full_like(t, energy[0]), rel=1e-6)
    assert np.all(np.diff(work) >= -1e-15)


def test_steady_bristle_friction_is_that_of_the_dry_laws():
    """At constant speed LuGre is Coulomb + Stribeck + viscous: the command that keeps a speed, at six speeds."""
    t = np.linspace(0.0, 2.0, 21)
    for speed in (-1.0, -0.1, -0.02, 0.02, 0.1, 1.0):
        level = np.sign(speed) * (1.0 + 0.5 * np.exp(-((speed / 0.05) ** 2)))
        system = joint(("joint:coulomb", "joint:viscous", "joint:stribeck", "joint:presliding"), coulomb=1.0,
                       viscous=0.4, joint_static_excess=0.5, joint_stribeck_velocity=0.05, joint_bristle_stiffness=1e4,
                       joint_bristle_damping=10.0).with_parameters({"inertia": 1e6})  # fmt: skip
        done = run(system, t, 0.0, velocity=[speed], ports=True)  # too heavy to slow down: 1e-6 of the speed
        assert done.ports["joint"][3][-1] == pytest.approx(level + 0.4 * speed, rel=1e-4)


def test_presliding_stiffness_is_the_slope_of_force_over_motion():
    """Pushed by 2 % of the level: friction over displacement is sigma_0, within the 2 % that it has yielded."""
    t = np.linspace(0.0, 1.0, 101)
    system = joint(("joint:coulomb", "joint:viscous", "joint:presliding"), coulomb=1.0, viscous=100.0,
                   joint_bristle_stiffness=500.0, joint_bristle_damping=40.0)  # fmt: skip
    done = run(system, t, 0.02, ports=True)
    _, angle, _, force = done.ports["joint"]
    assert force[-1] / angle[-1] == pytest.approx(500.0, rel=0.02)
    assert force[-1] == pytest.approx(0.02, rel=1e-3)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_motor_crosses_the_gap_before_the_joint_moves(sign):
    """From the middle of the gap the motor turns by half of it times the ratio, on reversal by the whole."""
    t = np.linspace(0.0, 0.2, 2001)
    gap, ratio = 0.02, 10.0
    system = pair(("cable:backlash",), cable_backlash=gap)
    done = run(system, t, sign * 0.01, tolerance=TIGHT)
    moves = np.flatnonzero(done["joint_angle"])[0]
    assert abs(done["motor_angle"][moves - 1]) <= ratio * gap / 2 <= abs(done["motor_angle"][moves])
    arrival = np.sqrt(2.0 * (ratio * gap / 2) * 1.2e-4 / 0.01)
    assert t[moves - 1] <= arrival <= t[moves]
    assert np.all(done["cable_torque"][:moves] == 0.0)


def test_gap_is_crossed_whole_on_reversal():
    """A heavy joint, dragged slowly forth and back: between pulling and pushing the motor turns N times the gap."""
    t = np.linspace(0.0, 2.0, 4001)
    system = pair((*NOMINAL, "cable:backlash"), **FRICTION, cable_backlash=0.02).with_parameters(
        {"joint_coulomb": 0.2, "motor_viscous": 0.02}
    )
    done = run(
        system,
        t,
        0.012 * np.sign(np.sin(np.pi * t) + 1e-12),
        kind="hold",
        position=[0.1, 0.0],
        ports=True,
        tolerance=TIGHT,
    )
    assert np.all(done["joint_angle"] == 0.0)  # never pulled by more than 0.1
    loose = done["cable_torque"] == 0.0
    edges = done["motor_angle"][np.flatnonzero(np.diff(loose.astype(int)))]
    assert edges[-2] - edges[-1] == pytest.approx(10.0 * 0.02, rel=0.05)  # samples 0.5 ms apart


def test_load_dependence_is_friction_in_proportion_to_load():
    """Held at speed against a known torque L: friction c L, whatever the way."""
    t = np.linspace(0.0, 1.0, 11)
    system = joint(("joint:load_dependence",), joint_load_dependence=0.1)
    for load in (2.0, -2.0):
        for speed in (1.0, -1.0):
            done = run(system, t, load, known=-load, velocity=[speed], ports=True)
            assert done.ports["joint"][2][0] == pytest.approx(load)
            assert done.ports["joint"][3][0] == pytest.approx(np.sign(speed) * 0.1 * 2.0, rel=1e-12)
            assert done["joint_velocity"][1] == pytest.approx(speed - np.sign(speed) * 0.02, rel=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_friction_carries_what_the_inertia_before_it_leaves(share: float):
    """What passes the friction of a joint: the motor's effort less what accelerates the share of inertia before it."""
    system = joint(
        ("joint:load_dependence",), joint_load_dependence=0.05, motor_inertia_share=share, gravity_torque=0.4
    )
    done = run(system, np.linspace(0.0, 0.1, 11), 2.0, position=[0.5], velocity=[1.0], ports=True)
    load, friction = done.ports["joint"][2][0], done.ports["joint"][3][0]
    acceleration = 2.0 - 0.4 * np.sin(0.5)  # at an inertia of 1, but for the friction
    assert load == pytest.approx(2.0 - share * acceleration, rel=1e-12)
    assert friction == pytest.approx(0.05 * load, rel=1e-12)


def test_friction_sits_amid_the_inertia_unless_stated():
    system = joint(("joint:load_dependence",), joint_load_dependence=0.05)
    assert system.parameters["motor_inertia_share"] == 0.5
    assert "motor_inertia_share" not in joint().parameters


def test_asymmetry_brakes_more_one_way():
    t = np.linspace(0.0, 1.0, 11)
    system = joint(
        ("joint:coulomb", "joint:asymmetry"), coulomb=0.5, joint_level_asymmetry=0.2, joint_viscous_asymmetry=0.0
    )
    forth, back = (run(system, t, velocity=[v])["joint_velocity"] for v in (2.0, -2.0))
    assert forth == pytest.approx(2.0 - 0.6 * t, rel=1e-12)
    assert back == pytest.approx(-2.0 + 0.4 * t, rel=1e-12)


def test_contact_friction_follows_the_cable_torque():
    """Sliding steadily under a constant pull: what the contact takes is its share of what the cable carries."""
    t = np.linspace(0.0, 2.0, 201)
    system = pair(("joint:viscous", "contact:load_dependence"), joint_viscous=0.5, contact_load_dependence=0.2)
    done = run(system, t, 0.05, ports=True)
    assert done.ports["contact"][3][-1] == pytest.approx(0.2 * done["cable_torque"][-1], rel=1e-9)
    speed = done.ports["joint"][0][-1]
    # rigid limit: N u = (1 + c) f + b w with f = J-weighted; at the end inertias no longer count
    assert 0.5 * speed == pytest.approx(0.8 * 10.0 * 0.05, rel=2e-2)


def test_pair_agrees_with_an_independent_integrator():
    """Gravity, viscous friction, a varying command and a known torque, against scipy's DOP853."""
    t = np.linspace(0.0, 2.0, 401)
    p = {**INERTIAS, "gravity_torque": 1.1}

    def rate(now, y):
        qm, wm, ql, wl = y
        f = p["cable_stiffness"] * (qm / 10.0 - ql) + p["cable_damping"] * (wm / 10.0 - wl)
        u, known = 0.05 * np.sin(7.0 * now), 0.2 * np.cos(3.0 * now)
        return [wm, (u - 2e-4 * wm - f / 10.0) / p["motor_inertia"], wl,
                (f - 0.02 * wl - 1.1 * np.sin(ql) + known) / p["joint_inertia"]]  # fmt: skip

    other = solve_ivp(rate, (0.0, 2.0), [1.0, 0.0, 0.2, 0.5], method="DOP853", t_eval=t, rtol=1e-11, atol=1e-12).y
    system = pair(("motor:viscous", "joint:viscous"), motor_viscous=2e-4, joint_viscous=0.02).with_parameters(
        {"gravity_torque": 1.1}
    )
    done = run(system, t, 0.05 * np.sin(7.0 * t), known=0.2 * np.cos(3.0 * t), position=[1.0, 0.2], velocity=[0.0, 0.5])
    # a cubic spline of 5 ms misses sin(7 t) by (7 h)^4 / 384 = 4e-9
    assert done["motor_angle"] == pytest.approx(other[0], abs=1e-6)
    assert done["joint_angle"] == pytest.approx(other[2], abs=1e-7)
