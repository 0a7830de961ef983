"""The joint behind its motor: bushings that brake the nuts stick, let go and turn with them, as an R of Fig. 2 does."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from integrate.rig import differences, relative, run
from tendonlab.papers import s2
from tendonlab.simulation.system import System

RIG = s2.constants(viscous_reading="C")
T = np.linspace(0.0, 2.0, 401)
SWING = np.sin(2.0 * np.pi * T)
SINE = {f"bushing_{i}:bushing_sine": {f"bushing_{i}_sine_coefficient": 0.35} for i in (1, 2)}
DRY = {"joint:coulomb": {"joint_coulomb": 1.0}}
HELD = {"motor:coulomb": {"motor_coulomb": 1e-3}}


def regularised(time: np.ndarray, volts: np.ndarray, *, creep: float) -> dict[str, np.ndarray]:
    """The closed forms (1) to (6) under an independent stepper; the sense of friction turns over `creep`, m/s, of the
    nuts, so that what sticks here creeps there."""
    start = float(s2.equations.holding_difference(RIG, 0.0)) / (2.0 * RIG.K)

    def forces(x: np.ndarray) -> tuple[list[float], list[float]]:
        theta, nut = x[5], RIG.N * x[1] / RIG.J_m
        stretch = s2.equations.elongation_rates(RIG, theta, x[4] / RIG.J_1, nut)
        carried = [float(s2.equations.cable_force(RIG, x[2 + i], stretch[i])) for i in (0, 1)]
        sense = np.tanh(nut / creep)
        both = [[float(s2.equations.bushing_force(b, theta, s, RIG.T)) for s in (1.0, -1.0)] for b in RIG.bushings]
        friction = [0.5 * (f + b) + 0.5 * (f - b) * sense for f, b in both]
        return carried, [carry + rub for carry, rub in zip(carried, friction, strict=True)]

    def rates(now: float, x: np.ndarray) -> list[float]:
        joint, nuts = forces(x)
        theta, speed = x[5], x[4] / RIG.J_1
        stretch = s2.equations.elongation_rates(RIG, theta, speed, RIG.N * x[1] / RIG.J_m)
        voltage = np.interp(now, time, volts)
        return [
            float(s2.equations.winding_rate(RIG, x[0], x[1], voltage)),
            float(s2.equations.motor_rate(RIG, x[0], x[1], nuts[0] - nuts[1])),
            *map(float, stretch),
            float(s2.equations.joint_rate(RIG, theta, x[4], joint[0] - joint[1])),
            speed,
        ]

    sizes = np.array([1e-3, 1e-3, 1e-5, 1e-5, 1e-5, 1e-3])
    begin = [0.0, 0.0, start, -start, 0.0, 0.0]
    found = solve_ivp(rates, time[[0, -1]], begin, "LSODA", time, rtol=1e-7, atol=1e-9 * sizes, max_step=5e-4).y
    nuts = np.array([forces(x)[1] for x in found.T]).T
    return {
        "motor_velocity": found[1] / RIG.J_m,
        "joint_velocity": found[4] / RIG.J_1,
        "joint_angle": found[5],
        "cable_force_1": nuts[0],
        "cable_force_2": nuts[1],
    }


def test_bushings_stick_and_slip_as_the_closed_forms_do() -> None:
    """A swing of 2 V, then one of 1 mV, which the friction of the bushings holds: what holds shows in both forces."""
    time = np.linspace(0.0, 0.15, 301)
    volts = np.where(time < 0.1, 2.0, 1e-3) * np.sin(20.0 * np.pi * time)
    found = run(s2.system(RIG), time, {"voltage": volts}, kind="linear", tolerance=1e-9)
    wanted = regularised(time, volts, creep=1e-10)
    assert np.count_nonzero(found["motor_velocity"] == 0.0) > 80
    for name, close in (("motor_velocity", 2e-4), ("joint_velocity", 2e-4), ("joint_angle", 2e-4)):
        assert found[name] == pytest.approx(wanted[name], abs=close * np.abs(wanted[name]).max()), name
    for name in ("cable_force_1", "cable_force_2"):  # beside a reversal the regularised force still turns
        assert np.quantile(np.abs(found[name] - wanted[name]), 0.9) < 0.01, name


@pytest.mark.parametrize("effects", [{}, SINE, DRY, HELD, {**SINE, **DRY, **HELD}])
@pytest.mark.parametrize("volts", [0.01, 0.5, 5.0])
def test_friction_does_not_chatter(volts: float, effects: dict) -> None:
    """Two swings: each port stops and lets go at each reversal, which is four times, and perhaps once at the start. No
    more than one attempt a sample fails, where the curvature of the voltage jumps."""
    done = run(s2.system(RIG).with_effects(effects), T, {"voltage": volts * SWING}, tolerance=1e-8)
    assert done.events <= 2 * (4 + 1) + 2
    assert done.rejected < len(T)
    assert done.attempts < 4 * len(T)


def test_friction_of_the_guides_feeds_no_motion() -> None:
    """Eq. 10 acts on the nuts: there it takes power, whatever the joint does behind its elastic cables."""
    plain = {name: value for name, value in s2.parameters(RIG).items() if not name.startswith("bushing")}
    system = System(kind="cable_joint", parameters=plain, effects=("motor:viscous", "gear:arctan")).with_effects(SINE)
    time = np.linspace(0.0, 1.0, 20001)
    done = run(system, time, {"voltage": 0.5 * np.sin(2.0 * np.pi * time)}, position=[0.4], ports=True)
    for guide, way in (("bushing_1", 1.0), ("bushing_2", -1.0)):
        power = way * RIG.N * done["motor_velocity"] * done.ports[guide][3]
        assert np.all(power >= 0.0)
        assert np.any(power > 0.0)


def test_what_holds_the_nuts_balances_what_pushes() -> None:
    """At rest without voltage no torque is left on the motor: both nuts carry the same force, whatever the joint
    weighs. Motor friction that holds as well takes its share."""
    volts = np.where(T < 0.5, 3.0 * SWING, 0.0)
    alone = run(s2.system(RIG), T, {"voltage": volts})
    assert alone["motor_velocity"][-1] == 0.0
    assert alone["cable_force_1"][-1] == pytest.approx(alone["cable_force_2"][-1], abs=1e-6)
    both = run(s2.system(RIG).with_effects(HELD), T, {"voltage": volts}, ports=True)
    difference = both["cable_force_1"][-1] - both["cable_force_2"][-1]
    motor = both.ports["motor"][3, -1]
    assert both["motor_velocity"][-1] == 0.0
    assert motor != 0.0
    assert RIG.N * difference + motor == pytest.approx(0.0, abs=1e-9)


SHORT = slice(None, 201)
BY = ("torque_constant", "cable_stiffness", "pretension", "bushing_1_a1", "bushing_2_b21")


@pytest.mark.parametrize(
    ("effects", "own"),
    [
        ({}, ()),
        (DRY, ("joint_coulomb",)),
        (HELD, ("motor_coulomb",)),
        ({**SINE, **DRY, **HELD}, ("joint_coulomb", "motor_coulomb", "bushing_1_sine_coefficient")),
    ],
)
def test_derivatives_across_stops_and_releases(effects: dict, own: tuple[str, ...]) -> None:
    """Dry friction of joint and motor beside bushings whose force jumps with the sense; the voltage lingers about zero,
    so that at each reversal all that is dry sticks and lets go."""
    system, volts = s2.system(RIG).with_effects(effects), {"voltage": 10.0 * SWING[SHORT] ** 3}
    exact = run(system, T[SHORT], volts, by=[*BY, *own], tolerance=1e-10)
    assert exact.events >= 4
    for name in (*BY, *own):
        step = 1e-4 * system.parameters[name]
        found = differences(system, name, T[SHORT], volts, step=step, tolerance=1e-12)
        for got, wanted, output in zip(exact.gradient[name], found, exact.table, strict=True):
            noise = 1e-10 * np.sqrt(np.mean(output**2)) / abs(step)
            assert relative(got, wanted) < 1e-4 or np.max(np.abs(got - wanted)) < noise, name
