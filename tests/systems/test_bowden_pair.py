"""How runs of the sheathed pair begin, and what it makes of the rates of its inputs and of the way gone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from examples.bowden_pair import EXAMPLE
from tendonlab import _core
from tendonlab.data import Experiment
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.system import System

HARD = {**EXAMPLE.parameters, "threshold_slope": 1e5}
TIME = np.arange(0.0, 2.0, 0.01)
TURNED = np.maximum(TIME - 1.0, 0.0)
HELD = 5.7


def rig(*effects: str, **parameters: float) -> System:
    return System(kind="bowden_pair", effects=("sheath:capstan", *effects), parameters={**HARD, **parameters})


def run(time: np.ndarray = TIME, **signals: np.ndarray) -> Experiment:
    return Experiment(name="run", data=pd.DataFrame(signals, index=pd.Index(time, name="t")))


def from_rest(**more: np.ndarray) -> Experiment:
    """1.6 N·m on a drive that rests for a second; then torque and velocity grow."""
    return run(input_torque=1.6 + TURNED, input_velocity=TURNED, **more)


def measured(outlier: float = 0.0) -> np.ndarray:
    reading = HELD + 0.05 * np.random.default_rng(1).standard_normal(TIME.size)
    reading[2] += outlier
    return reading


def output(system: System, experiment: Experiment) -> np.ndarray:
    return np.asarray(system.simulate(experiment)["output_torque"])


def test_a_run_from_rest_starts_at_the_first_measured_output() -> None:
    """An outlier among the first samples does not count, and what was held is forgotten once the sheath slides."""
    shown = output(rig(), from_rest(output_torque=measured(outlier=-8.0)))
    assert shown[:100] == pytest.approx(HELD, abs=0.05)
    assert shown[-1] == pytest.approx(output(rig(), from_rest())[-1], rel=1e-12)


def test_it_starts_in_the_middle_of_the_loop_where_no_output_was_measured() -> None:
    assert output(rig(), from_rest())[:100] == pytest.approx(1.6 * 0.06 / 0.05, rel=1e-12)


def test_a_stated_start_is_known() -> None:
    stated = replace(from_rest(output_torque=measured()), initial={"output_torque": 4.0})
    assert output(rig(), stated)[:100] == pytest.approx(4.0)
    assert prepare(stated, rig(), Replay("free")).initial == ()


def test_a_biased_sensor_reads_what_it_read() -> None:
    """The start is its reading; what is held is that less its bias."""
    biased = rig("sensor.output_torque:bias", **{"sensor.output_torque_bias": 0.3})
    plain, shown = (output(of, from_rest(output_torque=measured())) for of in (rig(), biased))
    assert shown[:100] == pytest.approx(plain[:100], rel=1e-12)
    assert shown[-1] == pytest.approx(plain[-1] + 0.3, rel=1e-9)


def test_a_measured_start_is_an_unknown_of_its_run() -> None:
    ready, system = prepare(from_rest(output_torque=measured()), rig(), Replay("free")), rig()
    assert ready.initial == (("reading", 0),)
    assert ready.initial_mean == pytest.approx([HELD], abs=0.05)
    found = _core.simulate(
        "bowden_pair", system.values(), system.active(), ready.core, [("reading", 0)], ready.settings(1e-4)
    )
    assert found["gradient"][0, 0, [0, 99, -1]] == pytest.approx([1.0, 1.0, 0.0], abs=1e-6)


def folder(at: Path, frame: pd.DataFrame, *, initial: str) -> Path:
    """A dataset of one run, whose friction alone is not known exactly."""
    frame.to_csv(at / "run.csv")
    known = "".join(f"{n} = {{ value = {v}, sd = {0.006 * (n == 'friction_coefficient')} }}\n" for n, v in HARD.items())
    units = {"input_torque": "N*m", "input_velocity": "rad/s", "output_torque": "N*m"}
    signals = "".join(f'[signals.{n}]\ncolumn = "{n}"\nunit = "{unit}"\n' for n, unit in units.items())
    (at / "dataset.toml").write_text(
        f'format = "tendonlab-dataset/1"\nname = "rig"\n[system]\nkind = "bowden_pair"\n[system.parameters]\n{known}'
        f'{signals}[[experiments]]\nname = "run"\nfile = "run.csv"\n{initial}'
    )
    return at


def test_identification_fits_the_start_unless_it_is_stated(tmp_path: Path) -> None:
    """Samples disturbed at the start mislead the first guess, not the fit, which takes the second of rest together."""
    logged = output(rig(), from_rest(output_torque=np.full(TIME.size, HELD)))
    logged = logged + 0.05 * np.random.default_rng(2).standard_normal(TIME.size)
    logged[:8] += 0.4
    frame = from_rest(output_torque=logged).data
    free = tl.identify(tl.load(folder(tmp_path, frame, initial="")))
    assert free.initial["run"]["output_torque"] == pytest.approx(HELD, abs=0.1)
    known = tl.identify(tl.load(folder(tmp_path, frame, initial="initial = { output_torque = 5.7 }\n")))
    assert known.initial["run"] == {}
    assert known.parameters.loc["friction_coefficient", "value"] == pytest.approx(0.06, rel=0.02)


@pytest.mark.parametrize(("noise", "within"), [(0.0, 1e-4), (1e-3, 0.02)])
def test_inertia_of_the_drive_sees_the_acceleration_of_the_instant(noise: float, within: float) -> None:
    """Neither that of half a sample later nor the noise of the velocity's log."""
    time, w = np.arange(0.0, 4.0, 0.005), 2.0 * np.pi
    logged = np.sin(w * time) + noise * np.random.default_rng(3).standard_normal(time.size)
    experiment = run(time, input_torque=0.0 * time, input_velocity=logged)
    free = {"friction_coefficient": 0.0, "static_friction_coefficient": 0.0, "threshold_velocity": 0.0}
    shown = output(rig("actuation:drive_inertia", actuation_inertia=0.1, **free), experiment)
    moving = (np.abs(logged) > 0.1) & (time > 0.1) & (time < 3.9)
    acceleration = -shown[moving] * 0.05 / 0.06 / 0.1
    assert np.sqrt(np.mean((acceleration - w * np.cos(w * time[moving])) ** 2)) < within * w


def test_bristles_bend_by_the_way_gone_at_any_rate_of_the_log() -> None:
    """A log at 100 Hz tells what one at 2 kHz tells, at the instants of both."""

    def friction(rate: int) -> np.ndarray:
        time = np.arange(0.0, 2.0, 1.0 / rate)
        bristles = rig("sheath:presliding", sheath_bristle_stiffness=100.0, sheath_bristle_damping=0.0)
        drive = 0.5 * np.sin(2.0 * np.pi * time)
        return output(bristles, run(time, input_torque=0.0 * time, input_velocity=drive))[:: rate // 100]

    slow, fast = friction(100), friction(2000)
    assert np.max(np.abs(slow - fast)) < 0.01 * np.ptp(fast)
