"""The system "ccsrm_tensions": what it shares with the simulator of the whole joint, the fit of S4 eq. (37) by Ceres
beside its closed form, and friction from tensions alone."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from diagnoses import diagnose
from tendonlab.errors import ParameterError
from tendonlab.papers import s4

WINDOW = 2.0  # s
ASYMMETRY = (0.178 - 0.155) / (0.178 + 0.155)
FRICTION = ("friction_coefficient", "contact_coefficient_asymmetry", "contact_viscous", "bristle_stiffness")


@pytest.fixture(scope="module")
def seen() -> pd.DataFrame:
    """What the sensors read of E1, driven so that nothing rings."""
    drive = s4.printed_drive(soft_start=0.5)
    return s4.measured(s4.run_rig(s4.case("E1"), drive=drive, duration=8.0), seed=1)


@pytest.fixture(scope="module")
def rig() -> tl.System:
    """The true mechanism and contacts of E1."""
    model = s4.case("E1").model()
    return s4.tension_simulator(model.mechanism, model.contact)


def tensions_of(whole: pd.DataFrame, of: tl.System) -> pd.DataFrame:
    log = whole.rename(columns={"theta2": "driver_angle", "theta1": "joint_angle"})[["driver_angle", "joint_angle"]]
    return of.simulate(log).outputs.rename(columns=lambda name: name.replace("tension_", "T"))


def test_it_gives_the_tensions_of_the_whole_simulator(rig: tl.System) -> None:
    """Driven by both angles of a run of "ccsrm": the middle tensions to the last bits, the others as well as a bristle
    is known that passes a whole sampling interval at once. That is of second order: 1.1 mN at 1 kHz, 0.08 at 4 kHz."""
    model = s4.case("E1").model()
    simulator, drive = s4.simulator(model.mechanism, model.contact), s4.printed_drive(soft_start=0.2)
    largest = {}
    for rate in (1000, 4000):
        whole = s4.simulate(simulator, drive, np.arange(3 * rate + 1) / rate, tolerance=1e-10)
        error = (tensions_of(whole, rig) - whole[list(s4.TENSIONS)]).abs().max()
        assert error[["T12", "T22"]].max() < 1e-11
        largest[rate] = error.max()
    assert largest[1000] < 2e-3
    assert largest[4000] < largest[1000] / 10


@pytest.mark.parametrize("T_p", [50.0, None])
def test_ceres_agrees_with_the_closed_form(seen: pd.DataFrame, rig: tl.System, T_p: float | None) -> None:
    """From 30 % off, k alone and k with T_p, on noisy samples: to 1e-8, S4 section V (37)."""
    window = seen[seen.index >= WINDOW]
    closed = s4.identify_stiffness(window["T22"], s4.synchronous_error(window), r=0.012, T_p=T_p)
    off = {"cable_stiffness": 0.7 * 5.023e4, "pretension": 50.0 if T_p else 40.0}
    free = ["cable_stiffness"] if T_p else ["cable_stiffness", "pretension"]
    fitted = s4.fit_tensions(window, rig.with_parameters(off), free=free, tensions=["T22"], smooth=False)
    assert fitted.converged
    assert fitted.values["cable_stiffness"] == pytest.approx(closed.k, rel=1e-8)
    if T_p is None:
        assert fitted.values["pretension"] == pytest.approx(closed.T_p, rel=1e-8)


def test_friction_is_fitted_to_tensions(seen: pd.DataFrame, rig: tl.System) -> None:
    """Everything at once, from 30 % off. Angles count as exact; what their encoders round shows in the bristles, and
    moves the asymmetry by some 2 % and the viscous share by 6 %."""
    off = {name: 0.7 * rig.parameters[name] for name in FRICTION}
    free = ["cable_stiffness", "pretension", *FRICTION]
    found = s4.fit_tensions(seen, rig.with_parameters(off), free=free)
    assert found.converged
    assert found.values["cable_stiffness"] == pytest.approx(5.023e4, rel=2e-3)
    assert found.values["friction_coefficient"] == pytest.approx(0.1665, abs=1e-3)
    assert found.values["contact_coefficient_asymmetry"] == pytest.approx(ASYMMETRY, abs=2e-3)
    assert found.values["bristle_stiffness"] == pytest.approx(1e6, rel=0.05)
    assert found.values["contact_viscous"] == pytest.approx(500.0, rel=0.1)


@pytest.mark.slow
def test_the_withheld_direction_is_found_in_tensions(tmp_path: Path) -> None:
    believed = s4.nominal(knows_direction=False)
    logs = s4.write_rig(tmp_path / "t", s4.case("E1"), believed, name="t", system="ccsrm_tensions")
    found = diagnose(tl.load(logs))
    assert found.verdict == "effect"
    assert found.selected == ("contact:asymmetry",)


@pytest.mark.slow
def test_joint_friction_is_no_matter_of_the_tensions(tmp_path: Path) -> None:
    """E3: where both angles are read, friction of joint 1 explains nothing, and is not missed."""
    believed = s4.nominal(knows_direction=True)
    logs = s4.write_rig(tmp_path / "t", s4.case("E3"), believed, name="t", system="ccsrm_tensions")
    assert diagnose(tl.load(logs)).verdict == "no_gap"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"free": ["stiffness"]}, "free: 'stiffness'"),
        ({"tensions": ["T31"]}, "tensions: 'T31'"),
        ({"noise": 0.0}, "noise = 0.0: expected"),
        ({"start": s4.simulator()}, "start.kind = 'ccsrm': expected 'ccsrm_tensions'"),
        ({"read": pd.DataFrame({"theta1": [0.0]})}, "read: 'theta2'"),
    ],
)
def test_a_wrong_input_is_named(seen: pd.DataFrame, change: dict[str, object], said: str) -> None:
    given = {"read": seen, "start": s4.tension_simulator(), "free": ["cable_stiffness"], **change}
    with pytest.raises(ParameterError, match=said):
        s4.fit_tensions(given.pop("read"), given.pop("start"), **given)
