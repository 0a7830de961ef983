"""A rig of which no experiment was repeated: what is missing is named, and nothing where nothing is missing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.checking.finding import Finding
from tendonlab.diagnosis.floor import renewed, under_noise_floor
from tendonlab.diagnosis.search.rivals import contest_each_place
from tendonlab.diagnosis.search.swap import extended
from tendonlab.diagnosis.search.workshop import open_workshop
from tendonlab.fitting.case import make_case
from tendonlab.fitting.rough import rough_fit

pytestmark = pytest.mark.slow
RATE, DURATION, NOISE = 100.0, 8.0, 1e-4
VALUES = {"inertia": 0.0125, "gravity_torque": 0.85, "torque_constant": 1.0, "coulomb": 0.06, "viscous": 0.02}
RIG = tl.System(kind="rigid_joint", parameters=VALUES, effects=("joint:coulomb", "joint:viscous"))
STRIBECK = {"joint:stribeck": {"static_excess": 0.05, "stribeck_velocity": 0.06}}
STATED = {"inertia": (0.012, 0.001), "gravity_torque": (0.9, 0.1), "coulomb": (0.05, 0.02), "viscous": (0.018, 0.005)}
RUNS = {"slow": (0.15, 0.9), "fast": (0.8, 0.6), "middle": (0.4, 0.8), "held-out": (0.55, 0.7)}


def write(folder: Path, rig: tl.System, *, seed: int) -> tl.Dataset:
    """Logs of `rig` under a torque that nearly carries a sine, with a noisy angle; a simulator of other values."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, DURATION, 1.0 / RATE)
    text = 'format = "tendonlab-dataset/1"\nname = "rig"\ntime = { column = "t", unit = "s" }\n'
    text += (
        '[system]\nkind = "rigid_joint"\nnominal_effects = ["joint:coulomb", "joint:viscous"]\n[system.parameters]\n'
    )
    text += "".join(f"{name} = {{ value = {value}, sd = {sd} }}\n" for name, (value, sd) in STATED.items())
    text += "torque_constant = { value = 1.0, sd = 0.0 }\n[signals]\n"
    text += 'motor_torque = { column = "u", unit = "N*m" }\njoint_angle = { column = "q", unit = "rad" }\n'
    for name, (frequency, reach) in RUNS.items():
        path, rate = reach * np.sin(2 * np.pi * frequency * time), 2 * np.pi * frequency * reach
        rate = rate * np.cos(2 * np.pi * frequency * time)
        torque = 0.85 * np.sin(path) + 0.12 * np.tanh(rate / 0.02) + 0.03 * rate
        given = pd.DataFrame({"motor_torque": torque}, index=pd.Index(time, name="t"))
        angle = rig.simulate(given, tolerance=1e-8)["joint_angle"].to_numpy()
        noisy = angle + NOISE * random.standard_normal(len(time))
        pd.DataFrame({"t": time, "u": torque, "q": noisy}).to_csv(folder / f"{name}.csv", index=False)
        split = "test" if name == "held-out" else "train"
        text += f'[[experiments]]\nname = "{name}"\nfile = "{name}.csv"\nsplit = "{split}"\n'
    (folder / "dataset.toml").write_text(text)
    return tl.load(folder)


@pytest.mark.cpu(120)
def test_what_is_missing_is_established(tmp_path: Path) -> None:
    why = tl.diagnose(write(tmp_path, RIG.with_effects(STRIBECK), seed=3), progress=False)
    assert why.selected == ("joint:stribeck",)
    assert why.verdict == "effect"
    values = why.effects[0].parameters
    assert values["static_excess"]["value"] == pytest.approx(0.05, rel=0.15)
    assert values["stribeck_velocity"]["value"] == pytest.approx(0.06, rel=0.15)


@pytest.mark.cpu(120)
def test_nothing_is_named_where_nothing_is_missing(tmp_path: Path) -> None:
    why = tl.diagnose(write(tmp_path, RIG, seed=4), progress=False)
    assert why.selected == ()
    assert why.verdict in ("no_gap", "parameters_only")


@pytest.mark.cpu(60)
def test_an_effect_leads_the_contest_for_its_own_place(tmp_path: Path) -> None:
    """Without it, noise is what the others leave: a screen under any other noise would favour whatever is nearest."""
    lacking = {**STRIBECK, "joint:asymmetry": {"level_asymmetry": 0.2, "viscous_asymmetry": 0.0}}
    rig = write(tmp_path, RIG.with_effects(lacking), seed=5)
    with open_workshop(None, progress=False) as shop:
        case = make_case(rig)
        rough = rough_fit(case, shop.cancel)
        fitter = under_noise_floor(case, rough, shop.pool, shop.cancel)
        start = [[*states, *(0.0 for _ in fitter.case.scatter)] for states in rough.initial]
        whole = fitter.fit(extended(rough.system, lacking), added=tuple(lacking), initial=start)
        fitter, whole = renewed(fitter, whole, shop.pool)
        for place in contest_each_place(fitter, whole, {}, shop):
            assert place.round.screened[0].effect == place.holder.effect
            assert place.holder.evidence_gain > 100.0


def late(rig: tl.Dataset, name: str, seconds: float) -> tl.Dataset:
    """The logs with the angle of one experiment stamped late."""
    file = rig.path / f"{name}.csv"
    run = pd.read_csv(file)
    run["q"] = np.interp(run["t"] - seconds, run["t"], run["q"])
    run.to_csv(file, index=False)
    return tl.load(rig.path)


@pytest.mark.cpu(120)
def test_a_late_experiment_that_an_effect_hides_is_told(tmp_path: Path) -> None:
    lacking = RIG.with_effects({"joint:load_dependence": {"load_dependence": 0.2}})
    rig = late(write(tmp_path, lacking, seed=3), "slow", 0.03)
    assert not tl.check(rig).blocks
    why = tl.diagnose(rig, progress=False)
    assert why.verdict == "data_fault"
    (found,) = [f for f in why.data if f["blocks"]]
    assert found["experiment"] == "slow"
    assert found["seconds"] == pytest.approx(0.03, abs=0.005)


@pytest.mark.cpu(120)
def test_an_experiment_that_the_simulator_follows_as_it_was_logged_is_not_late(tmp_path: Path, monkeypatch) -> None:
    """The equation may say so: of a servo's target, its steps look late to it once a deadband is known."""
    rig = write(tmp_path, RIG.with_effects({"joint:load_dependence": {"load_dependence": 0.2}}), seed=3)
    said = Finding(problem="clock", experiment="slow", seconds=0.03, blocks=True, detail="late")
    monkeypatch.setattr("tendonlab.checking.check.clock_findings", lambda *_: [said])
    why = tl.diagnose(rig, progress=False)
    assert (why.verdict, why.selected) == ("effect", ("joint:load_dependence",))
    assert not [f for f in why.data if f["blocks"]]
