"""Each way to break a dataset is one error that names the place, the value and what was expected."""

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tendonlab.data import load
from tendonlab.errors import DatasetError

Mutation = Callable[[Any], object]


def put(path: str, value: Any) -> Mutation:
    """Set a dotted key of dataset.toml."""

    def mutate(draft: Any) -> None:
        *tables, key = path.split(".")
        table = draft.toml
        for name in tables:
            table = table[int(name)] if isinstance(table, list) else table.setdefault(name, {})
        table[key] = value

    return mutate


def drop(path: str) -> Mutation:
    """Remove a dotted key of dataset.toml."""

    def mutate(draft: Any) -> None:
        *tables, key = path.split(".")
        table = draft.toml
        for name in tables:
            table = table[int(name)] if isinstance(table, list) else table[name]
        del table[key]

    return mutate


def samples(column: str, where: Any, value: Any, *, files: tuple[str, ...] = ("one.csv",)) -> Mutation:
    """Overwrite samples of a column."""

    def mutate(draft: Any) -> None:
        for file in files:
            frame = draft.frames[file]
            frame[column] = frame[column].astype(object)
            frame.loc[where, column] = value

    return mutate


def all_of(*mutations: Mutation) -> Mutation:
    return lambda draft: [mutate(draft) for mutate in mutations]


def control(**changes: Any) -> Mutation:
    """A valid [controller] with `changes`; None removes a key."""
    table = {"kind": "pd", "kp": 1.0, "kd": 0.1, "measured": "joint_angle", "reference": "target"} | changes
    table = {key: value for key, value in table.items() if value is not None}
    return all_of(put("controller", table), put("signals.target", {"column": "q", "unit": "rad"}))


BOTH = ("one.csv", "two.csv")
BROKEN: list[tuple[str, Mutation, str]] = [
    ("foreign format", put("format", "other/2"), r"key format: 'other/2': expected 'tendonlab-dataset/1'"),
    ("no format", drop("format"), r"key format: is missing"),
    ("no name", drop("name"), r"key name: is missing; expected a string"),
    ("empty name", put("name", ""), r"key name: an empty string"),
    ("name a number", put("name", 3), r"key name: 3: expected a string"),
    ("unknown top key", put("sytem", 1), r"key sytem: unknown key; did you mean 'system'"),
    ("unknown system key", put("system.nominal_effect", []), r"system.nominal_effect: .*'nominal_effects'"),
    ("unknown signal key", put("signals.joint_angle.units", "rad"), r"signals.joint_angle.units: .*'unit'"),
    ("unknown experiment key", put("experiments.1.splitt", "test"), r"experiments\[1\].splitt: .*'split'"),
    ("unknown parameter key", put("system.parameters.inertia.std", 1.0), r"parameters.inertia.std: unknown key.*'sd'"),
    ("unknown time key", put("time.name", "t"), r"time.name: unknown key; expected one of column, unit"),
    ("no system", drop("system"), r"key system: is missing"),
    ("unknown system", put("system.kind", "rigid_joints"), r"system.kind: 'rigid_joints'.*'rigid_joint'"),
    ("unknown axis", put("system.axis", "liner"), r"system.axis: 'liner': did you mean 'linear'"),
    (
        "unknown effect",
        put("system.nominal_effects", ["joint:viscos"]),
        r"nominal_effects: 'joint:viscos'.*joint:viscous",
    ),
    ("effects no array", put("system.nominal_effects", "joint:viscous"), r"nominal_effects: .*expected an array"),
    (
        "effect twice",
        put("system.nominal_effects", ["joint:viscous", "joint:viscous", "joint:coulomb"]),
        r"nominal_effects: duplicate 'joint:viscous'",
    ),
    ("unknown parameter", put("system.parameters.inerta", {"value": 1.0}), r"parameters.inerta: .*'inertia'"),
    (
        "parameter of an effect that is not nominal",
        put("system.parameters.joint_stribeck_velocity", {"value": 0.1}),
        r"joint_stribeck_velocity: belongs to 'joint:stribeck', which is not among system.nominal_effects",
    ),
    (
        "parameter of an effect taken out",
        put("system.nominal_effects", ["joint:viscous"]),
        r"parameters.coulomb: belongs to 'joint:coulomb'",
    ),
    ("no inertia", drop("system.parameters.inertia"), r"parameters.inertia: is missing; expected the nominal value"),
    (
        "nominal effect without its shape",
        put("system.nominal_effects", ["joint:coulomb", "joint:viscous", "joint:stribeck"]),
        r"parameters.joint_stribeck_velocity: is missing",
    ),
    ("parameter no table", put("system.parameters.inertia", 0.02), r"inertia: 0.02: expected a table"),
    ("parameter without value", drop("system.parameters.inertia.value"), r"inertia.value: is missing"),
    ("parameter text", put("system.parameters.inertia.value", "big"), r"inertia.value: 'big': expected a number"),
    ("parameter true", put("system.parameters.inertia.value", True), r"inertia.value: True: expected a number"),
    ("parameter nan", put("system.parameters.inertia.value", np.nan), r"inertia.value: nan: expected a finite"),
    ("parameter infinite", put("system.parameters.inertia.value", np.inf), r"inertia.value: inf: expected a finite"),
    ("negative sd", put("system.parameters.inertia.sd", -0.1), r"inertia.sd: -0.1: expected a value in \[0, inf\]"),
    ("below physics", put("system.parameters.inertia.value", -1.0), r"inertia.value: -1 is outside its bounds"),
    ("above own max", put("system.parameters.viscous.max", 0.001), r"viscous.value: 0.01 .* in \[0, 0.001\]"),
    ("min above max", put("system.parameters.viscous", {"value": 1.0, "min": 3.0, "max": 2.0}), r"viscous.min: 3 is"),
    ("no signals", drop("signals"), r"key signals: is missing"),
    ("required input missing", drop("signals.motor_torque"), r"signals.motor_torque: is missing.*rigid_joint requires"),
    (
        "required input misspelt",
        all_of(drop("signals.motor_torque"), put("signals.motor_torqe", {"column": "u"})),
        r"signals.motor_torque: is missing.*the file has 'motor_torqe'",
    ),
    (
        "no output",
        all_of(drop("signals.joint_angle"), drop("signals.joint_velocity")),
        r"signals: no output of rigid_joint is measured; expected at least one of joint_angle",
    ),
    (
        "column missing",
        put("signals.joint_angle.column", "qq"),
        r"one.csv, column 'qq': is missing; .*'q'|expected one",
    ),
    ("time column missing", put("time.column", "time"), r"one.csv, column 'time': is missing"),
    ("time in metres", put("time.unit", "m"), r"time.unit: unit 'm' is of the wrong dimension.*'s'"),
    ("no unit at all", put("signals.joint_angle.unit", "radd"), r"signals.joint_angle.unit: unit 'radd'"),
    ("a unit cut off", put("signals.joint_angle.unit", "N*"), r"unit 'N\*' is not a unit; expected one like 'N\*m'"),
    ("an open bracket", put("signals.joint_angle.unit", "rad/(s"), r"unit 'rad/\(s' is not a unit; expected one like"),
    ("unit no text", put("signals.joint_angle.unit", 1), r"signals.joint_angle.unit: 1: expected a string"),
    ("angle in metres", put("signals.joint_angle.unit", "m"), r"joint_angle.unit: unit 'm'.*wrong dimension.*'rad'"),
    ("angle in counts", put("signals.joint_angle.unit", "count"), r"joint_angle.unit: unit 'count'.*'rad'"),
    ("rate in hertz", put("signals.joint_velocity.unit", "Hz"), r"joint_velocity.unit: unit 'Hz'.*'rad/s'"),
    ("torque in newtons", put("signals.motor_torque.unit", "N"), r"motor_torque.unit: unit 'N'.*'N\*m'"),
    ("torque on a slide", put("system.axis", "linear"), r"motor_torque.unit: unit 'N\*m'.*'N'"),
    ("hold at an output", put("signals.joint_angle.hold", True), r"joint_angle.hold: joint_angle is an output"),
    ("hold no flag", put("signals.motor_torque.hold", "yes"), r"motor_torque.hold: 'yes': expected true or false"),
    ("negative noise", put("signals.joint_angle.noise_sd", -1.0), r"joint_angle.noise_sd: -1: expected"),
    ("no experiments", put("experiments", []), r"key experiments: is empty"),
    ("experiments no tables", put("experiments", 1), r"key experiments: expected \[\[experiments\]\] tables, got int"),
    ("experiment without file", drop("experiments.0.file"), r"experiments\[0\].file: is missing"),
    (
        "experiment name twice",
        put("experiments.1.name", "one"),
        r"experiments\[1\].name: duplicate experiment name 'one'",
    ),
    (
        "one file twice",
        put("experiments.1.file", "./one.csv"),
        r"experiments\[1\].file: 'one.csv' is the file of 'one' too",
    ),
    (
        "absolute file",
        put("experiments.0.file", "/etc/one.csv"),
        r"experiments\[0\].file: '/etc/one.csv' is outside the",
    ),
    (
        "file above the folder",
        put("experiments.0.file", "a/../../one.csv"),
        r"is outside the dataset; expected",
    ),
    (
        "one column for two outputs",
        put("signals.joint_velocity.column", "q"),
        r"signals.joint_angle.column: 'q' is the column of joint_velocity too",
    ),
    (
        "one column for command and angle",
        put("signals.motor_torque.column", "q"),
        r"signals.joint_angle.column: 'q' is the column of motor_torque too",
    ),
    (
        "nothing moves",
        all_of(samples("q", slice(None), 1.0, files=BOTH), samples("dq", slice(None), 0.1, files=BOTH)),
        r"key signals: joint_angle, joint_velocity: constant in every experiment",
    ),
    ("file missing", put("experiments.0.file", "none.csv"), r"none.csv: no such file"),
    ("file of unknown kind", put("experiments.0.file", "one.xlsx"), r"one.xlsx: unknown kind of file '.xlsx'.*\.csv"),
    ("unknown split", put("experiments.0.split", "training"), r"experiments\[0\].split: 'training'.*'train'"),
    ("split in some", drop("experiments.0.split"), r"experiments\[0\].split: is missing while other"),
    ("nothing to train on", put("experiments.0.split", "test"), r"every experiment is 'test'"),
    ("start a text", put("experiments.0.start", "noon"), r"experiments\[0\].start: 'noon': expected a number"),
    (
        "condition outside its bounds",
        put("experiments.0.conditions.inertia", -2.0),
        r"experiments\[0\].conditions.inertia: -2 is outside its bounds",
    ),
    ("add to an unknown", put("experiments.0.add.inertias", 1.0), r"\[0\].add.inertias: .*'inertia'"),
    ("add below physics", put("experiments.0.add.inertia", -1.0), r"\[0\].add.inertia: -0.98 is outside"),
    ("initial of an unknown", put("experiments.0.initial.joint_angel", 0.0), r"initial.joint_angel: .*'joint_angle'"),
    ("time runs back", samples("t", 7, 0.05), r"one.csv, row 9, column 't': time runs back \(0.05 s after 0.06 s\)"),
    ("time stands still", samples("t", slice(6, 9), 0.06), r"one.csv, row 9, column 't': 16 % of the stamps repeat"),
    ("time missing", samples("t", 3, np.nan), r"one.csv, row 5, column 't': no time"),
    ("text among numbers", samples("q", 4, "oops"), r"one.csv, row 6, column 'q': 'oops': expected a number"),
    ("infinite sample", samples("q", 4, np.inf), r"one.csv, row 6, column 'q': an infinite value"),
    ("all-NaN output", samples("q", slice(None), np.nan), r"one.csv, column 'q': every sample is missing"),
    ("all-NaN input", samples("u", slice(None), np.nan), r"one.csv, column 'u': every sample is missing"),
    ("long gap in an input", samples("u", slice(4, 9), np.nan), r"row 6, column 'u': 6 samples .*at most 5"),
    (
        "gap below an empty row",
        all_of(*(samples(name, 2, np.nan) for name in ("u", "q", "dq")), samples("u", slice(4, 9), np.nan)),
        r"row 6, column 'u': 6 samples",
    ),
    ("gap at the start", samples("u", 0, np.nan), r"row 2, column 'u': motor_torque is missing at the start"),
    ("gap at the end", samples("u", 19, np.nan), r"row 21, column 'u': motor_torque is missing at the end"),
    (
        "input constant everywhere",
        samples("u", slice(None), 0.4, files=BOTH),
        r"signals.motor_torque: column 'u' is constant \(0.4 N\*m\) in every experiment",
    ),
    ("empty experiment", lambda d: d.frames.update({"one.csv": d.frames["one.csv"][:0]}), r"one.csv: 0 samples"),
    ("single sample", lambda d: d.frames.update({"one.csv": d.frames["one.csv"][:1]}), r"one.csv: 1 samples"),
    ("controller of unknown kind", control(kind="pid"), r"controller.kind: 'pid': did you mean 'pd'"),
    ("controller without gain", control(kp=None), r"controller.kp: is missing"),
    ("cascade without kd", control(kind="cascade", kd=None), r"controller.kd: is missing"),
    ("controller measures nothing", control(measured="joint_angel"), r"measured: 'joint_angel' .*'joint_angle'"),
    (
        "controller measures a rate",
        control(measured="joint_velocity"),
        r"measured: 'joint_velocity' is no measured angle",
    ),
    ("reference not declared", control(reference="tarket"), r"reference: 'tarket' is not declared.*'target'"),
    ("reference is an output", control(reference="joint_angle"), r"reference: 'joint_angle' is an output"),
    ("disturbance is the reference", control(disturbance="target"), r"disturbance: 'target' is the reference already"),
    ("limit zero", control(limit=0.0), r"controller.limit: 0: expected a positive number"),
    ("unknown controller key", control(ki=1.0), r"controller.ki: unknown key"),
    ("derivative on nothing", control(derivative_on="errors"), r"derivative_on: 'errors': did you mean 'error'"),
    (
        "reference constant everywhere",
        all_of(control(), put("signals.target.column", "dq")),
        r"signals.target: column 'dq' is constant \(0.1 rad\) in every experiment",
    ),
]


@pytest.mark.parametrize(("mutate", "message"), [case[1:] for case in BROKEN], ids=[case[0] for case in BROKEN])
def test_broken_dataset_is_an_error_that_says_where(draft, write, mutate, message):
    mutate(draft)
    with pytest.raises(DatasetError) as caught:
        load(write(draft))
    assert re.search(message, str(caught.value)), str(caught.value)


def test_amperes_without_a_torque_constant_are_warned_of(two_inertia, write):
    two_inertia.toml["signals"]["motor_torque"]["unit"] = "mA"
    assumed = "No nominal value given for torque_constant; 1 is assumed, exactly"
    rig = load(write(two_inertia))
    assert assumed in rig.warnings
    assert rig.signals["motor_torque"].si_unit == "A"
    two_inertia.toml["system"]["parameters"]["torque_constant"] = {"value": 0.07, "sd": 0.0}
    assert assumed not in load(write(two_inertia)).warnings


@pytest.mark.parametrize("name", ["motor_inertia", "gear_ratio", "cable_stiffness"])
def test_a_system_needs_what_it_is_made_of(two_inertia, write, name):
    del two_inertia.toml["system"]["parameters"][name]
    with pytest.raises(DatasetError, match=rf"system.parameters.{name}: is missing; expected the nominal value"):
        load(write(two_inertia))


RAW_FILES = [
    ("no file at all", None, r"dataset.toml: no such file"),
    ("not TOML", b"name = = 3", r"dataset.toml: .*expected TOML"),
    ("not UTF-8", b'name = "\xff"', r"dataset.toml: byte 8 is not UTF-8"),
]


@pytest.mark.parametrize(("content", "message"), [case[1:] for case in RAW_FILES], ids=[case[0] for case in RAW_FILES])
def test_unreadable_toml(tmp_path, content, message):
    if content is not None:
        (tmp_path / "dataset.toml").write_bytes(content)
    with pytest.raises(DatasetError, match=message):
        load(tmp_path)


RAW_CSV = [
    ("no header", b"", r"one.csv, row 1: is empty"),
    ("only a header", b"t,u,q,dq\n", r"one.csv: 0 samples"),
    ("semicolons", b"t;u;q;dq\n0;1;2;3\n", r"one.csv, row 1: names are separated by semicolons; expected commas"),
    ("tabs", b"t\tu\tq\tdq\n0\t1\t2\t3\n", r"one.csv, row 1: names are separated by tabs; expected commas"),
    ("comment", b"# rig 3\nt,u,q,dq\n", r"one.csv, row 1: begins with #; expected the names of the columns"),
    ("numbers", b"0,1,2,3\n1,1,2,3\n", r"one.csv, row 1: '0' is a number; expected the names of the columns"),
    ("too many values", b"t,u,q,dq\n0,1,2,3\n1,1,2,3,4\n", r"one.csv, row 3: 5 values; expected 4"),
    ("too many values everywhere", b"t,u,q,dq\n0,1,2,3,4\n1,1,2,3,4\n", r"one.csv, row 2: 5 values; expected 4"),
    ("truncated", b"t,u,q,dq\n0,1,2,3\n1,1,2\n", r"one.csv, row 3: 3 values; expected 4 as in the header"),
    ("a column twice", b"t,u,q,u,dq\n0,1,2,3,4\n1,1,2,3,4\n", r"row 1, column 'u': 2 columns of that name"),
    ("blank line", b"t,u,q,dq\n0,1,2,3\n\n1,1,2,3\n", r"one.csv, row 3, column 't': no time"),
    ("not UTF-8", b"t,u,q,dq,\xff\n0,1,2,3,4\n", r"one.csv: byte \d+ is not UTF-8"),
]


@pytest.mark.parametrize(("content", "message"), [case[1:] for case in RAW_CSV], ids=[case[0] for case in RAW_CSV])
def test_unreadable_csv(draft, write, content, message):
    folder = write(draft)
    (folder / "one.csv").write_bytes(content)
    with pytest.raises(DatasetError, match=message):
        load(folder)
