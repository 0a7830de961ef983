"""Preparing a public recording: where its files are looked for, that they are verified, and what comes out."""

import os
from pathlib import Path

import numpy as np
import pytest
import scipy.io

from tendonlab.data import load
from tendonlab.data.bam import write_bam
from tendonlab.data.datasets import list_datasets, prepare
from tendonlab.data.emps import write_emps
from tendonlab.errors import DatasetError

FILES = ("DATA_EMPS.mat", "DATA_EMPS_PULSES.mat")


@pytest.fixture
def nowhere(tmp_path, monkeypatch):
    """No recordings in the environment, an empty cache, and a registry of files that is empty as yet."""
    monkeypatch.delenv("TENDONLAB_DATA", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    registry = tmp_path / "registry" / "emps"
    registry.mkdir(parents=True)
    monkeypatch.setenv("TENDONLAB_REGISTRY", (tmp_path / "registry").as_uri())
    return registry


@pytest.fixture
def recorded():
    folder = Path(os.environ.get("TENDONLAB_DATA", "")) / "emps"
    if not (folder / FILES[0]).is_file():
        pytest.skip("the EMPS recordings are not there: TENDONLAB_DATA names no folder with emps/DATA_EMPS.mat")
    return folder


def test_what_there_is():
    emps = list_datasets()["emps"]
    assert [file.name for file in emps.files] == list(FILES)
    assert "Janot" in emps.citation
    with pytest.raises(DatasetError, match="'emp' is no public dataset; did you mean 'emps'"):
        prepare("emp")


def test_emps_is_a_dataset_in_the_units_of_the_rig(recorded, tmp_path):
    """Sizes, gains and units are those of the benchmark's own description."""
    dataset = load(prepare("emps", out=tmp_path / "rig"))
    assert [e.name for e in dataset.train] == ["estimation"]
    assert [e.name for e in dataset.test] == ["pulses"]
    assert (dataset.kind, dataset.axis) == ("rigid_joint", "linear")
    assert (dataset.controller.kp, dataset.controller.kd, dataset.controller.limit) == (160.18, 243.45, 10.0)
    assert dataset.parameters["torque_constant"].value == pytest.approx(35.1507, abs=5e-5)
    assert dataset.parameters["torque_constant"].sd == 0.0
    assert not dataset.signals[dataset.controller.reference].hold
    assert dataset.signals[dataset.controller.disturbance].hold
    assert dataset.warnings == ()
    for experiment, levels in ((dataset["estimation"], {0.0}), (dataset["pulses"], {0.0, 5.0})):
        assert len(experiment.data) == 24841
        assert experiment.duration == pytest.approx(24.84)
        assert set(experiment.data[dataset.controller.disturbance]) == levels
    raw = scipy.io.loadmat(recorded / FILES[1])
    np.testing.assert_array_equal(dataset["pulses"].data["joint_angle"], raw["qm"][:, 0])


def test_emps_pulses_are_volts_added_to_the_declared_controller(recorded, tmp_path):
    """What the command holds beyond kv (kp (qg - qm) - dqm/dt) is 5 V while a pulse is on, and nothing otherwise."""
    dataset = load(prepare("emps", out=tmp_path / "rig"))
    law = dataset.controller
    data = dataset["pulses"].data
    velocity = np.gradient(data[law.measured], data.index)
    beyond = data["motor_torque"] - law.kd * (law.kp * (data[law.reference] - data[law.measured]) - velocity)
    on = data[law.disturbance] == 5.0
    # the level was stored in 8 bits, in whole volts, so it is known to half a volt at best; it is 5.07 V here
    assert beyond[on].mean() == pytest.approx(5.0, abs=0.5)
    assert beyond[~on].mean() == pytest.approx(0.0, abs=0.01)


def test_preparing_again_changes_nothing_and_spares_an_edited_file(recorded, tmp_path):
    folder = prepare("emps", source=recorded, out=tmp_path / "rig")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert set(before) == {"dataset.toml", "estimation.csv", "pulses.csv"}
    prepare("emps", source=recorded.parent, out=folder)
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    toml = folder / "dataset.toml"
    toml.write_text(toml.read_text(encoding="utf-8").replace("200.0", "180.0"), encoding="utf-8")
    with pytest.raises(DatasetError, match=r"dataset.toml: is there and differs"):
        prepare("emps", source=recorded, out=folder)


def test_files_come_from_a_registry_and_then_from_the_cache(recorded, nowhere, tmp_path):
    for name in FILES:
        (nowhere / name).write_bytes((recorded / name).read_bytes())
    first = prepare("emps", out=tmp_path / "first", progress=False)
    for name in FILES:
        (nowhere / name).unlink()
    second = prepare("emps", out=tmp_path / "second", progress=False)
    for path in first.iterdir():
        assert path.read_bytes() == (second / path.name).read_bytes()


def test_a_corrupted_download_is_rejected(nowhere, tmp_path):
    for name in FILES:
        (nowhere / name).write_bytes(b"not what was published")
    with pytest.raises(DatasetError, match=r"DATA_EMPS.mat: not found .*hash"):
        prepare("emps", out=tmp_path / "rig", progress=False)
    assert not (tmp_path / "rig").exists()


def test_a_corrupted_local_file_is_rejected(nowhere, tmp_path):
    (tmp_path / FILES[0]).write_bytes(b"not what was published")
    with pytest.raises(DatasetError, match=r"DATA_EMPS.mat: sha256 [0-9a-f]{64}; expected 6cf6814a"):
        prepare("emps", source=tmp_path, out=tmp_path / "rig")


def test_missing_files_are_an_error_that_says_where_it_looked(nowhere, tmp_path):
    with pytest.raises(DatasetError) as caught:
        prepare("emps", source=tmp_path / "mine", out=tmp_path / "rig", progress=False)
    for place in ("mine/DATA_EMPS.mat", "mine/emps/DATA_EMPS.mat", "cache", "registry/emps/DATA_EMPS.mat"):
        assert place in str(caught.value)


def test_without_a_network_the_error_is_one_short_sentence(nowhere, tmp_path, monkeypatch):
    monkeypatch.setenv("TENDONLAB_REGISTRY", "http://localhost:1")  # nothing listens on that port
    with pytest.raises(
        DatasetError, match=r"failed: no connection to localhost:1; expected its folder as source"
    ) as of:
        prepare("emps", out=tmp_path / "rig", progress=False)
    assert "HTTPConnectionPool" not in str(of.value)


def _record(**changes):
    samples = np.arange(4.0)[:, None]
    gains = {"kp": 160.18, "kv": 243.45, "gtau": 35.0}
    return {"t": samples, "qg": samples, "qm": samples, "vir": samples} | gains | changes


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"gtau": 36.0}, r"gtau = \[35.0, 36.0\]; expected the same in every record"),
        ({"qm": np.zeros((2, 2))}, r"DATA_EMPS_PULSES.mat: no vector 'qm'"),
        ({"kp": np.zeros((2, 1))}, r"DATA_EMPS_PULSES.mat: 'kp' has 2 values; expected one"),
    ],
)
def test_records_that_are_not_the_published_ones(tmp_path, changes, message):
    for name, record in zip(FILES, (_record(), _record(**changes)), strict=True):
        scipy.io.savemat(tmp_path / name, record)
    with pytest.raises(DatasetError, match=message):
        write_emps({name: tmp_path / name for name in FILES}, tmp_path / "rig")


def test_eight_bit_pulses_become_signed_volts(tmp_path):
    """Subtracting from an unsigned byte would wrap: 0 - 5 = 251."""
    scipy.io.savemat(tmp_path / FILES[0], _record())
    scipy.io.savemat(tmp_path / FILES[1], _record(pulses_N=np.array([[0], [5], [5], [0]], dtype=np.uint8)))
    write_emps({name: tmp_path / name for name in FILES}, tmp_path / "rig")
    dataset = load(tmp_path / "rig")
    assert list(-dataset["pulses"].data["disturbance_voltage"]) == [0.0, -5.0, -5.0, 0.0]


def test_a_measured_servo_is_a_dataset_with_a_gain_for_each_record(measured_servo):
    """Three gains and four motions; the middle gain is held out."""
    dataset = load(measured_servo)
    gains = {e.name: e.conditions["proportional_gain"] for e in dataset.experiments}
    assert len(gains) == 12
    assert gains["sin_sin-100"] == pytest.approx(100 * 4096 / (2 * np.pi) / (256 * 885) * 7.3, rel=1e-5)
    assert {e.name.split("-")[1] for e in dataset.test} == {"400"}
    drop = dataset["lift_and_drop-800"].data
    assert drop["torque_enable"].iloc[0] == 1.0
    assert drop["torque_enable"].iloc[-1] == 0.0


def test_a_record_without_a_field_is_named(tmp_path):
    (tmp_path / "a.json").write_text('{"kp": 100, "dt": 0.005, "entries": []}', encoding="utf-8")
    with pytest.raises(DatasetError, match=r"a.json: no field 'trajectory'; expected the published record"):
        write_bam({"a.json": tmp_path / "a.json"}, tmp_path / "rig")
