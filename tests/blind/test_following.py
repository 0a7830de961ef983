"""One more experiment for the cases whose report ends in a tie: the advised one, or a random one."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from sealed_cases import Drawn

from tendonlab.blind.description import System
from tendonlab.blind.drawing import Settled
from tendonlab.blind.following import Advice, Choice, _alone, _followed, follow
from tendonlab.blind.rig import Rig, draw_rig
from tendonlab.blind.strength import Strength
from tendonlab.blind.systems import (
    BOWDEN_PAIR,
    CABLE_JOINT,
    CCSRM,
    RIGID_JOINT,
    SERVO_PENDULUM,
    SYSTEMS,
    TWO_INERTIA,
)
from tendonlab.blind.write import _experiment_lines, _log, _signals, record

NUM, STEP = 120, 2e-4  # samples and step of the cases of `drawn`
TIME = np.arange(0.0, 0.6, 0.004)
NOTHING = Strength(
    amplitude=0.0,
    gap_noise=0.0,
    nominal_gap_noise=0.0,
    floor=np.zeros(0),
    limited=False,
    met=True,
    separation={},
)
PATH = 0.3 + 0.1 * np.sin(9.0 * TIME) ** 2


def reports(folder: Path, name: str, *, gain: float = 40.0, column: str = "ql") -> Path:
    """A report on one case that advises a motion."""
    (folder / name).mkdir(parents=True)
    motion = {"separates": ["a:b", "c:d"], "expected_gain": gain, "reference": "next-1.csv"}
    effects = [{"element": name[0], "effect": name[2], "probability": 0.4} for name in motion["separates"]]
    words = {"effects": effects, "next_experiments": [motion | {"add": {"gravity_torque": 0.5}}]}
    (folder / name / "report.json").write_text(json.dumps(words))
    pd.DataFrame({"t": TIME, column: PATH}).to_csv(folder / name / "next-1.csv", index=False)
    return folder


def followed(told: Path, folder: Path, **options: str) -> Path:
    where = {"sealed": folder / "truth", **options}
    return follow(15, 4, told, folder / "out", step=STEP, num_samples=NUM, **where) / "cases"  # type: ignore[arg-type]


def test_a_tied_case_gets_the_advised_experiment_and_keeps_its_own(drawn: Drawn, tmp_path: Path) -> None:
    cases = followed(reports(tmp_path / "told", "case-002"), tmp_path)
    (case,) = cases.iterdir()
    before, after = (tomllib.loads((f / "case-002" / "dataset.toml").read_text()) for f in (drawn.cases, cases))
    (new,) = [e for e in after["experiments"] if e not in before["experiments"]]
    assert before == after | {"experiments": before["experiments"]}
    assert new["split"] == "train"
    assert new["add"] == pytest.approx({"gravity_torque": 0.5, "joint_inertia": 0.5 / 9.81 * 0.25}, rel=1e-6)
    for old in before["experiments"]:
        assert (case / old["file"]).read_bytes() == (drawn.cases / "case-002" / old["file"]).read_bytes()
    truths = [(place / "case-002.toml").read_text() for place in (drawn.sealed, tmp_path / "truth")]
    assert truths[0] == truths[1]
    log, gear = pd.read_csv(case / new["file"]), 10.0
    assert np.allclose(log["qr"] / gear, np.interp(log["t"], TIME, PATH), atol=1e-7)  # digits of the log
    assert np.corrcoef(log["ql"], np.interp(log["t"], TIME, PATH))[0, 1] > 0.9


def test_the_random_motion_is_as_long_and_another_one(tmp_path: Path) -> None:
    case = followed(reports(tmp_path / "told", "case-002"), tmp_path, choice="random") / "case-002"
    log = pd.read_csv(case / "run-next.csv")
    assert log["t"].iloc[-1] == pytest.approx(TIME[-1], abs=0.003)
    off = log["qr"] / 10.0 - np.interp(log["t"], TIME, PATH)
    assert np.ptp(off) > 0.02


def test_only_a_tie_that_an_experiment_settles_is_followed(tmp_path: Path) -> None:
    told = reports(tmp_path / "told", "case-002", gain=5.0)
    with pytest.raises(ValueError, match="expected a report with a tie that an experiment can settle, found none"):
        followed(told, tmp_path)
    assert not (tmp_path / "out").exists()


def settled(system: System, *, excitation: str = "poor", num: int = 80) -> Settled:
    rig = draw_rig(
        np.random.default_rng(3), effect="", kind="none", system=system, excitation=excitation, num_samples=num
    )
    return Settled(0, rig, [], [])


def added(case: Settled, advice: Advice, *, choice: Choice = "advised") -> Rig:
    return _followed(case, advice, seed=5, choice=choice)


PLAYED: dict[str, tuple[System, tuple[str, ...]]] = {
    system.kind: (system, columns)
    for system, columns in (
        (TWO_INERTIA, ("qr",)),
        (RIGID_JOINT, ("q",)),
        (SERVO_PENDULUM, ("goal", "volts")),
        (CCSRM, ("q2",)),
        (BOWDEN_PAIR, ("u", "w")),
        (CABLE_JOINT, ("w",)),
    )
}


@pytest.mark.parametrize("kind", SYSTEMS)
def test_every_kind_of_rig_plays_what_is_advised(kind: str) -> None:
    system, columns = PLAYED[kind]
    waves = {name: (6.0 if name == "volts" else 0.0) + (k + 1) * (PATH - PATH[0]) for k, name in enumerate(columns)}
    case = settled(system)
    rig = added(case, Advice(TIME, waves, {}))
    (run,) = record([_alone(rig)], [NOTHING], step=system.coarse_step)
    log = _log(rig, run, -1)
    wanted = {name: np.interp(run.time, TIME, values) for name, values in waves.items()}
    signals = {column: signal for signal, column, _, _ in _signals(rig)}
    if "q" in columns or "qr" in columns:  # the motion of a loop
        ((name, path),) = wanted.items()
        assert np.allclose(log["reference_angle"], path, atol=1e-9)
        return
    for name, values in wanted.items():
        assert np.allclose(log[signals[name]], values, atol=1e-9), name
    assert len(columns) == len(system.inputs)


def test_a_load_has_the_name_that_the_generator_gives_it() -> None:
    rig = added(settled(CCSRM), Advice(TIME, {"q2": PATH}, {"inertia": 0.01}))
    assert rig.experiments[-1].add == {"joint_inertia": 0.01}
    assert "add = { inertia = 0.01 }" in "\n".join(_experiment_lines(rig, rig.experiments[-1]))


@pytest.mark.parametrize("kind", SYSTEMS)
def test_a_random_experiment_is_a_rich_one_within_what_the_rig_has_shown(kind: str) -> None:
    case = settled(SYSTEMS[kind], num=600)
    time = case.rig.sample_time * np.arange(400)
    rig = added(case, Advice(time, {}, {}), choice="random")
    *seen, new = rig.experiments
    of = rig.system.inputs
    pairs = [(new.reference, [e.reference for e in seen], of[0])]
    pairs += [(x, [e.others[n] for e in seen], next(one for one in of if one.name == n)) for n, x in new.others.items()]
    for signal, logged, entry in pairs:
        assert len(signal) == len(np.arange(0.0, time[-1], rig.sample_time))
        assert 0.0 < np.ptp(signal) <= np.ptp(logged) + 1e-12
        assert np.abs(np.diff(signal)).max() <= np.abs(np.diff(logged, axis=1)).max() + 1e-12
        if entry.unit.endswith("/s"):
            assert signal[0] == 0.0
        else:
            assert np.min(logged) - 1e-12 <= signal.min() <= signal.max() <= np.max(logged) + 1e-12
    assert (new.name, new.split, new.repeat) == ("run-next", "train", None)


def test_the_new_run_has_noise_and_scatter_of_its_own() -> None:
    case = settled(BOWDEN_PAIR)
    last = case.rig.experiments[-1]
    time = case.rig.sample_time * np.arange(case.rig.num_samples + 1)
    waves = {"u": np.append(last.reference, 0.0), "w": np.append(last.others["input_velocity"], 0.0)}
    rig = added(case, Advice(time, waves, last.add))
    (old,), (new,) = (record([one], [NOTHING]) for one in (case.rig, _alone(rig)))
    assert new.outputs.shape[1] == old.outputs.shape[1]
    assert np.abs(new.outputs[0, :, -1] - old.outputs[0, :, -1]).std() > 0.05  # N*m; white noise is 0.06 and more
