"""Plans: shapes, files, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.rehearsal.build import simulated_rig
from tendonlab.rehearsal.plan import planned_experiments, rig_without_logs, still_notes
from tendonlab.rehearsal.sensors import stated_noise

HEAD = 'format = "tendonlab-plan/1"\nrate = 100\n'
CHIRP = '[[experiments]]\nname = "a"\nshape = "chirp"\namplitude = 0.4\nduration = 4\nfrequencies = [0.5, 2]\n'


def plan(folder: Path, text: str) -> Path:
    file = folder / "plan.toml"
    file.write_text(text, encoding="utf-8")
    return file


def test_shapes_have_the_numbers_that_were_asked_for(planned: Path) -> None:
    text = HEAD + CHIRP
    text += '[[experiments]]\nname = "s"\nshape = "steps"\namplitude = 0.2\nduration = 5\nhold = 1.0\nrate = 50\n'
    text += '[[experiments]]\nname = "r"\nshape = "slow_reversals"\namplitude = 0.3\nspeed = 0.2\nduration = 12\n'
    chirp, steps, reversals = planned_experiments(plan(planned, text), rig_without_logs(planned))
    assert (len(chirp.data), chirp.duration) == (401, 4.0)
    path = chirp.data["reference_angle"].to_numpy()
    assert np.abs(path).max() == pytest.approx(0.4, rel=1e-3)
    assert int((np.diff(np.sign(path)) != 0).sum()) == pytest.approx(2 * 4 * (0.5 + 2) / 2, abs=1)  # mean frequency
    assert steps.data["reference_angle"].iloc[[10, 60, 110, 160, 210]].tolist() == pytest.approx(
        [0, 0.2, -0.2, 0.1, -0.1]
    )
    slope = np.diff(reversals.data["reference_angle"]) * 100
    assert np.median(np.abs(slope)) == pytest.approx(0.2, rel=1e-6)
    assert reversals.data["reference_angle"].max() == pytest.approx(0.3, rel=1e-2)


def test_a_file_is_read_in_the_columns_and_units_of_the_dataset(planned: Path) -> None:
    toml = (planned / "dataset.toml").read_text().replace('{ column = "r" }', '{ column = "r", unit = "deg" }')
    (planned / "dataset.toml").write_text(toml)
    time = np.arange(0.0, 2.0, 0.01)
    pd.DataFrame({"t": time, "r": 30 * np.sin(time)}).to_csv(planned / "path.csv", index=False)
    text = HEAD + '[[experiments]]\nname = "a"\nfile = "path.csv"\nadd = { gravity_torque = 0.1 }\n'
    (made,) = planned_experiments(plan(planned, text), rig_without_logs(planned))
    assert made.data["reference_angle"].to_numpy() == pytest.approx(np.deg2rad(30) * np.sin(time), abs=1e-9)
    assert made.add == {"gravity_torque": 0.1}


def test_a_rig_without_a_controller_follows_a_path_in_the_loop_of_its_logs(pendulum: Path, tmp_path: Path) -> None:
    """As the references have it that a diagnosis proposes."""
    time = np.arange(0.0, 4.0, 0.01)
    path = 0.4 * np.sin(3.0 * time)
    pd.DataFrame({"t": time, "q": path}).to_csv(tmp_path / "next-1.csv", index=False)
    file = plan(tmp_path, HEAD + '[[experiments]]\nname = "next"\nfile = "next-1.csv"\nsplit = "train"\n')
    rig = rig_without_logs(pendulum)
    rigs = simulated_rig(rig, planned_experiments(file, rig))
    (log,) = rigs.noisy(np.random.default_rng(0), rigs.system).experiments
    assert np.std(log.data["joint_angle"] - path) < 0.2 * np.std(path)  # the loop is soft
    assert np.ptp(log.data["motor_torque"]) > 0.3  # gravity alone asks for 0.4 N·m
    alone = replace(rig, experiments=())
    with pytest.raises(tl.DatasetError, match=r"follow joint_angle; expected logs whose loop is known, or a column of"):
        simulated_rig(alone, planned_experiments(file, alone))


def test_a_rig_that_is_to_rest_in_one_run_may_be_moved_by_its_command_in_another(
    pendulum: Path, tmp_path: Path
) -> None:
    time = np.arange(0.0, 2.0, 0.01)
    pd.DataFrame({"t": time, "q": 0.1}).to_csv(tmp_path / "hold.csv", index=False)
    held = '[[experiments]]\nname = "b"\nfile = "hold.csv"\n'
    rig = rig_without_logs(pendulum)
    push, rest = planned_experiments(plan(tmp_path, HEAD + CHIRP + held), rig)
    assert np.ptp(push.data["motor_torque"]) > 0.5
    assert (rest.data["joint_angle"] == 0.1).all()
    with pytest.raises(tl.DatasetError, match="joint_angle is constant in all of them"):
        planned_experiments(plan(tmp_path, HEAD + held), rig)


def test_a_planned_experiment_that_never_moves_is_named(planned: Path) -> None:
    """Steps begin at 0: the second record ends before its first step."""
    steps = '[[experiments]]\nname = "{0}"\nshape = "steps"\namplitude = 0.2\noffset = 0.1\nduration = 4\nhold = {1}\n'
    rig = rig_without_logs(planned)
    made = planned_experiments(plan(planned, HEAD + CHIRP + steps.format("s", 5) + steps.format("t", 1)), rig)
    told = ["The planned experiment s never moves: reference_angle = 0.1 rad throughout."]
    assert list(still_notes(made, rig)) == told


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("rate = 100\n" + CHIRP, r"plan.toml, key format: is missing"),
        (HEAD.replace("/1", "/2") + CHIRP, r"'tendonlab-plan/2': expected 'tendonlab-plan/1'"),
        (HEAD + CHIRP + CHIRP, r"plan.toml, key experiments\[1\].name: duplicate experiment name 'a'"),
        (HEAD + CHIRP.replace("chirp", "chrip"), r"experiments\[0\].shape: 'chrip': did you mean 'chirp'"),
        (HEAD + CHIRP.replace("0.4", "-1"), r"experiments\[0\].amplitude: -1: expected a value in"),
        (HEAD + CHIRP.replace("[0.5, 2]", "3"), r"frequencies: 3: expected two numbers above 0, Hz"),
        (HEAD + CHIRP.replace("[0.5, 2]", "[0.5, 200]"), r"200 Hz: expected at most half of the rate"),
        (HEAD + CHIRP + "speed = 1.0\n", r"speed: means nothing for chirp; expected amplitude, offset, frequencies"),
        (HEAD.partition("\n")[0] + "\n" + CHIRP, r"plan.toml, key rate: is missing; expected a number"),
        (HEAD + CHIRP + 'signal = "torque"\n', r"signal: 'torque': expected one of|signal: 'torque': did you mean"),
        (HEAD + CHIRP + "add = { mass = 1.0 }\n", r"experiments\[0\].add.mass: 'mass' is no parameter"),
        (HEAD + CHIRP + 'colour = "red"\n', r"experiments\[0\].colour: unknown key"),
        (
            HEAD + '[[experiments]]\nname = "a"\nfile = "none.csv"\n',
            r"file: 'none.csv': no such file next to plan.toml",
        ),
        (HEAD + "experiments = [", r"plan.toml: .*expected TOML"),
    ],
)
def test_a_broken_plan_says_where_and_what_was_expected(planned: Path, text: str, message: str) -> None:
    with pytest.raises(tl.DatasetError, match=message):
        planned_experiments(plan(planned, text), rig_without_logs(planned))


def test_without_logs_the_noise_must_be_stated(planned: Path) -> None:
    toml = (planned / "dataset.toml").read_text().replace(", noise_sd = 1e-3", "")
    (planned / "dataset.toml").write_text(toml)
    with pytest.raises(tl.DatasetError, match=r"key signals.joint_angle.noise_sd: is missing; .* in rad"):
        stated_noise(rig_without_logs(planned))


def test_a_missing_plan_is_named(planned: Path) -> None:
    with pytest.raises(tl.DatasetError, match=r"nowhere.toml: no such file"):
        tl.rehearse(planned, plan=planned / "nowhere.toml", progress=False)
