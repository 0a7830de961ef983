"""The system "ccsrm_tensions": what it shares with the simulator of the whole joint, the fit of S4 eq. (37) by Ceres
beside its closed form, and friction from tensions alone."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.errors import ParameterError
from tendonlab.papers import s4

WINDOW = 4.0  # s
ASYMMETRY = (0.178 - 0.155) / (0.178 + 0.155)
FRICTION = ("friction_coefficient", "contact_coefficient_asymmetry", "contact_viscous", "bristle_stiffness")


@pytest.fixture(scope="module")
def seen() -> pd.DataFrame:
    """What the sensors read of E1."""
    return s4.measured(s4.run_rig(s4.case("E1")), seed=1)


@pytest.fixture(scope="module")
def rig() -> tl.System:
    """The true mechanism and contacts of E1."""
    model = s4.case("E1").model()
    return s4.tension_simulator(model.mechanism, model.contact)


def tensions_of(whole: pd.DataFrame, of: tl.System) -> pd.DataFrame:
    log = whole.rename(columns={"theta2": "driver_angle", "theta1": "joint_angle"})[["driver_angle", "joint_angle"]]
    return of.simulate(log).outputs.rename(columns=lambda name: name.replace("tension_", "T"))


@pytest.mark.parametrize("rate", [1000, 4000])
def test_it_gives_the_tensions_of_the_whole_simulator(rate: int) -> None:
    """Driven by both angles of a run of "ccsrm"."""
    model = s4.case("E1").model()
    time = np.arange(3 * rate + 1) / rate
    drive = s4.printed_drive(soft_start=0.2)
    whole = s4.simulate(s4.simulator(model.mechanism, model.contact), drive, time, tolerance=1e-10)
    found = tensions_of(whole, s4.tension_simulator(model.mechanism, model.contact))
    for name in s4.TENSIONS:
        print(name, np.max(np.abs(found[name] - whole[name])))


@pytest.mark.parametrize("T_p", [50.0, None])
def test_ceres_agrees_with_the_closed_form(seen: pd.DataFrame, rig: tl.System, T_p: float | None) -> None:
    """From 30 % off, k alone and k with T_p, on noisy samples: to 1e-8."""
    window = seen[seen.index >= WINDOW]
    closed = s4.identify_stiffness(window["T22"], s4.synchronous_error(window), r=0.012, T_p=T_p)
    off = {"cable_stiffness": 0.7 * 5.023e4, "pretension": 50.0 if T_p else 40.0}
    free = ["cable_stiffness"] if T_p else ["cable_stiffness", "pretension"]
    fitted = s4.fit_tensions(window, rig.with_parameters(off), free=free, tensions=["T22"], smooth=False)
    assert fitted.converged
    print(fitted.values["cable_stiffness"] / closed.k - 1, fitted.num_iterations)
    assert fitted.values["cable_stiffness"] == pytest.approx(closed.k, rel=1e-8)
    if T_p is None:
        assert fitted.values["pretension"] == pytest.approx(closed.T_p, rel=1e-8)


def test_friction_is_fitted_to_tensions(seen: pd.DataFrame, rig: tl.System) -> None:
    off = {name: 0.7 * rig.parameters[name] for name in FRICTION}
    free = ["cable_stiffness", "pretension", *FRICTION]
    found = s4.fit_tensions(seen, rig.with_parameters(off), free=free).parameters
    print(found)
    assert found.loc["contact_coefficient_asymmetry", "value"] == pytest.approx(ASYMMETRY, abs=1e-3)


def test_the_withheld_direction_is_found_in_tensions(tmp_path: Path) -> None:
    believed = s4.nominal(knows_direction=False)
    logs = s4.write_rig(tmp_path / "t", s4.case("E1"), believed, name="t", system="ccsrm_tensions")
    found = tl.diagnose(tl.load(logs), progress=False)
    print(found, found.effects[0].parameters, found.shrinkage)
    assert found.verdict == "effect"
    assert found.selected == ("contact:asymmetry",)


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
