"""Noise decides where a part stops that friction holds: a held-out run of stops leaves more, and nothing is wrong."""

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.diagnosis.answer.by_noise import ByNoise, left_by_noise
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.noise import Floor

NOISE, STEP, DURATION = 1e-4, 0.005, 12.0
VALUES = {"inertia": 0.012, "gravity_torque": 0.9, "torque_constant": 1.0, "coulomb": 0.05, "viscous": 0.02}
RUNS = {"first": "train", "again": "train", "swing": "test", "stops": "test"}
FLOOR = Floor(np.array([NOISE, np.nan]), [[], []], [NOISE, 0.0], 0.0, repeated=True)


def torque(time: np.ndarray, *, stops: bool) -> np.ndarray:
    """A torque that swings the joint, or lifts it in steps, at each of which friction holds the joint."""
    if not stops:
        return 0.25 * np.sin(2.0 * np.pi * 0.4 * time)
    level = np.array([0.0, 0.2, 0.35, 0.15, -0.1, -0.3, -0.05, 0.1])[(time / 1.5).astype(int)]
    return np.asarray(level + 0.08 * np.exp(-np.mod(time, 1.5) / 0.1))


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    """A joint that lacks nothing: a motion twice, and one with and one without stops held out."""
    folder, rng, time = tmp_path_factory.mktemp("stops"), np.random.default_rng(3), np.arange(0.0, DURATION, STEP)
    system = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
    text = 'format = "tendonlab-dataset/1"\nname = "stops"\ntime = { column = "t", unit = "s" }\n'
    text += (
        '[system]\nkind = "rigid_joint"\nnominal_effects = ["joint:coulomb", "joint:viscous"]\n[system.parameters]\n'
    )
    text += "".join(f"{name} = {{ value = {value}, sd = {0.1 * value} }}\n" for name, value in VALUES.items())
    text += '[signals]\nmotor_torque = { column = "u", unit = "N*m" }\njoint_angle = { column = "q", unit = "rad" }\n'
    for name, split in RUNS.items():
        given = pd.DataFrame({"motor_torque": torque(time, stops=name == "stops")}, index=pd.Index(time, name="t"))
        angle = system.simulate(given, tolerance=1e-8)["joint_angle"].to_numpy()
        read = {"t": time, "u": given["motor_torque"], "q": angle + NOISE * rng.standard_normal(len(time))}
        pd.DataFrame(read).to_csv(folder / f"{name}.csv", index=False)
        text += f'[[experiments]]\nname = "{name}"\nfile = "{name}.csv"\nsplit = "{split}"\n'
        text += 'repeat = "A"\n' if split == "train" else ""
    (folder / "dataset.toml").write_text(text)
    return make_case(tl.load(folder))


def test_stops_leave_more_than_a_swing_by_noise_alone(case: Case) -> None:
    names = [experiment.name for experiment in case.experiments]
    by = {name: left_by_noise(case, case.system, FLOOR, [names.index(name)], seed=0) for name in ("swing", "stops")}
    # such logs, drawn twelve times, left 1.02 of the swing on average, and 1.16 of the stops (1.02 to 1.36)
    assert 1.0 < by["swing"].left < 1.1
    assert 1.0 <= by["swing"].more < 1.1
    assert 1.08 < by["stops"].left < 1.3
    assert 1.08 < by["stops"].more < 1.3


def test_logs_that_cannot_be_simulated_explain_nothing(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(*_: object) -> None:
        raise tl.NumericalError("too stiff")

    monkeypatch.setattr("tendonlab.diagnosis.answer.by_noise.heldout.replay", failing)
    assert left_by_noise(case, case.system, FLOOR, [case.test[0]], seed=0) == ByNoise()
