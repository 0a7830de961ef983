"""Tables and designs: each row is the simulation with its parameters, and a bad row is named."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from sweeps import SIM, TABLE, TIME, assert_is_simulation, pushed

import tendonlab as tl
from tendonlab.sweeping import latin_hypercube, sobol

BOX = {"coulomb": (0.0, 0.1), "inertia": (0.01, 0.03)}


def assert_rows_are_simulations(system: tl.System, table: pd.DataFrame, experiment: Any) -> None:
    swept = tl.sweep(system, table, experiment=experiment, progress=False)
    for k, row in enumerate(table.to_dict(orient="records")):
        alone = system.with_parameters({str(name): value for name, value in row.items()}).simulate(experiment)
        for name in alone.outputs:
            assert_is_simulation(swept[name].isel(point=k).to_numpy(), alone[name])


def test_each_row_of_a_table_is_the_simulation_with_its_parameters() -> None:
    """The second row switches friction off by an amplitude of exactly 0."""
    assert_rows_are_simulations(SIM, TABLE, pushed())


def test_a_table_runs_along_points_and_keeps_its_columns() -> None:
    swept = tl.sweep(SIM, TABLE.set_index(pd.Index([7, 8, 9, 7])), experiment=pushed(), progress=False)
    assert dict(swept.sizes) == {"point": 4, "t": len(TIME)}
    assert swept["point"].to_numpy().tolist() == [0, 1, 2, 3]
    np.testing.assert_array_equal(swept["coulomb"], TABLE["coulomb"])
    assert swept["coulomb"].dims == ("point",)
    assert swept["coulomb"].attrs["unit"] == "N*m"


@pytest.mark.parametrize("measured", ["motor_angle", "joint_angle"])
def test_starts_follow_the_parameters_of_each_row(measured: str) -> None:
    """One angle was measured, the other one starts where a rigid transmission of that ratio puts it."""
    rig = tl.load(tl.__path__[0] + "/bundled/two_inertia")
    run = rig["run-08"]
    data = run.data.drop(columns={"motor_angle", "joint_angle"} - {measured}).iloc[:100]
    data[measured] += 0.5
    given = replace(run, data=data, conditions={}, initial={})
    system = replace(rig.system(), controller=None)
    ratio = next(name for name in ("cable_ratio", "gear_ratio", "ratio") if name in system.parameters)
    table = pd.DataFrame({ratio: system.parameters[ratio] * np.array([0.8, 1.0, 1.3])})
    assert_rows_are_simulations(system, table, given)
    swept = tl.sweep(system, table, experiment=given, progress=False)
    other = ({"motor_angle", "joint_angle"} - {measured}).pop()
    assert len(np.unique(swept[other].isel(t=0))) == 3  # otherwise the test shows nothing


def test_additions_of_an_experiment_add_to_every_row() -> None:
    loaded = tl.Experiment(name="loaded", data=pushed(), add={"inertia": 0.005}, conditions={"viscous": 0.06})
    assert_rows_are_simulations(SIM, TABLE, loaded)


@pytest.mark.parametrize(
    ("table", "told"),
    [
        (TABLE.assign(coulomb=[0.1, 0.1, -0.2, 0.1]), r"row 2: coulomb = -0.2: expected a value in \[0, inf\) N\*m"),
        (TABLE.assign(coulomb=[0.1, np.nan, 0.1, 0.1]), r"row 1: coulomb = nan: expected a value in"),
        (TABLE.rename(columns={"coulomb": "coulom"}), "coulom = 0.02: no parameter of .* did you mean 'coulomb'"),
        (TABLE.assign(inertia="heavy"), "column 'inertia' is of type .*; expected numbers"),
        (TABLE.iloc[:0], r"grid has shape \(0, 2\): expected a table"),
        (pd.concat([TABLE, TABLE], axis=1), "duplicate column 'coulomb'"),
    ],
)
def test_a_table_that_means_nothing_is_refused(table: pd.DataFrame, told: str) -> None:
    with pytest.raises(tl.ParameterError, match=told):
        tl.sweep(SIM, table, experiment=pushed(), progress=False)


def test_an_addition_that_leaves_the_bounds_is_named() -> None:
    lighter = tl.Experiment(name="lighter", data=pushed(), add={"inertia": -0.5})
    with pytest.raises(tl.ParameterError, match=r"row 0: inertia with -0.5 in lighter = -0.49: expected a value in"):
        tl.sweep(SIM, TABLE, experiment=lighter, progress=False)


@pytest.mark.parametrize("design", [sobol, latin_hypercube])
def test_a_design_fills_its_box_evenly_and_repeats(design: Any) -> None:
    points = design(BOX, num_points=64, seed=3)
    assert list(points.columns) == ["coulomb", "inertia"]
    for name, (lower, upper) in BOX.items():
        share = (points[name] - lower) / (upper - lower)
        assert sorted((share * 64).astype(int)) == list(range(64))  # one in each of 64 parts, of both designs
    assert points.equals(design(BOX, num_points=64, seed=3))
    assert not points.equals(design(BOX, num_points=64, seed=4))


@pytest.mark.parametrize(
    ("ask", "told"),
    [
        (lambda: sobol(BOX, num_points=100), "num_points = 100: expected a power of 2, such as 64 or 128"),
        (lambda: latin_hypercube(BOX, num_points=0), "num_points = 0: expected a whole number of at least 1"),
        (lambda: sobol({"coulomb": (0.1, 0.0)}, num_points=8), r"bounds of coulomb = \(0.1, 0.0\): expected \(lower,"),
        (lambda: latin_hypercube({}, num_points=8), r"bounds = {}: expected {parameter: \(lower, upper\)}"),
        (lambda: latin_hypercube(BOX, num_points=8, seed=-1), "seed = -1: expected a whole number"),
    ],
)
def test_a_design_that_means_nothing_is_refused(ask: Any, told: str) -> None:
    with pytest.raises(tl.ParameterError, match=told):
        ask()
