"""The builds of the core: each processor takes the one for its widest vectors, and all give the same answers."""

import os
import subprocess
import sys

import numpy as np
import pytest

from tendonlab import _core

TOLERANCE = 1e-6
PARAMETERS = {
    "inertia": 0.01,
    "gravity_torque": 0.0,
    "torque_constant": 1.0,
    "coulomb": 0.1,
    "viscous": 0.02,
    "joint_static_excess": 0.02,
    "joint_stribeck_velocity": 0.05,
    "joint_bristle_stiffness": 40.0,
    "joint_bristle_damping": 0.1,
}
SWEEP = f"""
import sys
import numpy as np
import pandas as pd
import tendonlab as tl

time = np.linspace(0.0, 1.0, 501)
effects = ["joint:coulomb", "joint:viscous", "joint:stribeck", "joint:presliding"]
joint = tl.System("rigid_joint", effects=effects, parameters={PARAMETERS})
torque = pd.DataFrame({{"motor_torque": 0.4 * np.sin(9.0 * time)}}, index=time)
points = {{"coulomb": np.linspace(0.05, 0.2, 11)}}
found = tl.sweep(joint, points, experiment=torque, tolerance={TOLERANCE}, progress=False)
np.save(sys.argv[1], found["joint_angle"].to_numpy())
"""


def run(code: str, *arguments: str, **variables: str) -> subprocess.CompletedProcess[str]:
    given = {**os.environ, **variables}
    return subprocess.run([sys.executable, "-c", code, *arguments], env=given, capture_output=True, text=True)


@pytest.mark.parametrize("other", ["wide", "old"])
def test_the_builds_agree_to_ten_times_the_tolerance(tmp_path, other):
    angles = []
    for build in ("base", other):
        path = tmp_path / f"{build}.npy"
        done = run(SWEEP, str(path), TENDONLAB_CORE=build)
        if "needs a processor" in done.stderr or "without the build" in done.stderr:
            pytest.skip(f"this processor or this installation has no {other} build")
        assert done.returncode == 0, done.stderr
        angles.append(np.load(path))
    assert np.abs(angles[0] - angles[1]).max() <= 10.0 * TOLERANCE * np.abs(angles[0]).max()


def test_an_unknown_build_is_refused():
    done = run("import tendonlab._core", TENDONLAB_CORE="widest")
    assert "TENDONLAB_CORE = 'widest': expected wide, base or old" in done.stderr


def test_without_the_wide_build_the_base_one_is_taken():
    code = """
import importlib.util as util
find = util.find_spec
util.find_spec = lambda name, *rest: None if name.endswith("_core_wide") else find(name, *rest)
from tendonlab import _core
print(_core.__file__)
"""
    variables = {name: value for name, value in os.environ.items() if name != "TENDONLAB_CORE"}
    done = subprocess.run([sys.executable, "-c", code], env=variables, capture_output=True, text=True)
    assert "_core_base" in done.stdout, done.stderr


def test_the_core_keeps_its_name_whatever_its_file():
    assert _core.__name__ == "tendonlab._core"
    assert _core.Signal.__module__ == "tendonlab._core"
