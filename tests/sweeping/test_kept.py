"""What is kept of the runs: several experiments, some outputs, a summary, less precision."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from typing import Any

import numpy as np
import pytest
from sweeps import SIM, TABLE, TIME, extremes, pushed

import tendonlab as tl
from tendonlab.sweeping import chunk
from tendonlab.sweeping.fingerprint import function_text

PROCESSES = ProcessPoolExecutor(1)  # no task is sent to it: it starts no process
WEIGHTS = np.array([1.0, 2.0])
LONG, SHORT = pushed(), pushed(TIME[:77], amplitude=0.6)


def message(runs: np.ndarray) -> np.ndarray:
    return runs


def swept(**given: Any) -> Any:
    return tl.sweep(SIM, TABLE, **{"experiment": LONG, "progress": False, **given})


def test_several_experiments_come_in_front() -> None:
    runs = [tl.Experiment(name=name, data=pushed(amplitude=a)) for name, a in (("weak", 0.3), ("strong", 0.6))]
    both = swept(experiment=runs)
    assert both["joint_angle"].dims == ("experiment", "point", "t")
    for run in runs:
        alone = swept(experiment=run)
        np.testing.assert_array_equal(both["joint_angle"].sel(experiment=run.name), alone["joint_angle"])


def test_a_dataset_gives_all_its_experiments() -> None:
    rig = tl.load(tl.__path__[0] + "/bundled/two_inertia")
    runs = tl.sweep(rig.system(), {"joint_coulomb": [0.05]}, experiment=rig, reduce="final", progress=False)
    assert runs["experiment"].to_numpy().tolist() == [experiment.name for experiment in rig]
    last = rig.system().with_parameters({"joint_coulomb": 0.05}).simulate(rig["run-08"])["joint_angle"].iloc[-1]
    found = runs["joint_angle"].sel(experiment="run-08").item()
    assert found == pytest.approx(last, rel=1e-6)  # lanes round in another way than a simulation alone


def test_runs_of_unequal_length_end_in_nan() -> None:
    both = swept(experiment=[LONG, SHORT])
    assert both["joint_angle"].dims == ("experiment", "point", "sample")
    np.testing.assert_array_equal(both["t"].isel(experiment=0), TIME)
    np.testing.assert_array_equal(both["t"].isel(experiment=1, sample=slice(77)), TIME[:77])
    assert np.isnan(both["t"].isel(experiment=1, sample=slice(77, None))).all()
    for k, given in enumerate((LONG, SHORT)):
        alone = swept(experiment=given)["joint_angle"]
        own = both["joint_angle"].isel(experiment=k)
        np.testing.assert_array_equal(own.isel(sample=slice(len(given))), alone)
        assert np.isnan(own.isel(sample=slice(len(given), None))).all()


def test_summaries_are_those_of_the_whole_runs() -> None:
    whole = swept(experiment=[LONG, SHORT])
    by_hand = {
        "rms": np.sqrt((whole**2).mean("sample")), "mean": whole.mean("sample"), "min": whole.min("sample"),
        "max": whole.max("sample"), "peak": np.abs(whole).max("sample"),
    }  # fmt: skip
    for name, expected in by_hand.items():
        got = swept(experiment=[LONG, SHORT], reduce=name)
        assert got["joint_angle"].attrs == {"unit": "rad", "reduce": name}
        for output in ("joint_angle", "joint_velocity"):
            np.testing.assert_allclose(got[output], expected[output], rtol=1e-13)  # another order of the same sum
    final = swept(reduce="final")
    np.testing.assert_array_equal(final["joint_angle"], swept()["joint_angle"].isel(t=-1))


def test_a_function_of_the_caller_is_a_summary_in_any_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    given = swept(reduce=extremes)
    assert given["extremes"].dims == ("point", "extremes_0")
    np.testing.assert_array_equal(given["extremes"].isel(extremes_0=1), swept(reduce="max")["joint_angle"])
    monkeypatch.setattr(chunk, "BLOCK_BYTES", 1.0)  # a point at a time
    assert given.identical(swept(reduce=extremes))


def test_functions_that_differ_in_what_they_hold_have_texts_of_their_own() -> None:
    def scaled(factor: float, weights: np.ndarray = WEIGHTS) -> Callable[[np.ndarray], np.ndarray]:
        return lambda c, gain=factor: factor * gain * weights * c

    again = [function_text(scaled(3.0)) for _ in range(2)]
    assert again[0] == again[1]
    others = [scaled(5.0), scaled(3.0, 2.0 * WEIGHTS), partial(scaled, 3.0), partial(scaled, 5.0), scaled]
    assert len({again[0], *map(function_text, others)}) == 1 + len(others)


def test_outputs_and_precision_are_those_asked_for() -> None:
    whole, some = swept(), swept(outputs=["joint_velocity"], dtype="float32")
    assert list(some.data_vars) == ["joint_velocity"]
    assert some["joint_velocity"].dtype == np.float32
    np.testing.assert_array_equal(some["joint_velocity"], whole["joint_velocity"].astype(np.float32))
    rms = swept(outputs=["joint_velocity"], dtype="float32", reduce="rms")
    np.testing.assert_array_equal(rms["joint_velocity"], swept(reduce="rms")["joint_velocity"].astype(np.float32))


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"reduce": "kurtosis"}, "reduce = 'kurtosis': expected one of rms, mean"),
        ({"reduce": 3}, "reduce = 3: expected one of rms, .*, or a function"),
        (
            {"reduce": lambda c: c[0]},
            r"reduce = reduced: gave shape \(2, 200\) of float64 for 1 points; expected .* \(1,",
        ),
        ({"reduce": message}, "reduce = message: the result has a coordinate of that name"),
        (
            {"reduce": lambda c: c, "executor": PROCESSES},
            "reduce = reduced: .*; expected a function defined",
        ),
        ({"outputs": ["joint_angl"]}, r"outputs\[0\] = 'joint_angl': did you mean 'joint_angle'"),
        ({"outputs": "joint_angle"}, "outputs = 'joint_angle': expected a list of names"),
        ({"outputs": []}, r"outputs = \[\]: expected a list of names"),
        ({"outputs": ["joint_angle"] * 2}, "expected each name once"),
        ({"dtype": "float16"}, "dtype = 'float16': did you mean 'float"),
        ({"experiment": []}, "experiment holds none: expected at least one"),
        ({"experiment": [tl.Experiment(name="a", data=LONG)] * 2}, "experiment: duplicate name 'a'"),
        ({"executor": 4}, "executor is of type int: expected a concurrent.futures executor, a dask"),
        ({"tolerance": 1.0}, r"tolerance = 1.0: expected a value in"),
        ({"out": "runs.csv"}, r"out = 'runs.csv': expected a name that ends in .zarr or .parquet"),
        ({"out": "nowhere/runs.zarr"}, "out = 'nowhere/runs.zarr': no folder 'nowhere'; expected an existing one"),
    ],
)
def test_what_means_nothing_is_refused(given: dict[str, Any], told: str) -> None:
    with pytest.raises(tl.ParameterError, match=told):
        swept(**given)
