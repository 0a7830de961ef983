"""A case that is ready to fit: the bundled rig, prepared once."""

import os
from pathlib import Path
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled
from tendonlab.data.datasets import prepare
from tendonlab.fitting.case import make_case


@pytest.fixture(scope="session")
def twin_case() -> Any:
    return make_case(tl.load(bundled()))


@pytest.fixture(scope="session")
def emps(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The measured axis and its diagnosis."""
    if not (Path(os.environ.get("TENDONLAB_DATA", "")) / "emps" / "DATA_EMPS.mat").is_file():
        pytest.skip("the EMPS recordings are not there: TENDONLAB_DATA names no folder with emps/DATA_EMPS.mat")
    dataset = tl.load(prepare("emps", out=tmp_path_factory.mktemp("emps") / "rig"))
    return dataset, tl.diagnose(dataset, progress=False)
