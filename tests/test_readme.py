"""The README does what it says: its Python runs, its dataset loads, and the CI runs its test lines."""

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from diagnoses import HOOK
from twin import TwinDiagnosis

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")
MOST_LINES = 160  # what a newcomer reads to the end


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.S)


@pytest.mark.cpu(15)
def test_the_tour_runs_as_written(tmp_path: Path, twin_diagnosis: TwinDiagnosis) -> None:
    """In a process of its own, next to a `data` folder as in a clone; the diagnosis of the demo is reused."""
    (tmp_path / "data").symlink_to(ROOT / "data")
    (code,) = blocks("python")
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", HOOK + code],
        cwd=tmp_path,
        env={**os.environ, "MPLBACKEND": "Agg"},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "Stribeck friction at the joint" in done.stdout
    assert (tmp_path / "out" / "report.html").is_file()


def test_the_dataset_of_the_reader_loads(tmp_path: Path) -> None:
    (text,) = blocks("toml")
    (tmp_path / "dataset.toml").write_text(text, encoding="utf-8")
    time = np.arange(0.0, 4.0, 0.01)
    for name in re.findall(r'"(\w+\.csv)"', text):
        table = pd.DataFrame({"t": time, "current": np.sin(3 * time), "angle": 40 * np.sin(2 * time)})
        table.to_csv(tmp_path / name, index=False)
    rig = tl.load(tmp_path)
    assert [e.split for e in rig] == ["train", "test"]
    assert rig["chirp"].data["joint_angle"].max() == pytest.approx(np.deg2rad(40), rel=1e-3)
    assert np.isfinite(rig.system().simulate(rig["chirp"])["joint_angle"]).all()


def test_the_ci_runs_the_lines_of_the_readme() -> None:
    """The line that installs everything and runs the quick tests, and the line of the slow ones."""
    lines = [line.strip() for line in TEXT.splitlines() if line.startswith("    ") and ".venv/bin/pytest" in line]
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert len(lines) == 2
    assert "apt-get install" in lines[0]
    assert lines[1] == ".venv/bin/pytest -m slow"
    assert [line for line in script if line in lines] == lines


def test_a_newcomer_finishes_it() -> None:
    assert len(TEXT.splitlines()) <= MOST_LINES
