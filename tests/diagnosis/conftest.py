"""A case that is ready to fit, the bundled rig, and its simulator as a fit of that case."""

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.cli.demo import bundled
from tendonlab.data.datasets import prepare
from tendonlab.fitting.case import make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter


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
def emps(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The measured axis and its diagnosis."""
    if not (Path(os.environ.get("TENDONLAB_DATA", "")) / "emps" / "DATA_EMPS.mat").is_file():
        pytest.skip("the EMPS recordings are not there: TENDONLAB_DATA names no folder with emps/DATA_EMPS.mat")
    dataset = tl.load(prepare("emps", out=tmp_path_factory.mktemp("emps") / "rig"))
    return dataset, tl.diagnose(dataset, progress=False)
