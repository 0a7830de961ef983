"""S4's closed forms against its check numbers, and what must hold between them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from s4_golden import agree, check

from tendonlab.errors import ParameterError
from tendonlab.papers import s4
from tendonlab.papers.tables import table


def mechanism(given: SimpleNamespace) -> s4.Mechanism:
    """The design with what a check states instead."""
    own = {name: getattr(given, name) for name in ("k", "T_p", "r", "theta_w0") if hasattr(given, name)}
    return replace(s4.design(), **own)


def test_tables_are_those_of_the_paper() -> None:
    assert s4.design() == s4.Mechanism(k=1e6, T_p=50.0, r=0.012, theta_w0=1.69, J=0.01)
    assert s4.contact() == s4.Contact(sigma_0=1e6, sigma_1=1e3, sigma_2=500.0, mu_c=0.15, mu_s=0.18, v_s=5e-5)
    assert s4.identified() == s4.Identified(k=5.023e4, mu_plus=0.178, mu_minus=0.155)
    assert s4.joint() == s4.Joint(f_c=0.0, f_s=0.0, v_s=0.01, sigma_0=1000.0, sigma_1=10.0)
    assert len(table("S4_table1_nomenclature")) == 17


def test_kinematics() -> None:
    g = check("kinematics").given
    stretch = s4.stretch(g.theta1, g.theta2, r=g.r)
    agree({"dtheta": g.theta2 - g.theta1, "dl": stretch, "dS_cable1": -stretch, "dS_cable2": stretch}, "kinematics")


def test_a_cable_does_not_get_longer() -> None:
    """S4 (2): what one pulley takes up the other gives off where both joints turn by the same angle."""
    w = s4.wrap_angles(0.1, 0.1, theta_w0=1.69)
    assert w.w11 + w.w12 == pytest.approx(2 * 1.69, rel=1e-15)
    assert w.w21 + w.w22 == pytest.approx(2 * 1.69, rel=1e-15)
    with pytest.raises(ParameterError, match=r"joint angle = 10 rad: expected less than theta_w0 = 1.69"):
        s4.wrap_angles(0.0, 10.0, theta_w0=1.69)  # "10 sin(0.5 pi t)" cannot be radians


def test_frictionless() -> None:
    m = mechanism(check("frictionless").given)
    dtheta = check("frictionless").given.dtheta
    T = s4.static_tensions(0.0, dtheta, s_1=1, s_2=1, mechanism=m, mu=0.0)
    agree(
        {"T1": T.T12, "T2": T.T22, "tau_c": s4.joint_torque(T, r=m.r), "k_equal": s4.frictionless_stiffness(m)},
        "frictionless",
    )
    assert T.T11 == T.T12 == T.T13


def test_stiffness_of_a_cable() -> None:
    g = check("k_from_EA").given
    agree({"k": s4.cable_stiffness(g.E, g.A, g.l0)}, "k_from_EA")


def test_capstan_ratio() -> None:
    g = check("capstan_eta").given
    eta = s4.capstan_ratio(g.mu, g.theta_wrap, np.array(g.sign_v))
    agree({"eta": eta, "T_out": g.T_in * eta}, "capstan_eta")


@pytest.mark.parametrize("name", ["static_tensions_pos", "static_tensions_neg", "tensions_at_equilibrium_I"])
def test_static_tensions(name: str) -> None:
    g = check(name).given
    m = mechanism(g)
    theta = [
        np.deg2rad(getattr(g, f"theta{j}_deg")) if hasattr(g, f"theta{j}_deg") else getattr(g, f"theta{j}")
        for j in (1, 2)
    ]
    T = s4.static_tensions(*theta, s_1=g.sign_om1, s_2=g.sign_om2, mechanism=m, mu=g.mu)
    found = {**T._asdict(), "dT": T.difference, "tau_c": s4.joint_torque(T, r=m.r)}
    agree({**found, "wrap": s4.wrap_angles(*theta, theta_w0=m.theta_w0)}, name)


@pytest.mark.parametrize("sign", [1, -1])
def test_the_printed_sum_of_exponentials_is_the_same(sign: int) -> None:
    """S4 (18) against (17), for both directions of joint 1 and whatever joint 2 does."""
    m, mu, theta_1, theta_2 = s4.design(), 0.15, 0.0873, 0.0881
    T = s4.static_tensions(theta_1, theta_2, s_1=sign, s_2=-sign, mechanism=m, mu=mu)
    pull = m.k * s4.stretch(theta_1, theta_2, r=m.r)
    wrap = mu * m.theta_w0
    wanted = np.exp(mu * theta_1 * sign) * (2 * np.cosh(wrap) * pull - 2 * m.T_p * sign * np.sinh(wrap))
    assert T.difference == pytest.approx(wanted, rel=1e-12)


@pytest.mark.parametrize(
    "name",
    [
        "equilibrium_errors",
        "equilibrium_identified_plus",
        "equilibrium_identified_minus",
        "equilibrium_identified_k_mu015",
    ],
)
def test_equilibria_and_backlash(name: str) -> None:
    g = check(name).given
    m = mechanism(g)
    plus, minus = (s4.equilibrium_error(sign=s, mechanism=m, mu=g.mu) for s in (1, -1))
    gap = s4.backlash(mechanism=m, mu=g.mu)
    found = {"dtheta_plus": plus, "dtheta_minus": minus, "dtheta_plus_deg": np.rad2deg(plus), "backlash": gap}
    found["backlash_deg"] = np.rad2deg(gap)
    agree({key: value for key, value in found.items() if key in check(name).expected}, name)


def test_the_equilibrium_is_one() -> None:
    """No torque on joint 1 at the error of S4 (20), whatever the angle: the wrap cancels."""
    m = s4.design()
    for theta_1 in (-0.15, 0.0, 0.15):
        error = s4.equilibrium_error(sign=1, mechanism=m, mu=0.15)
        T = s4.static_tensions(theta_1, theta_1 + error, s_1=1, s_2=1, mechanism=m, mu=0.15)
        assert abs(T.difference) < 1e-12
    assert pytest.approx(T.T21) == T.T11


def test_stiffness() -> None:
    g = check("stiffness").given
    m, theta = mechanism(g), np.deg2rad(g.theta1_deg)
    plus, minus = (s4.stiffness(theta, sign=s, mechanism=m, mu=g.mu) for s in (1, -1))
    agree({"k_plus": plus, "k_minus": minus, "frictionless": s4.frictionless_stiffness(m)}, "stiffness")
    assert plus[-1] / minus[-1] == pytest.approx(np.exp(2 * 0.15 * theta[-1]), rel=1e-12)  # 5.4 %, no jump at 0


def test_stiffness_is_the_slope_of_the_torque() -> None:
    """S4 (21), with theta_1 held and joint 2 moved."""
    m, mu, theta_1, step = s4.design(), 0.15, 0.1, 1e-7

    def torque(error: float) -> float:
        T = s4.static_tensions(theta_1, theta_1 + error, s_1=1, s_2=1, mechanism=m, mu=mu)
        return float(s4.joint_torque(T, r=m.r))

    slope = (torque(step) - torque(-step)) / (2 * step)
    assert slope == pytest.approx(s4.stiffness(theta_1, sign=1, mechanism=m, mu=mu), rel=1e-8)


def test_saturation() -> None:
    g = check("sat").given
    agree({"sat": s4.saturation(g.v, v_threshold=g.v_threshold)}, "sat")


def test_play() -> None:
    g = check("capstan_play").given
    play = s4.capstan_play(np.array(g.T_in, dtype=float), T_0=g.T_out0, mu=g.mu, wrap=g.theta_wrap)
    up = np.linspace(50.0, 80.0, 300001)
    moved = s4.capstan_play(up, T_0=50.0, mu=g.mu, wrap=g.theta_wrap) > 50.0
    down = np.linspace(80.0, 40.0, 400001)
    fell = s4.capstan_play(down, T_0=80.0 * np.exp(-g.mu * g.theta_wrap), mu=g.mu, wrap=g.theta_wrap)
    falls = fell < fell[0]
    one = check("capstan_play")
    np.testing.assert_allclose(play, one.expected["T_out"], rtol=one.rtol)
    assert up[moved][0] == pytest.approx(one.expected["T_in_at_B"], abs=2e-4)  # two steps of the ramp
    assert down[falls][0] / 80.0 == pytest.approx(one.expected["ratio_C_to_D"], abs=3e-6)
    with pytest.raises(ParameterError, match="a cable does not push"):
        s4.capstan_play(np.array([1.0, -1.0]), T_0=1.0, mu=0.1, wrap=1.0)


def test_tensions_at_the_largest_error_of_the_rig() -> None:
    g = check("tension_at_1p56deg").given
    m = mechanism(g)
    T = s4.static_tensions(0.0, np.deg2rad(g.err_deg), s_1=1, s_2=1, mechanism=m, mu=0.178)
    agree({"k_dl": T.T22 - m.T_p, "T22": T.T22, "T12": T.T12}, "tension_at_1p56deg")
    assert np.rad2deg(s4.ERROR_ON_THE_RIG) == pytest.approx(g.err_deg)


def test_sections_in_series() -> None:
    g = check("series_stiffness").given
    agree({"k_series": s4.series_stiffness(g.k1, g.k2, g.k3)}, "series_stiffness")


def test_the_error_at_which_a_cable_goes_slack() -> None:
    assert np.rad2deg(s4.design().slack_error) == pytest.approx(0.239, abs=5e-4)
    assert np.rad2deg(replace(s4.design(), k=5.023e4).slack_error) == pytest.approx(4.75, abs=5e-3)
