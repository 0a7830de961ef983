"""A store on disk holds the same bits as memory, and a call that was cut short goes on where it ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from sweeps import SIM, TIME, extremes, many, pushed

import tendonlab as tl
from interrupting import small_tasks_and_ctrl_c
from tendonlab import _core

FORMATS = ("runs.zarr", "runs.parquet")


def swept(out: Path | None = None, **given: Any) -> xr.Dataset:
    return tl.sweep(SIM, many(50), **{"experiment": pushed(), "out": out, "progress": False, **given})


def count_simulated(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Points that the core simulates from now on, call by call."""
    counts: list[int] = []
    plain = _core.simulate_many

    def simulate_many(kind: str, values: np.ndarray, *given: Any) -> list[str]:
        counts.append(len(values))
        return plain(kind, values, *given)

    monkeypatch.setattr(_core, "simulate_many", simulate_many)
    return counts


@pytest.mark.parametrize("name", FORMATS)
@pytest.mark.parametrize(
    "given",
    [
        {},
        {"reduce": "rms", "dtype": "float32"},
        {"reduce": extremes},
        {"experiment": [pushed(), pushed(TIME[:77])]},
    ],
)
def test_a_store_holds_what_memory_would(
    name: str, given: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stored, kept = swept(tmp_path / name, **given), swept(**given)
    assert all(hasattr(values.data, "dask") for values in stored.data_vars.values())  # nothing was read so far
    assert stored.compute().identical(kept)
    counts = count_simulated(monkeypatch)
    assert swept(tmp_path / name, **given).compute().identical(kept)
    assert counts == []


@pytest.mark.parametrize("name", FORMATS)
def test_a_grid_in_a_store_has_the_dimensions_of_the_grid(name: str, tmp_path: Path) -> None:
    grid = {"coulomb": [0.02, 0.05, 0.1], "viscous": np.array([0.01, 0.02])}
    given = {"experiment": pushed(), "progress": False}
    assert tl.sweep(SIM, grid, out=tmp_path / name, **given).compute().identical(tl.sweep(SIM, grid, **given))


@pytest.mark.parametrize("name", FORMATS)
def test_a_file_in_place_of_a_store_is_refused_before_anything_is_simulated(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / name).write_text("mine", encoding="utf-8")
    counts = count_simulated(monkeypatch)
    with pytest.raises(tl.ParameterError, match=f"{name}' is a file: expected a new name, or the store of this sweep"):
        swept(tmp_path / name)
    assert counts == []


def test_other_programs_read_the_stores(tmp_path: Path) -> None:
    kept = swept(tmp_path / "runs.zarr", outputs=["joint_angle"])
    swept(tmp_path / "runs.parquet", outputs=["joint_angle"])
    with xr.open_zarr(tmp_path / "runs.zarr", consolidated=False) as opened:
        np.testing.assert_array_equal(opened["joint_angle"].isel(experiment=0), kept["joint_angle"])
        np.testing.assert_array_equal(opened["coulomb"], kept["coulomb"])
        np.testing.assert_array_equal(opened["t"], TIME)
        assert opened["joint_angle"].attrs == {"unit": "rad"}
    table = pd.read_parquet(tmp_path / "runs.parquet").sort_values("point", ignore_index=True)
    np.testing.assert_array_equal(np.stack(table["joint_angle"].tolist()), kept["joint_angle"])
    np.testing.assert_array_equal(table["coulomb"], kept["coulomb"])


@pytest.mark.parametrize("name", FORMATS)
def test_a_store_of_another_sweep_is_refused(name: str, tmp_path: Path) -> None:
    swept(tmp_path / name)
    changes: list[tuple[dict[str, Any], str]] = [
        ({"reduce": "max"}, "settings"),
        ({"tolerance": 1e-7}, "settings"),
        ({"dtype": "float32"}, "settings"),
        ({"experiment": pushed(amplitude=0.5)}, "experiment"),
        ({"experiment": pushed(amplitude=0.5), "reduce": extremes}, "experiment and settings"),
    ]
    for change, part in changes:
        told = rf"{name}: belongs to another sweep \(it differs in {part}\); expected the same call, or a new name"
        with pytest.raises(tl.DatasetError, match=told):
            swept(tmp_path / name, **change)


def test_a_store_of_other_points_or_another_system_or_version_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, given = tmp_path / "runs.zarr", {"experiment": pushed(), "progress": False}
    swept(out)
    with pytest.raises(tl.DatasetError, match=r"\(it differs in points\)"):
        tl.sweep(SIM, many(49), out=out, **given)
    with pytest.raises(tl.DatasetError, match=r"\(it differs in system\)"):
        tl.sweep(SIM.with_parameters({"inertia": 0.03}), many(50), out=out, **given)
    monkeypatch.setattr("tendonlab.sweeping.fingerprint.version", lambda: "9.9")
    with pytest.raises(tl.DatasetError, match=r"\(it differs in package version\)"):
        swept(out)


@pytest.mark.parametrize("name", FORMATS)
def test_what_is_no_store_is_left_alone(name: str, tmp_path: Path) -> None:
    (tmp_path / name).mkdir()
    (tmp_path / name / "mine.txt").write_text("mine")
    with pytest.raises(tl.DatasetError, match=f"{name}: no store of a sweep; expected a new name"):
        swept(tmp_path / name)
    assert (tmp_path / name / "mine.txt").read_text() == "mine"


@pytest.mark.parametrize("name", FORMATS)
def test_ctrl_c_keeps_what_was_stored_and_the_same_call_goes_on(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Chunks of a point; Ctrl-C arrives while the 21st run is being noted."""
    whole = swept()
    with small_tasks_and_ctrl_c(monkeypatch, after=20):
        part = swept(tmp_path / name).compute()
    done = (part["message"] == "").to_numpy()
    assert 20 <= done.sum() < 50
    assert set(part["message"].to_numpy()[~done]) == {"interrupted"}
    assert np.isnan(part["joint_angle"][~done]).all()
    np.testing.assert_array_equal(part["joint_angle"][done], whole["joint_angle"][done])
    counts = count_simulated(monkeypatch)
    assert swept(tmp_path / name).compute().identical(whole)
    assert sum(counts) == 50 - done.sum()


@pytest.mark.parametrize("name", FORMATS)
def test_points_that_failed_keep_their_reason(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plain = _core.simulate_many

    def simulate_many(kind: str, values: np.ndarray, *given: Any) -> list[str]:
        messages = plain(kind, values, *given)
        given[-1][-1] = np.nan
        return [*messages[:-1], "joint_angle is not finite from t = 0.1 s"]

    with monkeypatch.context() as broken:
        broken.setattr(_core, "simulate_many", simulate_many)
        first = swept(tmp_path / name, reduce="rms").compute()
    failed = (first["message"] != "").to_numpy()
    assert set(first["message"].to_numpy()[failed]) == {"joint_angle is not finite from t = 0.1 s"}
    assert np.isnan(first["joint_angle"][failed]).all()
    assert swept(tmp_path / name, reduce="rms").compute().identical(first)  # tried once, and that is known


RUNS = 40_000
SCRIPT = f"""
import sys; sys.path.insert(0, {str(Path(__file__).parent)!r})
import tendonlab as tl
from sweeps import SIM, many, pushed
tl.sweep(SIM, many({RUNS}), experiment=pushed(), reduce="rms", out=sys.argv[1], progress=False)
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", FORMATS)
def test_a_killed_process_leaves_a_store_that_goes_on(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, table, given = tmp_path / name, many(RUNS), {"experiment": pushed(), "reduce": "rms", "progress": False}
    process = subprocess.Popen([sys.executable, "-c", SCRIPT, str(out)])
    chunks = "joint_angle/c/0/*" if name.endswith(".zarr") else "experiment-*.parquet"
    while len(list(out.glob(chunks))) < 3 and process.poll() is None:
        time.sleep(0.005)
    os.kill(process.pid, signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL  # in the middle of its work
    counts = count_simulated(monkeypatch)
    resumed = tl.sweep(SIM, table, out=out, **given).compute()
    assert 0 < sum(counts) < RUNS
    assert resumed.identical(tl.sweep(SIM, table, **given))
