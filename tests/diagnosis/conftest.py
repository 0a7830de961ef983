"""A case that is ready to fit, the bundled rig, and its simulator as a fit of that case."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.cli.demo import bundled
from tendonlab.data.datasets import prepare
from tendonlab.fitting.case import make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter

SCATTER = 0.02  # of friction from run to run


@pytest.fixture(scope="session")
def twin_case() -> Any:
    return make_case(tl.load(bundled()))


@pytest.fixture(scope="session")
def fitter(twin_case: Any) -> Fitter:
    """Fits the bundled rig under so much noise that its model is about right."""
    floor = white(twin_case.noise)
    floor = replace(floor, sd=[20 * s for s in floor.sd])
    return Fitter(twin_case, floor, _core.Cancel())


@pytest.fixture(scope="session")
def nominal(fitter: Fitter) -> Fitted:
    """The simulator of the bundled rig at its nominal values."""
    return fitter.fit(fitter.case.system, solve=False)


@pytest.fixture(scope="session")
def known(twin_case: Any) -> tuple[Any, Fitted]:
    """The bundled rig as if its simulator were right, with friction that differs from run to run, and the model fitted
    to its training experiments."""
    names = [p.name for p in twin_case.system.info.parameters]
    friction = tuple(names.index(f"joint_{name}") for name in ("coulomb", "viscous"))
    case = replace(twin_case, scatter=((friction, SCATTER),))
    right = tuple(measured_as(case, i, 0.0) for i in range(len(case.experiments)))
    case = replace(case, prepared=right)
    return case, Fitter(case, white(case.noise), None).fit(case.system, solve=False)  # type: ignore[arg-type]


def measured_as(case: Any, i: int, friction: float, system: Any = None) -> Any:
    """Experiment i as the simulator gives it, its friction that many times e higher."""
    own = [*case.prepared[i].initial_mean, friction]
    measured = case.run(i, system or case.system, own)["outputs"]
    return replace(case.prepared[i], measured=np.where(np.isfinite(case.prepared[i].measured), measured, np.nan))


@pytest.fixture(scope="session")
def emps(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The measured axis and its diagnosis."""
    if not (Path(os.environ.get("TENDONLAB_DATA", "")) / "emps" / "DATA_EMPS.mat").is_file():
        pytest.skip("the EMPS recordings are not there: TENDONLAB_DATA names no folder with emps/DATA_EMPS.mat")
    dataset = tl.load(prepare("emps", out=tmp_path_factory.mktemp("emps") / "rig"))
    return dataset, tl.diagnose(dataset, progress=False)
