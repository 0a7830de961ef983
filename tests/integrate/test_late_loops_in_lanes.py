"""Loops that read the past take their steps in lanes: each lane reads its own."""

import os
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, controller, joint, pair, run, run_many
from tendonlab.simulation.signals import hold, smooth
from tendonlab.simulation.system import System

HERE = Path(__file__).parent
COMPILER = os.environ.get("CXX") or shutil.which("c++")
T = np.linspace(0.0, 1.0, 201)
WAVE = 0.5 * np.sin(7.0 * T)
TOLERANCE = 1e-6
LATE = ("actuation:delay", "sensor.joint_angle:delay")
DRY = ("joint:coulomb", "joint:viscous")
# None of them, next to nothing, less and more than a step would be long: none of the loop's modes are those of others.
DELAYS = ((0.0, 0.0), (4e-5, 0.0), (0.0, 5e-5), (3e-3, 0.0), (0.0, 2e-3), (0.012, 0.004), (0.03, 0.0), (1e-3, 1e-3))


def joints(delays: Sequence[tuple[float, float]] = DELAYS, **values: float) -> list[System]:
    values = {"viscous": 0.3, "coulomb": 0.2, "gravity_torque": 2.0, **values}
    return [
        joint((*DRY, *LATE), actuation_delay=command, sensor__joint_angle_delay=sensor, **values)
        for command, sensor in delays
    ]


def pairs() -> list[System]:
    values = {**FRICTION, "cable_backlash": 0.01}
    effects = (*NOMINAL, "cable:backlash", "actuation:delay")
    return [pair(effects, actuation_delay=late, **values) for late in (0.0, 5e-5, 1e-3, 4e-3)]


def loop(reference: Any, **changes: Any) -> Any:
    return controller(reference, **{"proportional": 30.0, "derivative": 4.0, **changes})


CASES: Mapping[str, tuple[list[System], Any]] = {
    "smooth": (joints(), loop(smooth(T, WAVE))),
    "limited": (joints(), loop(smooth(T, WAVE), limit=3.0)),
    "a reference that jumps": (joints(), loop(hold(T, np.where(T < 0.4025, 0.0, 0.3)), reference_weight=0.0)),
    "sampled": (joints(), loop(smooth(T, WAVE), sample_time=0.004, derivative=2.0)),
    "stick and slip": (joints(coulomb=3.0), loop(smooth(T, 0.2 * WAVE))),
    "backlash": (pairs(), controller(smooth(T, 2.0 * WAVE))),
}


def together(systems: Sequence[System], closed: Any) -> np.ndarray:
    return run_many(systems, T, {}, loop=closed, position=[0.1] * systems[0].info.dof, tolerance=TOLERANCE)


@pytest.mark.parametrize("case", CASES)
def test_each_late_loop_moves_as_it_does_alone(case: str) -> None:
    systems, closed = CASES[case]
    many = together(systems, closed)
    for found, system in zip(many, systems, strict=True):
        single = run(system, T, loop=closed, position=[0.1] * system.info.dof, tolerance=TOLERANCE).table
        np.testing.assert_allclose(found, single, rtol=0.0, atol=10 * TOLERANCE * np.abs(single).max())


@pytest.mark.parametrize("case", CASES)
def test_neighbours_change_no_bit_of_a_late_loop(case: str) -> None:
    """More loops than lanes, so that lanes are filled again; alone, in pairs, and in another order."""
    systems, closed = CASES[case]
    systems = [*systems, *systems[::-1]]
    all_of_them = together(systems, closed)
    for rows in ([len(systems) - 2], [1, 3], list(range(len(systems)))[::-1]):
        np.testing.assert_array_equal(together([systems[k] for k in rows], closed), all_of_them[rows])


@pytest.mark.skipif(COMPILER is None, reason="needs a C++ compiler")
def test_lanes_read_what_each_past_holds(tmp_path: Path) -> None:
    program = tmp_path / "pasts"
    headers = HERE.parents[1] / "cpp"
    build = [str(COMPILER), "-std=c++17", "-Wno-psabi", "-I", str(headers), str(HERE / "pasts.cpp"), "-o", str(program)]
    done = subprocess.run(build, check=False, capture_output=True, encoding="utf-8")
    assert done.returncode == 0, done.stderr
    assert subprocess.run([program], check=False).returncode == 0
