"""The rig of S4 as a dataset: what its simulator believes, what the sensors read, and intervals from replicates."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy import stats

import tendonlab as tl
from tendonlab.errors import ParameterError
from tendonlab.papers import s4
from tendonlab.papers.s4 import dataset, rounding
from tendonlab.papers.s4.constants import RESOLUTION, contact, design, identified
from tendonlab.papers.s4.twin import TENSIONS

BELIEVED = dataset.Nominal(k=4e4, mu=0.15, T_p=40.0)


@pytest.fixture
def exact(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Runs that need no simulation: the drive's angle, 1.1 times it, and tensions that name themselves."""
    drives = []

    def run(of: Any, *, drive: Any, duration: float, rtol: float) -> pd.DataFrame:
        drives.append(drive)
        time = np.arange(round(duration * 1000) + 1) / 1000
        angle = drive.amplitude * np.sin(drive.omega * time)
        columns = {"theta2": angle, "theta1": 1.1 * angle, **{name: float(name[1:]) + 0 * time for name in TENSIONS}}
        return pd.DataFrame(columns, index=pd.Index(time, name="t"))

    monkeypatch.setattr(dataset, "run_rig", run)
    return drives


def test_the_simulator_believes_what_it_is_given_and_the_papers_numbers(tmp_path: Path, exact: list[Any]) -> None:
    rig = tl.load(dataset.write_rig(tmp_path / "rig", s4.case("E1"), BELIEVED, name="rig", duration=1.0))
    c, m = contact(), design()
    stated = {name: (p.value, p.sd) for name, p in rig.parameters.items()}
    assert stated["cable_stiffness"] == pytest.approx((4e4, 1.2e4))
    assert stated["pretension"] == pytest.approx((40.0, 4.0))
    assert stated["friction_coefficient"] == pytest.approx((0.15, 0.03))
    assert stated["static_friction_coefficient"] == pytest.approx((0.15 * c.mu_s / c.mu_c, 0.0))
    assert stated["contact_viscous"] == pytest.approx((c.sigma_2, 0.3 * c.sigma_2))
    assert (stated["pulley_radius"], stated["inertia"]) == ((m.r, 0.0), (m.J, 0.0))
    assert "contact:asymmetry" not in rig.nominal_effects
    assert [(e.name, e.split, e.repeat) for e in rig.experiments][:3] == [
        ("slow", "train", None), ("printed-a", "train", "A"), ("printed-b", "train", "A"),
    ]  # fmt: skip
    assert [e.split for e in rig.experiments] == ["train"] * 4 + ["test"] * 2
    assert all(e.initial == {"joint_angle": 0.0, "joint_velocity": 0.0} for e in rig.experiments)
    assert [(round(np.rad2deg(d.amplitude), 6), round(2 * np.pi / d.omega, 6)) for d in exact] == [
        (10.0, 6.0), (10.0, 4.0), (6.0, 3.0), (8.0, 5.0), (9.0, 3.5),
    ]  # fmt: skip


def test_the_sensors_round_and_scatter_at_100_hz(tmp_path: Path, exact: list[Any]) -> None:
    """Repeats differ by their noise alone; angles by less than three resolutions, tensions by the noise of a sensor."""
    rig = tl.load(dataset.write_rig(tmp_path / "rig", s4.case("E1"), BELIEVED, name="rig", duration=1.0))
    first, second = (rig[name].data for name in ("printed-a", "printed-b"))
    assert np.diff(first.index.to_numpy()) == pytest.approx(0.01)
    angle = np.deg2rad(10.0) * np.sin(2 * np.pi / 4.0 * first.index.to_numpy())
    assert first["driver_angle"].to_numpy() == pytest.approx(angle, abs=3 * RESOLUTION)
    assert first["joint_angle"].to_numpy() == pytest.approx(1.1 * angle, abs=3 * RESOLUTION)
    steps = first["driver_angle"].to_numpy() / RESOLUTION
    assert steps == pytest.approx(np.round(steps), abs=1e-3)
    for name in TENSIONS:
        column = f"tension_{name[1:]}"
        assert float(first[column].mean()) == pytest.approx(float(name[1:]), abs=5 * s4.rig.NOISE / 10)
    assert 0.0 < np.abs(first - second).to_numpy().max() < 8 * s4.rig.NOISE


def test_who_reads_the_joint_needs_no_inertia_and_who_knows_the_direction_has_its_effect(
    tmp_path: Path, exact: list[Any]
) -> None:
    """The difference of both coefficients over their sum."""
    knows, found = replace(BELIEVED, knows_direction=True), identified()
    folder = dataset.write_rig(
        tmp_path / "rig", s4.case("E1"), knows, name="rig", system="ccsrm_tensions", duration=1.0
    )
    rig = tl.load(folder)
    assert "inertia" not in rig.parameters
    assert "contact:asymmetry" in rig.nominal_effects
    stated = rig.parameters["contact_coefficient_asymmetry"]
    expected = (found.mu_plus - found.mu_minus) / (found.mu_plus + found.mu_minus)
    assert (stated.value, stated.sd) == pytest.approx((expected, 0.03))
    assert all(not e.initial for e in rig.experiments)
    with pytest.raises(ParameterError, match="system = 'rigid_joint'"):
        dataset.write_rig(tmp_path / "other", s4.case("E1"), knows, name="rig", system="rigid_joint")


def test_nominal_friction_is_the_mean_of_both_directions() -> None:
    found, believed = identified(), s4.nominal(knows_direction=True)
    assert (believed.k, believed.mu) == (found.k, pytest.approx(0.5 * (found.mu_plus + found.mu_minus)))
    assert (believed.knows_direction, believed.T_p) == (True, 50.0)
    soft = s4.softer(s4.case("E2"), k=3e4)
    assert (soft.k, soft.ends) == (3e4, None)


def test_a_reading_is_denoised_cut_and_compared_once_the_bristles_have_run_in(monkeypatch: pytest.MonkeyPatch) -> None:
    """Means of five samples: the first one of 1.00 to 1.04 s, the first one that is compared after 1.1 s."""
    seen: dict[str, Any] = {}
    monkeypatch.setattr(rounding, "wavelet_denoise", lambda values, level: values + 10.0 * level)
    monkeypatch.setattr(rounding, "fit_tensions", lambda read, start, **given: seen.update(read=read, **given))
    time = np.round(np.arange(0.0, 2.0, 0.01), 9)
    names = (*rounding.ANGLES, *TENSIONS)
    read = pd.DataFrame(dict.fromkeys(names, time), index=pd.Index(time, name="t"))
    start: Any = None
    rounding.Treatment(start=start, free=("pretension",), since=1.0).fit(read)
    left = seen["read"]
    assert left.index.to_numpy() == pytest.approx(1.02 + 0.05 * np.arange(20))
    assert left[next(iter(rounding.ANGLES))].to_numpy() == pytest.approx(left.index.to_numpy() + 10.0 * rounding.LEVEL)
    hidden = left[list(TENSIONS)].isna()
    assert hidden.sum().tolist() == [2] * 6
    compared = left[TENSIONS[0]].dropna()
    assert compared.to_numpy() == pytest.approx(compared.index.to_numpy())
    assert compared.index[0] == pytest.approx(1.12)
    assert seen["noise"] == pytest.approx(s4.rig.NOISE / np.sqrt(5.0))
    assert not read.isna().any().any()


def test_replicates_give_the_bias_and_its_spread(monkeypatch: pytest.MonkeyPatch) -> None:
    """Fitted 5.0; four replicates of it are 5.4 on average with an sd of 0.2: the value is 4.6."""
    replicates = 5.4 + 0.2 * np.array([-1.0, 1.0, -1.0, 1.0]) * np.sqrt(3.0 / 4.0)
    system = SimpleNamespace(effects=(), parameters={"pretension": 5.0})
    table = pd.DataFrame({"value": [5.0], "unit": ["N"]}, index=["pretension"])
    fits = [SimpleNamespace(system=system, parameters=table, values={"pretension": 5.0})]
    fits += [SimpleNamespace(values={"pretension": value}) for value in replicates]
    monkeypatch.setattr(rounding.Treatment, "fit", lambda *_: fits.pop(0))
    monkeypatch.setattr(rounding, "System", lambda **given: given)
    monkeypatch.setattr(rounding, "simulate", lambda *_: None)
    monkeypatch.setattr(rounding, "measured", lambda *_, **__: None)
    drive: Any = None
    read = pd.DataFrame(index=pd.Index([0.0, 1.0], name="t"))
    found = rounding.fit_rounded(read, drive, free=("pretension",), drive=drive, inertia=1.0, num_replicates=4)
    row = found.loc["pretension"]
    assert (row["fitted"], row["bias"], row["value"], row["unit"]) == (5.0, pytest.approx(0.4), pytest.approx(4.6), "N")
    assert row["sd"] == pytest.approx(0.2 * np.sqrt(1.25))
    reach = stats.t.ppf(0.975, 3) * row["sd"]
    assert (row["ci95_lower"], row["ci95_upper"]) == pytest.approx((4.6 - reach, 4.6 + reach))
