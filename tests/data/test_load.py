"""What a valid dataset becomes: SI frames, filled inputs, defaults and splits. Expected numbers are worked by hand."""

import copy
import pickle
import shutil

import h5py
import numpy as np
import pandas as pd
import pytest
import scipy.io

from tendonlab.data import load
from tendonlab.data.split import choose_test
from tendonlab.errors import DatasetError


def test_tiny_dataset_is_read_as_written(draft, write):
    dataset = load(write(draft))
    assert (dataset.name, dataset.kind, dataset.axis) == ("tiny", "rigid_joint", "rotary")
    assert dataset.nominal_effects == ("joint:coulomb", "joint:viscous")
    assert (dataset.inputs, dataset.outputs) == (("motor_torque",), ("joint_angle", "joint_velocity"))
    assert [e.name for e in dataset.train] == ["one"]
    assert [e.name for e in dataset.test] == ["two"]
    inertia = dataset.parameters["inertia"]
    assert (inertia.value, inertia.sd) == (0.02, 0.001)
    assert dataset.parameters["coulomb"].sd is None
    assert dataset.controller is None
    assert dataset.warnings == ()
    frame = dataset["one"].data
    assert frame.index.name == "t"
    assert list(frame.columns) == ["motor_torque", "joint_angle", "joint_velocity"]
    assert all(dtype.kind == "f" for dtype in frame.dtypes)
    np.testing.assert_array_equal(frame["motor_torque"], draft.frames["one.csv"]["u"])
    assert dataset.signals["joint_velocity"].noise_sd == 0.001
    assert dataset["one"].duration == pytest.approx(0.19)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_of_a_dataset_equals_it(draft, write, copied):
    draft.frames["one.csv"].loc[4, "q"] = np.nan  # a missing sample equals another
    dataset = load(write(draft))
    other = copied(dataset)
    assert other is not dataset
    assert other == dataset
    assert other.system() == dataset.system()


def test_datasets_differ_where_a_sample_or_a_parameter_does(draft, write):
    folder = write(draft)
    dataset = load(folder)
    assert load(folder) == dataset
    assert dataset != folder
    draft.toml["system"]["parameters"]["inertia"]["value"] = 0.021
    assert load(write(draft)) != dataset
    draft.toml["system"]["parameters"]["inertia"]["value"] = 0.02
    draft.frames["two.csv"].loc[7, "q"] += 1e-9
    assert load(write(draft)) != dataset


def test_path_may_name_the_toml_or_be_text(draft, write):
    folder = write(draft)
    assert load(folder / "dataset.toml").path == load(str(folder)).path == folder


def test_unknown_experiment_offers_the_nearest(draft, write):
    with pytest.raises(DatasetError, match=r"tiny: no experiment 'won'; (did you mean 'two'|expected one of one, two)"):
        load(write(draft))["won"]


def test_units_become_si(draft, write):
    """1800 deg = 10 pi rad, 250 N cm = 2.5 N m, 60 rpm = 2 pi rad/s, 10 ms = 0.01 s, 25 degC = 298.15 K."""
    frame = draft.frames["one.csv"]
    frame["t"] *= 1000
    draft.frames["two.csv"]["t"] *= 1000
    frame["u"] = [250.0, -250.0] * 10
    frame["q"], frame["dq"], frame["T"] = 1800.0, 60.0, 25.0
    draft.toml["time"] = {"unit": "ms"}
    signals = draft.toml["signals"]
    signals["motor_torque"]["unit"] = "N*cm"
    signals["joint_angle"] |= {"unit": "deg", "resolution": 0.18}
    signals["joint_velocity"] |= {"unit": "rpm", "noise_sd": 30.0}
    signals["temperature"] = {"column": "T", "unit": "degC", "noise_sd": 0.5}
    dataset = load(write(draft))
    first = dataset["one"].data.iloc[0]
    assert first["motor_torque"] == pytest.approx(2.5)
    assert first["joint_angle"] == pytest.approx(10 * np.pi)
    assert first["joint_velocity"] == pytest.approx(2 * np.pi)
    assert first["temperature"] == pytest.approx(298.15)
    assert dataset["one"].time[1] == pytest.approx(0.01)
    assert dataset.signals["joint_angle"].resolution == pytest.approx(np.pi / 1000)
    assert dataset.signals["joint_velocity"].noise_sd == pytest.approx(np.pi)
    assert dataset.signals["temperature"].noise_sd == pytest.approx(0.5)  # a difference of temperatures has no offset
    assert dataset.signals["temperature"].role == "covariate"
    assert dataset.signals["joint_angle"].unit == "deg"


def test_linear_axis_takes_newtons_and_metres(draft, write):
    draft.toml["system"]["axis"] = "linear"
    units = {"motor_torque": "kN", "joint_angle": "mm", "joint_velocity": "mm/s"}
    for name, unit in units.items():
        draft.toml["signals"][name]["unit"] = unit
    frame = load(write(draft))["one"].data
    raw = draft.frames["one.csv"]
    np.testing.assert_allclose(frame["motor_torque"], raw["u"] * 1e3)
    np.testing.assert_allclose(frame["joint_angle"], raw["q"] * 1e-3)


@pytest.mark.parametrize(("unit", "kept", "si"), [("A", "A", 1.0), ("mV", "V", 1e-3), ("mA", "A", 1e-3), ("1", "1", 1)])
def test_command_with_a_torque_constant_is_in_ampere_or_volt(draft, write, unit, kept, si):
    """torque_constant carries N m per A, per V or per 1, whatever multiple of it the file has."""
    draft.toml["signals"]["motor_torque"]["unit"] = unit
    dataset = load(write(draft))
    expected = si * draft.frames["one.csv"]["u"]
    np.testing.assert_allclose(dataset["one"].data["motor_torque"], expected, rtol=1e-12)
    assert dataset.signals["motor_torque"].si_unit == kept


def test_unit_and_column_default_to_si_and_the_name(draft, write):
    draft.frames = {name: frame.rename(columns={"q": "joint_angle"}) for name, frame in draft.frames.items()}
    draft.toml["signals"]["joint_angle"] = {}
    spec = load(write(draft)).signals["joint_angle"]
    assert (spec.column, spec.unit, spec.si_unit) == ("joint_angle", "rad", "rad")


def test_commands_hold_and_what_is_measured_does_not(draft, write):
    draft.toml["controller"] = {
        "kind": "pd",
        "kp": 2.0,
        "measured": "joint_angle",
        "reference": "target",
        "disturbance": "push",
    }
    draft.toml["signals"] |= {"target": {"column": "q"}, "push": {"column": "u"}, "temperature": {"column": "T"}}
    dataset = load(write(draft))
    roles = {name: (spec.role, spec.hold) for name, spec in dataset.signals.items()}
    assert roles["motor_torque"] == ("input", True)
    assert roles["target"] == ("reference", True)
    assert roles["push"] == ("disturbance", True)
    assert roles["joint_angle"] == ("output", False)
    assert roles["temperature"] == ("covariate", False)
    assert (dataset.controller.kd, dataset.controller.limit, dataset.controller.sample_time) == (0.0, np.inf, 0.0)
    assert (dataset.controller.derivative_on, dataset.controller.disturbance) == ("error", "push")
    draft.toml["signals"]["target"]["hold"] = False
    assert not load(write(draft)).signals["target"].hold


def test_a_regulated_rig_may_be_excited_by_its_disturbance(draft, write):
    """With a known controller the command may be constant, and the reference too where the disturbance varies."""
    for frame in draft.frames.values():
        frame["target"], frame["push"], frame["u"] = 0.5, frame["u"], 0.0
    draft.toml["controller"] = {"kind": "pd", "kp": 2.0, "measured": "joint_angle", "reference": "target"}
    draft.toml["controller"]["disturbance"] = "push"
    draft.toml["signals"] |= {"target": {}, "push": {}}
    assert load(write(draft)).controller.reference == "target"


def test_values_known_in_one_experiment(draft, write):
    draft.toml["experiments"][0] |= {
        "repeat": "A",
        "start": 12.5,
        "conditions": {"gravity_torque": 0.4, "temperature": 31.0},
        "add": {"inertia": 0.01},
        "initial": {"joint_velocity": 0.0},
    }
    one = load(write(draft))["one"]
    assert (one.repeat, one.start) == ("A", 12.5)
    assert one.conditions == {"gravity_torque": 0.4, "temperature": 31.0}
    assert (one.add, one.initial) == ({"inertia": 0.01}, {"joint_velocity": 0.0})


def test_initial_velocity_of_an_angle_is_a_state_of_two_inertia(two_inertia, write):
    two_inertia.toml["experiments"][0]["initial"] = {"motor_velocity": 0.5, "joint_velocity": 0.0}
    assert load(write(two_inertia))["one"].initial == {"motor_velocity": 0.5, "joint_velocity": 0.0}


def test_further_nominal_effects_bring_their_parameters(draft, write):
    draft.toml["system"]["nominal_effects"] = ["joint:coulomb", "joint:viscous", "actuation:offset"]
    draft.toml["system"]["parameters"]["actuation_offset"] = {"value": -0.1, "sd": 0.05}
    assert load(write(draft)).parameters["actuation_offset"].value == -0.1


def test_what_is_absent_is_zero_and_said(draft, write):
    """Gravity that nobody mentions is not there; friction that nobody measured is there, of unknown size."""
    parameters = draft.toml["system"]["parameters"]
    for name in ("gravity_torque", "torque_constant", "coulomb"):
        del parameters[name]
    dataset = load(write(draft))
    found = {name: (dataset.parameters[name].value, dataset.parameters[name].sd) for name in dataset.parameters}
    assert (found["gravity_torque"], found["torque_constant"]) == ((0.0, 0.0), (1.0, 0.0))
    assert found["coulomb"] == (0.0, None)
    assert dataset.warnings == (
        "No nominal value given for gravity_torque; 0 is assumed, exactly",
        "No nominal value given for coulomb; 0 is assumed",
    )
    draft.toml["signals"]["motor_torque"]["unit"] = "V"
    assert "No nominal value given for torque_constant; 1 is assumed, exactly" in load(write(draft)).warnings


def test_doubts_are_said_in_warnings(draft, write):
    draft.toml["signals"]["motor_current"] = {"column": "u", "unit": "A"}
    draft.toml["experiments"][0]["conditions"] = {"gravity_torqe": 0.4, "temperature": 31.0}
    draft.toml["signals"]["joint_angel"] = {"column": "q"}
    for experiment in draft.toml["experiments"]:
        experiment["split"] = "train"
    kept = "is unknown to rigid_joint and kept as a covariate"
    assert load(write(draft)).warnings == (
        f"signal 'joint_angel' {kept}; 'joint_angle' has nearly that name",
        f"condition 'gravity_torqe' {kept}; 'gravity_torque' has nearly that name",
        "no experiment is held out: all of them are in the training set",
    )


def test_without_a_split_the_library_splits_and_says_so(draft, write):
    for experiment in draft.toml["experiments"]:
        del experiment["split"]
    dataset = load(write(draft))
    assert [e.name for e in dataset.test] == ["two"]
    assert "held out by the library: two" in dataset.warnings[0]
    del draft.toml["experiments"][1]
    alone = load(write(draft))
    assert [e.name for e in alone.train] == ["one"]
    assert "no experiment is held out" in alone.warnings[0]


def test_a_misspelt_split_is_named(draft, write):
    draft.toml["experiments"][0]["spilt"] = draft.toml["experiments"][0].pop("split")
    with pytest.raises(DatasetError, match="spilt"):
        load(write(draft))


@pytest.mark.parametrize("unit", ["turn", "rev"])
def test_an_angle_may_be_logged_in_turns(unit, draft, write):
    draft.toml["signals"]["joint_angle"]["unit"] = unit
    logged = draft.frames["one.csv"]["q"]
    assert np.allclose(load(write(draft))["one"].data["joint_angle"], 2.0 * np.pi * logged, rtol=1e-12)


@pytest.mark.parametrize(
    ("repeats", "num_test"),
    [([None], 0), ([None] * 2, 1), ([None] * 10, 3), (["A", "A"], 1), (["A", "B"], 1), (["A", "A", "B", "B"], 1)],
)
def test_about_thirty_per_cent_are_held_out(repeats, num_test):
    test = choose_test(repeats)
    assert len(set(test)) == len(test) == num_test
    assert 0 not in test


def test_the_first_of_a_group_of_repeats_stays_in_training():
    labels = [None, "A", "B", "A", None, "B", "A", "C"]
    test = choose_test(labels)
    assert len(test) == 2
    assert not {0, 1, 2} & set(test)
    assert test == choose_test(labels)


def _write_parquet(path, columns):
    pd.DataFrame(columns).to_parquet(path)


def _write_indexed_parquet(path, columns):
    pd.DataFrame(columns).set_index("t").to_parquet(path)


def _write_mat(path, columns):
    scipy.io.savemat(path, {name: values[:, None] for name, values in columns.items()})


def _write_hdf5(path, columns):
    with h5py.File(path, "w", userblock_size=512 if path.suffix == ".mat" else 0) as file:  # as MATLAB 7.3 does
        for name, values in columns.items():
            file[name] = values[None, :]


def _write_npz(path, columns):
    np.savez(path, note=np.array(["a", "b"]), **columns)


KINDS = [
    ("one.parquet", _write_parquet),
    ("indexed.parquet", _write_indexed_parquet),
    ("one.mat", _write_mat),
    ("seventhree.mat", _write_hdf5),
    ("one.h5", _write_hdf5),
    ("one.hdf5", _write_hdf5),
    ("one.npz", _write_npz),
]


@pytest.mark.parametrize(("file", "save"), KINDS, ids=[kind[0] for kind in KINDS])
def test_every_kind_of_file_gives_the_frame_of_the_csv(draft, write, file, save):
    folder = write(draft)
    expected = load(folder)["one"].data
    save(folder / file, {name: column.to_numpy() for name, column in draft.frames["one.csv"].items()})
    draft.toml["experiments"][0]["file"] = file
    pd.testing.assert_frame_equal(load(write(draft))["one"].data, expected, check_exact=True)


def test_fields_of_a_matlab_struct_and_of_an_hdf5_group_are_columns(draft, write):
    folder = write(draft)
    columns = {name: column.to_numpy() for name, column in draft.frames["one.csv"].items()}
    expected = load(folder)["one"].data
    scipy.io.savemat(folder / "one.mat", {"t": columns["t"], "log": {"u": columns["u"]}, "q": columns["q"]})
    with h5py.File(folder / "two.h5", "w") as file:
        for name in ("t", "q", "log.u"):
            file[name.replace(".", "/")] = columns[name.removeprefix("log.")]
    del draft.toml["signals"]["joint_velocity"]
    for name, column in (("one.mat", "log.u"), ("two.h5", "log/u")):
        shutil.copy(folder / name, folder / f"copy-{name}")
        for experiment, file in zip(draft.toml["experiments"], (name, f"copy-{name}"), strict=True):
            experiment["file"] = file
        draft.toml["signals"]["motor_torque"]["column"] = column
        np.testing.assert_array_equal(load(write(draft))["one"].data["motor_torque"], expected["motor_torque"])


def _write_matrix(path, columns):
    np.savez(path, **columns | {"u": np.zeros((20, 2))})


def _write_short(path, columns):
    np.savez(path, **columns | {"u": columns["u"][:7]})


def _write_text(path, columns):
    np.savez(path, **columns | {"u": columns["u"].astype(str)})


def _write_garbage(path, columns):
    path.write_bytes(b"no such format" * 20)


def _write_backwards(path, columns):
    np.savez(path, **columns | {"t": -columns["t"]})


BROKEN_FILES = [
    ("one.npz", _write_matrix, r"one.npz, column 'u': of shape \(20, 2\); expected \(n,\)"),
    ("one.npz", _write_short, r"one.npz, column 'u': 7 samples; expected 20 as in 't'"),
    ("one.npz", _write_text, r"one.npz, column 'u': of type <U\d+; expected real numbers"),
    ("one.npz", _write_backwards, r"one.npz, row 2, column 't': time runs back"),
    ("one.npz", _write_garbage, r"one.npz: .*expected an NPZ archive"),
    ("one.mat", _write_garbage, r"one.mat: .*expected"),
    ("one.h5", _write_garbage, r"one.h5: .*expected an HDF5 file"),
    ("one.parquet", _write_garbage, r"one.parquet: .*expected a Parquet file"),
]


@pytest.mark.parametrize(("file", "save", "message"), BROKEN_FILES)
def test_broken_files_are_named(draft, write, file, save, message):
    folder = write(draft)
    save(folder / file, {name: column.to_numpy() for name, column in draft.frames["one.csv"].items()})
    draft.toml["experiments"][0]["file"] = file
    with pytest.raises(DatasetError, match=message):
        load(write(draft))


def test_csv_may_have_logicals_a_byte_order_mark_and_blank_lines_at_its_end(draft, write):
    folder = write(draft)
    text = "t, u ,q,dq\n" + "".join(f"{i},{i % 2 == 0},0.5,nan\n" for i in range(3)) + "3,True,0.5,1\n\n\n"
    (folder / "one.csv").write_text(text, encoding="utf-8-sig")
    data = load(folder)["one"].data
    assert list(data["motor_torque"]) == [1.0, 0.0, 1.0, 1.0]
    assert list(data["joint_velocity"].isna()) == [True, True, True, False]


def test_a_dataset_shows_itself(draft, write):
    import matplotlib.pyplot as plt

    dataset = load(write(draft))
    assert "<b>tiny</b>" in dataset._repr_html_()
    assert len(repr(dataset)) < 300
    assert dataset.to_dict()["experiments"][1] == {
        "name": "two",
        "split": "test",
        "repeat": None,
        "num_samples": 20,
        "duration": pytest.approx(0.19),
    }
    figure, ax = plt.subplots()
    assert dataset.plot(ax, signal="joint_velocity") is ax
    assert ax.get_ylabel() == "joint_velocity (rad/s)"
    plt.close(figure)
    with pytest.raises(DatasetError, match="no signal 'joint_angel'; did you mean 'joint_angle'"):
        dataset.plot(signal="joint_angel")
    assert len(dataset) == len(list(dataset)) == 2


def test_withheld_truth_is_never_opened(draft, write):
    """Files that only a scorer may open may even be unreadable."""
    folder = write(draft)
    for name in ("sealed.toml", "expected.toml"):
        (folder / name).write_bytes(b"\xff not toml")
    assert load(folder).name == "tiny"


def test_a_dataset_gives_its_simulator(draft, write):
    draft.toml["system"]["parameters"]["coulomb"] = {"value": 0.07}
    system = load(write(draft)).system()
    assert (system.kind, system.axis, system.effects) == ("rigid_joint", "rotary", ("joint:coulomb", "joint:viscous"))
    assert system.parameters["coulomb"] == 0.07
