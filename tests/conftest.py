"""What all tests share: no display, the measured data where they lie beside the repository, one run of the demo."""

import os
from collections.abc import Iterator
from pathlib import Path

import matplotlib
import pytest
from matplotlib import pyplot as plt

from twin import TwinDiagnosis, run_demo

matplotlib.use("Agg")

_MEASURED = Path(__file__).resolve().parents[2] / "shared" / "data"
if _MEASURED.is_dir():
    os.environ.setdefault("TENDONLAB_DATA", str(_MEASURED))


@pytest.fixture(autouse=True)
def _no_figure_is_left_open() -> Iterator[None]:
    yield
    plt.close("all")


@pytest.fixture(scope="session")
def twin_diagnosis(tmp_path_factory: pytest.TempPathFactory) -> TwinDiagnosis:
    """The diagnosis of the bundled rig, by far the longest run of all tests: once, as a user runs it."""
    return run_demo(tmp_path_factory.mktemp("demo"))
