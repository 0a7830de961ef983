"""friction_map as a system of the library: steady points from files without time, conditions, derivatives, fits."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.data import Experiment
from tendonlab.papers.s0 import bench, experiments, models, twin
from tendonlab.simulation import prepare as replay

NAMES = {
    "coulomb", "static_friction", "stribeck_velocity", "viscous", "load_exponent", "peak_exponent",
    "stribeck_exponent", "viscous_exponent",
}  # fmt: skip
TOML = """
format = "tendonlab-dataset/1"
name = "bench"
description = "steady points"
[system]
kind = "friction_map"
{nominal}
[system.parameters]
{parameters}
[signals.speed]
column = "w"
unit = "rad/s"
[signals.friction_torque]
column = "T"
unit = "N*m"
{experiments}
"""
EXPERIMENT = """[[experiments]]
name = "{name}"
file = "{name}.csv"
split = "{split}"
conditions = {{ relative_load = {load}, transmission_ratio = 4.16 }}
"""
LOADS = {"light": 1.0, "heavy": 3.7, "middle": 2.8}
VALUES = {"coulomb": 0.0036, "static_friction": 0.04, "stribeck_velocity": 24.8, "viscous": 9.8e-4}


def folder(path: Path, *, nominal: str = "", parameters: dict[str, float] | None = None) -> Path:
    """Points of the reconstructed load-and-ratio model at three loads, a row a point and no time."""
    model = models.reconstructed("C25P104GX")
    tables = ""
    for name, load in LOADS.items():
        torque = model.torque(twin.SPEEDS, load=load, ratio=4.16)
        pd.DataFrame({"w": twin.SPEEDS, "T": torque}).to_csv(path / f"{name}.csv", index=False)
        tables += EXPERIMENT.format(name=name, load=load, split="test" if name == "middle" else "train")
    rows = [f"{n} = {{ value = {v} }}" for n, v in (VALUES if parameters is None else parameters).items()]
    text = TOML.format(nominal=nominal, parameters="\n".join(rows), experiments=tables)
    (path / "dataset.toml").write_text(text, encoding="utf-8")
    return path


def test_its_names_are_the_contracts() -> None:
    info = tl.system_info("friction_map")
    assert [s.name for s in info.inputs] == ["speed"]
    assert [s.name for s in info.outputs] == ["friction_torque"]
    assert {p.name for p in info.parameters} >= NAMES | {"relative_load", "transmission_ratio"}
    assert len({p.name for p in info.parameters}) == len(info.parameters)
    ordinary = {"coulomb", "viscous", "stribeck", "load_dependence", "asymmetry"}
    assert {e.effect for e in info.effects if e.element == "contact"} >= ordinary | {"static_lugre", "load_and_ratio"}


def test_its_output_is_the_law() -> None:
    model, speed = models.reconstructed("C35P75GX"), np.linspace(-105.0, 105.0, 211)
    frame = pd.DataFrame({"speed": speed}, index=pd.Index(np.arange(211.0), name="t"))
    system = experiments.proposed_system(model, ratio=15 / 7)
    for load in (1.0, 4.27):
        found = system.with_parameters({"relative_load": load}).simulate(frame)["friction_torque"]
        assert found.to_numpy() == pytest.approx(model.torque(speed, load=load, ratio=15 / 7), rel=1e-13, abs=1e-300)


def test_points_need_no_time_and_conditions_hold(tmp_path: Path) -> None:
    rig = tl.load(folder(tmp_path))
    assert rig["heavy"].conditions["relative_load"] == 3.7
    assert not [told for told in rig.warnings if "relative_load" in told or "transmission_ratio" in told]
    exact = (
        rig.system()
        .with_parameters(
            {
                "load_exponent": 0.351689,
                "peak_exponent": 0.728021,
                "stribeck_exponent": 6.89443,
                "viscous_exponent": 0.916131,
            }
        )
        .with_parameters(
            {"coulomb": 0.00360985, "static_friction": 0.0398843, "stribeck_velocity": 24.7818, "viscous": 0.000976735}
        )
    )
    for experiment in rig:
        found = exact.simulate(experiment)["friction_torque"]
        assert found.to_numpy() == pytest.approx(experiment.data["friction_torque"].to_numpy(), rel=1e-12)


def test_a_simulator_without_load_takes_the_same_conditions(tmp_path: Path) -> None:
    """transmission_ratio belongs to the load-and-ratio law; beside another simulator it is a covariate."""
    path = folder(
        tmp_path,
        nominal='nominal_effects = ["contact:static_lugre", "contact:viscous"]',
        parameters=experiments.lugre_system(models.printed_lugre("C25P104GX")).parameters | {"contact_viscous": 7e-4},
    )
    rig = tl.load(path)
    light, heavy = (rig.system().simulate(rig[name])["friction_torque"] for name in ("light", "heavy"))
    assert light.to_numpy() == pytest.approx(heavy.to_numpy(), rel=1e-15)


def test_identify_finds_the_load_and_ratio_model_and_predicts_a_load_between(tmp_path: Path) -> None:
    """Eight parameters by exact derivatives, from typical exponents."""
    rig = tl.load(folder(tmp_path))
    found = tl.identify(rig, num_starts=4, progress=False)
    middle = rig["middle"]
    error = found.system.simulate(middle)["friction_torque"] - middle.data["friction_torque"]
    assert np.sqrt(np.mean(error**2)) < 1e-3
    assert set(found.values) == NAMES


def test_derivatives_are_finite_at_rest_and_in_the_fastest_run() -> None:
    """Powers of a speed of 0 with exponents below 1: no NaN, and those of the exponents vanish there."""
    system = experiments.proposed_system(models.reconstructed("C25P104GX"), ratio=4.16)
    frame = pd.DataFrame({"speed": [0.0, 1e-300, -1e-12, 1.0, -105.0]}, index=pd.Index(np.arange(5.0), name="t"))
    names = [p.name for p in system.info.parameters]
    seeds = [("parameter", names.index(n)) for n in [*sorted(NAMES), "relative_load", "transmission_ratio"]]
    ready = replay.prepare(Experiment(name="points", data=frame), system, replay.Replay("free"))
    run = _core.simulate(system.kind, system.values(), system.active(), ready.core, seeds, _core.Settings())
    assert np.all(np.isfinite(run["gradient"]))
    assert np.all(run["gradient"][:, 0, 0] == 0.0)
    assert np.all(run["gradient"][:, 0, 4] != 0.0)


def test_a_load_that_is_not_positive_is_refused() -> None:
    system = experiments.proposed_system(models.reconstructed("C35P75GX"), ratio=15 / 7)
    with pytest.raises(tl.ParameterError, match=r"relative_load = 0.0: expected a value in"):
        system.with_parameters({"relative_load": 0.0})


def test_curves_are_no_candidates_beside_one_another() -> None:
    """A whole curve is a simulator's choice: the diagnosis looks for terms that it lacks."""
    from tendonlab.simulation.catalog import WHOLE

    whole = {e.name for e in tl.system_info("friction_map").effects if e.roles & WHOLE}
    assert whole == {"contact:static_lugre", "contact:load_and_ratio"}


def test_configurations_are_those_of_table_3() -> None:
    names = bench.configurations()
    assert len(names) == 12
    assert all(bench.configuration(name).name == name for name in names)
    assert bench.configuration("C25P104GX").ratio() == pytest.approx(4.16)
    assert bench.configuration("C25P104GX").ratio(cable_diameter=True) == pytest.approx(3.971, abs=5e-4)
    assert bench.configuration("C35P75GX").ratio(cable_diameter=True) == pytest.approx(2.093, abs=5e-4)
    with pytest.raises(tl.ParameterError, match="did you mean 'C25P104GX'"):
        bench.configuration("C25P104G")
