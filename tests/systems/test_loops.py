"""Controllers around a system against independent computations."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrate.rig import FRICTION, INERTIAS, NOMINAL, controller, joint, pair, run
from tendonlab import _core
from tendonlab.simulation.signals import hold, linear, smooth

T = np.linspace(0.0, 2.0, 401)
KP, KD = 30.0, 4.0


def loop(reference, **changes):
    return controller(reference, **{"proportional": KP, "derivative": KD, **changes})


def wave(t):
    return 0.5 * np.sin(3.0 * t)


def slope(t):
    return 1.5 * np.cos(3.0 * t)


def integrate(command, start=(0.1, 0.0), viscous=0.3):
    """J = 1, viscous friction and gravity under `command(t, q, v)`."""
    return solve_ivp(
        lambda t, y: [y[1], command(t, y[0], y[1]) - viscous * y[1] - 2.0 * np.sin(y[0])], (0.0, 2.0), start,
        method="DOP853", t_eval=T, rtol=1e-11, atol=1e-12, max_step=0.01,
    ).y[0]  # fmt: skip


def simulated(closed, effects=(), **parameters):
    system = joint(("joint:viscous", *effects), viscous=0.3, gravity_torque=2.0, **parameters)
    return run(system, T, loop=closed, position=[0.1])["joint_angle"]


def test_pd_on_the_error():
    other = integrate(lambda t, q, v: KP * (wave(t) - q) + KD * (slope(t) - v))
    assert simulated(loop(smooth(T, wave(T)))) == pytest.approx(other, abs=1e-7)  # slope of the spline: h^3 / 24


def test_pd_with_the_derivative_of_the_measurement():
    other = integrate(lambda t, q, v: KP * (wave(t) - q) - KD * v)
    assert simulated(loop(smooth(T, wave(T)), reference_weight=0.0)) == pytest.approx(other, abs=1e-8)


def test_cascade_is_proportional_position_over_proportional_velocity():
    """u = k_v (k_p (r - q) - v): as the replay writes it for the core, P = k_v k_p and D = k_v."""
    kp, kv = 7.0, 5.0
    other = integrate(lambda t, q, v: kv * (kp * (wave(t) - q) - v))
    found = simulated(loop(smooth(T, wave(T)), proportional=kv * kp, derivative=kv, reference_weight=0.0))
    assert found == pytest.approx(other, abs=1e-8)


def test_limit_clips_the_command():
    other = integrate(lambda t, q, v: np.clip(KP * (wave(t) - q) + KD * (slope(t) - v), -3.0, 3.0))
    free = integrate(lambda t, q, v: KP * (wave(t) - q) + KD * (slope(t) - v))
    assert np.max(abs(other - free)) > 0.01
    found = simulated(loop(smooth(T, wave(T)), limit=3.0))
    assert found == pytest.approx(other, abs=1e-6)  # scipy steps over the corner


def test_disturbance_adds_after_the_limit():
    other = integrate(lambda t, q, v: np.clip(KP * (wave(t) - q) + KD * (slope(t) - v), -3.0, 3.0) + np.sin(20.0 * t))
    closed = loop(smooth(T, wave(T)), limit=3.0, disturbance=smooth(T, np.sin(20.0 * T)))
    assert simulated(closed) == pytest.approx(other, abs=1e-6)


def test_bias_and_actuator_inside_the_loop():
    """The controller reads the biased sensor; its command passes gain error and offset."""
    other = integrate(lambda t, q, v: 0.9 * (KP * (wave(t) - (q + 0.05)) + KD * (slope(t) - v)) + 0.2)
    found = simulated(loop(smooth(T, wave(T))), ("sensor.joint_angle:bias", "actuation:gain_error", "actuation:offset"),
                      sensor__joint_angle_bias=0.05, actuation_gain_error=-0.1, actuation_offset=0.2)  # fmt: skip
    assert found - 0.05 == pytest.approx(other, abs=1e-7)


def exact_step(q, v, u, dt):
    """A unit mass under a constant effort."""
    return q + v * dt + 0.5 * u * dt**2, v + u * dt


def sampled_by_hand(
    reference, *, sample, limit=np.inf, late=0.0, sensor_late=0.0, bias=0.0, weight=1.0, kp=30.0, kd=4.0
):
    """A unit mass, no friction: computer reads, differentiates backwards, commands `late` after; all in closed form.
    Until the first command arrives the one before the record acts, which was the same."""
    first = float(np.clip(kp * (reference(0.0) - (0.1 + bias)), -limit, limit))
    pieces = [(0.0, 0.1, 0.0, first)]  # start, q, v, effort from there on
    due, last_y, last_r = [], None, None

    def state(t):
        start, q, v, u = next(p for p in reversed(pieces) if p[0] <= t + 1e-12) if t > 0 else (0.0, 0.1, 0.0, 0.0)
        return exact_step(q, v, u, max(t - start, 0.0))

    def apply(until):
        while due and due[0][0] <= until + 1e-12:
            at, u = due.pop(0)
            pieces.append((at, *state(at), u))

    for k in range(round(2.0 / sample)):
        t = k * sample
        apply(t)
        y, r = state(t - sensor_late)[0] + bias, reference(t)
        rate = 0.0 if last_y is None else (weight * (r - last_r) - (y - last_y)) / sample
        due.append((t + late, float(np.clip(kp * (r - y) + kd * rate, -limit, limit))))
        last_y, last_r = y, r
        apply(t)
    apply(2.0)
    return np.array([state(t)[0] for t in T])


@pytest.mark.parametrize("limit", [np.inf, 5.0])
@pytest.mark.parametrize("weight", [0.0, 1.0])
def test_sampled_controller(limit, weight):
    """A loop of 4 ms against one written out by hand; the samples of the record do not fall on its clock."""
    closed = loop(linear(T, wave(T)), sample_time=0.004, limit=limit, reference_weight=weight)
    done = run(joint(), T, loop=closed, position=[0.1])
    other = sampled_by_hand(lambda t: np.interp(t, T, wave(T)), sample=0.004, limit=limit, weight=weight)
    assert done["joint_angle"] == pytest.approx(other, abs=1e-11)  # constant effort between ticks: no error of a step


def test_a_sampled_controller_reads_the_biased_sensor():
    """The error of its law has the bias in it; the record shows what the sensor reads."""
    system = joint(("sensor.joint_angle:bias",), sensor__joint_angle_bias=0.05)
    done = run(system, T, loop=loop(linear(T, wave(T)), sample_time=0.004), position=[0.1])
    other = sampled_by_hand(lambda t: np.interp(t, T, wave(T)), sample=0.004, bias=0.05)
    assert done["joint_angle"] - 0.05 == pytest.approx(other, abs=1e-11)


def test_sampled_controller_with_delays():
    effects = ("actuation:delay", "sensor.joint_angle:delay")
    system = joint(effects, actuation_delay=0.0053, sensor__joint_angle_delay=0.0071)
    done = run(system, T, loop=loop(linear(T, wave(T)), sample_time=0.004, derivative=2.0), position=[0.1])
    other = sampled_by_hand(lambda t: np.interp(t, T, wave(T)), sample=0.004, late=0.0053, sensor_late=0.0071, kd=2.0)
    read = np.interp(T - 0.0071, T, other)  # the record shows what the sensor gives; linear between samples of 5 ms
    assert done["joint_angle"][2:] == pytest.approx(read[2:], abs=2e-4)
    plain = joint(effects, actuation_delay=0.0053, sensor__joint_angle_delay=0.0071)
    state = run(plain, T, loop=loop(linear(T, wave(T)), sample_time=0.004, derivative=2.0), position=[0.1], ports=True)
    assert state.ports["joint"][1] == pytest.approx(other, abs=1e-11)


def test_held_reference_steps():
    """A reference that the hardware holds: the loop sees each step where it happens."""
    steps = np.where(T < 0.4975, 0.0, 0.5)

    def pulled(t, y):
        return [y[1], -KP * y[0] - KD * y[1]]

    other = solve_ivp(pulled, (0.0, 2.0), (0.1, 0.0), t_eval=T[:100], rtol=1e-11, atol=1e-12).y[0]
    done = run(joint(), T, loop=loop(hold(T, steps)), position=[0.1])
    assert done["joint_angle"][:100] == pytest.approx(other, abs=1e-8)
    settled = run(joint(), np.linspace(0.0, 10.0, 2001), loop=loop(hold(T, steps)), position=[0.1])["joint_angle"][-1]
    assert settled == pytest.approx(0.5, abs=1e-8)


def late_by_steps(late, sensor_late, dt=2e-6):
    """The delayed loop by Heun's rule at a fixed step, delays a whole number of steps."""
    n, lag = round(1.0 / dt), round((late + sensor_late) / dt)
    command = round(late / dt)
    q, v = np.empty(n + 1), np.empty(n + 1)
    q[0], v[0] = 0.1, 0.0

    def effort(i, now_q, now_v):
        j = i - lag
        past_q, past_v = (q[0], v[0]) if j < 0 else (q[j], v[j])
        t = (i - command) * dt
        return KP * (wave(t) - past_q) + KD * (slope(t) - past_v) - 2.0 * np.sin(now_q) - 0.3 * now_v

    for i in range(n):
        a = effort(i, q[i], v[i])
        q1, v1 = q[i] + dt * v[i], v[i] + dt * a
        b = effort(i + 1, q1, v1)
        q[i + 1], v[i + 1] = q[i] + 0.5 * dt * (v[i] + v1), v[i] + 0.5 * dt * (a + b)
    return q[:: round(0.005 / dt)]


def test_late_loop_in_continuous_time():
    """Command and sensor late: against a plain loop of 2 us steps."""
    late, sensor_late = 0.006, 0.004
    padded = np.linspace(-0.1, 2.0, 4201)
    system = joint(("joint:viscous", "actuation:delay", "sensor.joint_angle:delay"), viscous=0.3, gravity_torque=2.0,
                   actuation_delay=late, sensor__joint_angle_delay=sensor_late)  # fmt: skip
    closed = loop(smooth(padded, wave(padded)))
    done = run(system, T[:201], loop=closed, position=[0.1], ports=True)
    assert done.ports["joint"][1] == pytest.approx(late_by_steps(late, sensor_late), abs=1e-8)


def test_injection_pulls_the_model_to_the_record():
    """u + P (y - q) + D (y' - q') with a bias taken off the record."""
    other = integrate(lambda t, q, v: 1.0 + KP * (wave(t) - 0.02 - q) + KD * (slope(t) - v))
    closed = loop(smooth(T, wave(T)), kind="injection")
    system = joint(
        ("joint:viscous", "sensor.joint_angle:bias"), viscous=0.3, gravity_torque=2.0, sensor__joint_angle_bias=0.02
    )
    done = run(system, T, 1.0, loop=closed, position=[0.1])
    assert done["joint_angle"] - 0.02 == pytest.approx(other, abs=1e-7)


def test_an_injection_ends_where_a_late_sensor_would_show_what_was_not_logged():
    """A rig replayed with its own parameters moves as it did, to its last sample: its sensor is 30 ms late, and nobody
    knows what it would have shown after the end."""
    late = {"viscous": 0.3, "sensor__joint_angle_delay": 0.03}
    system = joint(("joint:viscous", "sensor.joint_angle:delay"), **late)
    force = np.sin(3.0 * T)
    recorded = run(system, T, force, velocity=[0.5])
    log = smooth(T, recorded["joint_angle"] + 1e-5 * np.random.default_rng(0).standard_normal(len(T)))
    pulled = controller(log, kind="injection", proportional=200.0, derivative=20.0)
    error = np.abs(run(system, T, force, loop=pulled, velocity=[0.5])["joint_velocity"] - recorded["joint_velocity"])
    assert np.max(error[-6:]) < 3.0 * np.max(error[100:-6])


def test_motor_loop_of_a_pair_with_friction_holds_its_reference():
    """PD on the motor of a rig that sticks: it comes to rest within what friction allows."""
    t = np.linspace(0.0, 3.0, 301)
    system = pair(NOMINAL, **FRICTION)
    done = run(system, t, loop=controller(hold(t, np.full_like(t, 1.0)), proportional=0.5, derivative=0.01))
    assert np.all(done["motor_angle"][-50:] == done["motor_angle"][-1])
    allowed = (FRICTION["motor_coulomb"] + FRICTION["joint_coulomb"] / INERTIAS["gear_ratio"]) / 0.5
    assert abs(done["motor_angle"][-1] - 1.0) <= allowed * (1 + 1e-9)


def test_open_loop_is_a_loop_without_gains():
    plain = run(pair(NOMINAL, **FRICTION), T, 0.02 * np.sin(9.0 * T))
    closed = controller(_core.Signal(), kind="injection", proportional=0.0, derivative=0.0)
    assert np.array_equal(run(pair(NOMINAL, **FRICTION), T, 0.02 * np.sin(9.0 * T), loop=closed).table, plain.table)
