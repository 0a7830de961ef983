"""Late runs of rigs that prescribed inputs move, as a simulation tells them."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

import tendonlab as tl
from tendonlab.blind.faults import Fault
from tendonlab.blind.rig import draw_rig
from tendonlab.blind.strength import Strength
from tendonlab.blind.systems import SYSTEMS
from tendonlab.blind.write import record, write_dataset
from tendonlab.checking.free import free_case
from tendonlab.checking.replayed import _least, _standing_out, late_by_replay

STRONG = Strength(
    amplitude=3.0, gap_noise=0.0, nominal_gap_noise=0.0, floor=np.zeros(1), limited=False, met=True, separation={}
)
TRIED = 0.0025 * np.arange(-40, 41)


@pytest.mark.cpu(20)  # the rigs are drawn here
@pytest.mark.parametrize(("system", "effect"), [("bowden_pair", "sheath:coulomb"), ("cable_joint", "joint:coulomb")])
@pytest.mark.parametrize("seconds", [0.0, 0.04])
def test_a_late_run_is_found_beside_friction_that_the_simulator_lacks(
    system: str, effect: str, seconds: float, tmp_path: Path
) -> None:
    rig = draw_rig(np.random.default_rng(5), effect=effect, kind="effect", system=SYSTEMS[system], excitation="rich")
    run = record([rig], [STRONG])[0]
    fault = Fault(problem="clock", experiment="run-03", seconds=seconds) if seconds else None
    write_dataset(rig, run, tmp_path / "rig", name="rig", description="", fault=fault)
    rig_logs = tl.load(tmp_path / "rig")
    found = late_by_replay(free_case(rig_logs, rig_logs.system()))
    assert [f.experiment for f in found] == ["run-03"] * bool(seconds)
    if seconds:
        assert_allclose([f.seconds or 0.0 for f in found], seconds, atol=0.003)
        assert [f.experiment for f in tl.check(rig_logs).findings if f.blocks] == ["run-03"]


def found_in(left: np.ndarray) -> list[tuple[str | None, float | None]]:
    """Experiment and lag of what stands out."""
    runs = [SimpleNamespace(name=f"run-{k}") for k in range(len(left))]
    case: Any = SimpleNamespace(
        outputs=["y"], measured=[0], experiments=runs, dataset=SimpleNamespace(inputs=["input_velocity"])
    )
    return [(f.experiment, f.seconds) for f in _standing_out(case, TRIED, left)]


def valley(lag: float, share: float = 0.1) -> np.ndarray:
    """Errors with their least at a lag: `share` of what is left at no lag, if the lag is another one."""
    least = share if lag else 1.0
    return np.asarray(least + (1.0 - share) * ((TRIED - lag) / (abs(lag) or 0.02)) ** 2)


def test_one_run_that_a_lag_of_its_own_mends_stands_out() -> None:
    assert found_in(np.array([valley(0.0)] * 4)) == []
    (late,) = found_in(np.array([valley(0.0), valley(0.031), valley(0.0), valley(0.0)]))
    assert late == ("run-1", pytest.approx(0.031))
    (ahead,) = found_in(np.array([valley(0.0), valley(0.0), valley(0.0), valley(-0.05)]))
    assert ahead == ("run-3", pytest.approx(-0.05))


@pytest.mark.parametrize(
    "other",
    [
        [valley(0.031, share=0.6), valley(0.0)],  # little is mended
        [valley(0.031), valley(0.031, share=0.7)],  # another one is mended by a lag as well
        [valley(0.005), valley(0.0)],  # not far from the others
        [10.0 * (0.1 - TRIED) + 0.01, valley(0.0)],  # best beyond what is tried
    ],
)
def test_nothing_stands_out_where_little_or_more_than_one_run_is_mended(other: list[np.ndarray]) -> None:
    assert found_in(np.array([valley(0.0), valley(0.0), valley(0.0), *other])) == []


def test_a_lag_between_those_that_are_tried_is_interpolated() -> None:
    left = (TRIED - 0.0131) ** 2
    assert _least(TRIED, left, int(np.argmin(left))) == pytest.approx(0.0131)


def test_a_rig_in_a_loop_tells_nothing(tmp_path: Path) -> None:
    draw = np.random.default_rng(5)
    rig = draw_rig(draw, effect="", kind="parameters_only", system=SYSTEMS["rigid_joint"], excitation="rich")
    run = record([rig], [replace(STRONG, amplitude=0.0)])[0]
    fault = Fault(problem="clock", experiment="run-03", seconds=0.04)
    write_dataset(rig, run, tmp_path / "rig", name="rig", description="", fault=fault)
    logs = tl.load(tmp_path / "rig")
    assert late_by_replay(free_case(logs, logs.system())) == []
