"""The bond graphs of S2 give the closed forms (1) to (6), with every state drawn at random."""

import numpy as np
import pytest

from tendonlab.mechanics.bondgraph import derive
from tendonlab.papers.s2 import constants, equations, graphs

RIG = constants().with_(phi=0.3)
DRAWS = np.random.default_rng(2).normal(size=(200, 7))
CLOSE = 1e-12  # of the largest term: both sides are sums of the same terms


def test_the_motor_gives_equation_1() -> None:
    motor = derive(graphs.motor_graph(RIG))
    assert (motor.states, motor.causality.dependent) == (("x_1", "x_2"), ())
    for draw in DRAWS:
        x_1, x_2, voltage, one, two = draw[:5] * [1e-2, 1e-2, 24.0, 200.0, 200.0]
        found = motor.rates({"x_1": x_1, "x_2": x_2}, {"V": voltage, "F_act_1": one, "F_act_2": two})
        scale = abs(voltage) + abs(RIG.R_m * x_1 / RIG.L_m) + abs(RIG.k_m * x_2 / RIG.J_m)
        assert found["x_1"] == pytest.approx(equations.winding_rate(RIG, x_1, x_2, voltage), abs=CLOSE * scale)
        scale = abs(RIG.k_m * x_1 / RIG.L_m) + abs(RIG.c_m * x_2 / RIG.J_m) + RIG.N * (abs(one) + abs(two)) + RIG.alpha
        assert found["x_2"] == pytest.approx(equations.motor_rate(RIG, x_1, x_2, one - two), abs=CLOSE * scale)


def test_the_cable_gives_equations_2_and_3() -> None:
    cable = derive(graphs.cable_graph(RIG))
    assert cable.states == ("x_4",)
    for draw in DRAWS:
        x_4, nut, joint = draw[:3] * [2e-4, 1e-3, 1e-3]
        found = cable.rates({"x_4": x_4}, {"v_a": nut, "v_j": joint})
        assert found["x_4"] == pytest.approx(nut - joint, abs=CLOSE * 1e-3)
        values = cable.bond_values({"x_4": x_4}, {"v_a": nut, "v_j": joint})
        force = next(e for bond, (e, _) in values.items() if bond.tail == "v_a")
        expected = RIG.T + RIG.K * x_4 + RIG.c * (nut - joint)
        assert force == pytest.approx(expected, abs=CLOSE * 300.0)
        if expected > 0:  # a graph has no unilateral spring
            assert force == pytest.approx(equations.cable_force(RIG, x_4, nut - joint), abs=CLOSE * 300.0)


def test_the_joint_gives_equations_5_and_6() -> None:
    """One independent inertia, five that follow it: masses by components, J_2 by the double angle."""
    joint = derive(graphs.joint_graph(RIG))
    assert (joint.states, len(joint.causality.dependent)) == (("x_5", "theta"), 5)
    for draw in DRAWS:
        theta, speed, one, two = draw[:4] * [0.5, 2.0, 200.0, 200.0]
        x_5 = RIG.J_1 * speed
        found = joint.rates({"x_5": x_5, "theta": theta}, {"F_r_1": one, "F_r_2": two})
        scale = RIG.r * (abs(one) + abs(two)) * RIG.J_1 / equations.inertia(RIG, theta)
        assert found["x_5"] == pytest.approx(equations.joint_rate(RIG, theta, x_5, one - two), abs=CLOSE * scale)
        assert found["theta"] == pytest.approx(speed, rel=1e-14)


def test_the_whole_gives_all_of_them_at_once() -> None:
    whole = derive(graphs.whole_graph(RIG, (lambda v, q: 20.0 * np.sign(v) * (1 + q), lambda v, q: -9.0 * np.sign(v))))
    assert whole.states == ("x_1", "x_2", "x_4_1", "x_4_2", "x_5", "theta")
    assert whole.inputs == ("V",)
    for draw in DRAWS:
        scaled = draw * [1e-2, 1e-2, 1e-4, 1e-4, 1e-3, 0.5, 24.0]
        x_1, x_2, x_41, x_42, x_5, theta, voltage = scaled
        found = whole.rates(dict(zip(whole.states, scaled[:6], strict=True)), {"V": voltage})
        nut, speed = RIG.N * x_2 / RIG.J_m, x_5 / RIG.J_1
        rates = equations.elongation_rates(RIG, theta, speed, nut)
        one, two = (RIG.T + RIG.K * x + RIG.c * v for x, v in zip((x_41, x_42), rates, strict=True))
        act = one + 20.0 * np.sign(nut) * (1 + theta) - two + 9.0 * np.sign(nut)
        expected = {
            "x_1": equations.winding_rate(RIG, x_1, x_2, voltage),
            "x_2": equations.motor_rate(RIG, x_1, x_2, act),
            "x_4_1": rates[0],
            "x_4_2": rates[1],
            "x_5": equations.joint_rate(RIG, theta, x_5, one - two),
            "theta": speed,
        }
        force = RIG.c * (abs(nut) + RIG.r * abs(speed)) + 500.0
        scale = {"x_1": 300.0, "x_2": 10.0, "x_4_1": abs(nut) + RIG.r * abs(speed), "x_5": RIG.r * force, "theta": 10.0}
        for name, value in expected.items():
            close = CLOSE * scale.get(name, scale["x_4_1"])
            assert found[name] == pytest.approx(float(value), abs=close), name
