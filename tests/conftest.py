"""What all tests share: no display, measured data where they lie beside the repository, diagnoses computed once, a
budget of CPU time per test."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib
import pytest
from matplotlib import pyplot as plt

import budget
import diagnoses
from tendonlab.data.datasets import prepare
from twin import TwinDiagnosis, run_demo

matplotlib.use("Agg")

_MEASURED = Path(__file__).resolve().parents[2] / "shared" / "data"
if _MEASURED.is_dir():
    os.environ.setdefault("TENDONLAB_DATA", str(_MEASURED))


def pytest_configure(config: pytest.Config) -> None:
    """The process that starts the workers makes the folder of shared diagnoses; the workers inherit its name."""
    if not hasattr(config, "workerinput"):
        os.environ[diagnoses.FOLDER] = tempfile.mkdtemp(prefix="tendonlab-diagnoses-")


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """All tests run in a process per processor; tests that are named on the command line run in this process."""
    whole = config.args_source is pytest.Config.ArgsSource.TESTPATHS
    return min(len(os.sched_getaffinity(0)), 4) if whole else 0


def pytest_unconfigure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        shutil.rmtree(os.environ.pop(diagnoses.FOLDER), ignore_errors=True)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Iterator[None]:
    """Note a test that takes more CPU time than its budget. CPU time on a busy machine decides no verdict."""
    before = budget.cpu_seconds()
    yield
    message = budget.excess(item, budget.cpu_seconds() - before)
    if message:
        item.user_properties.append((budget.OVER, message))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """List the tests over their budget, whatever process ran them."""
    reports = [r for kind in ("passed", "failed") for r in terminalreporter.stats.get(kind, []) if r.when == "call"]
    over = [f"{r.nodeid}: {message}" for r in reports for key, message in r.user_properties if key == budget.OVER]
    if over:
        terminalreporter.section("tests over their budget of CPU time")
        for line in sorted(over):
            terminalreporter.line(line)


@pytest.fixture(autouse=True)
def _no_figure_is_left_open() -> Iterator[None]:
    yield
    plt.close("all")


@pytest.fixture(scope="session")
def twin_diagnosis(tmp_path_factory: pytest.TempPathFactory) -> TwinDiagnosis:
    """The diagnosis of the bundled rig, by far the longest run of all tests: once, as a user runs it."""
    return run_demo(tmp_path_factory.mktemp("demo"))


@pytest.fixture(scope="session")
def measured_servo(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The dataset of a servo that others measured."""
    if not (Path(os.environ.get("TENDONLAB_DATA", "")) / "bam_xl330" / "processed").is_dir():
        pytest.skip("the records of the servo are not there: TENDONLAB_DATA names no folder with bam_xl330/processed")
    return prepare("bam_xl330", out=tmp_path_factory.mktemp("servo") / "rig")
