"""The README does what it says: its Python runs, its dataset loads, its commands exist, the CI runs its test line."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import nbformat
import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.cli import commands as cli
from twin import TwinDiagnosis

ROOT = Path(__file__).resolve().parents[1]
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.S)


def test_the_tour_runs_as_written(tmp_path: Path, twin_diagnosis: TwinDiagnosis) -> None:
    """In a process of its own, beside a `data` folder as in a clone; what the demo found is not sought again."""
    (tmp_path / "data").symlink_to(ROOT / "data")
    (code,) = blocks("python")
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", twin_diagnosis.reuse + code],
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


COMMANDS = [
    line.replace("python -m tendonlab.blind", "tendonlab blind")
    for block in blocks("sh")
    for line in block.splitlines()
]


@pytest.mark.parametrize("line", COMMANDS)
def test_commands_exist(line: str) -> None:
    program, *arguments = shlex.split(line)
    assert program == "tendonlab"
    assert cli._parser().parse_args(arguments).run.__name__ != "explain"


def test_options_of_the_build_exist() -> None:
    named = re.findall(r"cmake\.define\.(\w+)=", TEXT)
    cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    assert named
    assert all(f"option({name} " in cmake for name in named)


def test_the_ci_runs_the_line_of_the_readme() -> None:
    (line,) = [line.strip() for line in TEXT.splitlines() if line.endswith("pytest") and "apt-get install" in line]
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert line in script.splitlines()


def test_links_and_figures_are_there() -> None:
    targets = re.findall(r"\]\(([^)#]+)\)", TEXT)
    assert [target for target in targets if "://" not in target and not (ROOT / target).exists()] == []


def test_what_is_said_of_the_papers_can_be_found_in_their_notebooks() -> None:
    """Every section that the table of figures names is a heading of that paper's notebook."""
    headings = {
        path.name[:2].upper(): re.findall(r"^#+ (.*)$", "\n".join(c.source for c in nbformat.read(path, 4).cells), re.M)
        for path in (ROOT / "notebooks").glob("s?_*.ipynb")
    }
    rows = re.findall(r"^\| (S\d) \| ([^|]*) \| ([^|]*) \| [^|]+ \|$", TEXT, re.M)
    assert {paper for paper, _, _ in rows} == set(headings)
    for paper, what, where in rows:
        for section in re.findall(r'"([^"]+)"', re.sub(r"`papers.tables`.*", "", where)):
            assert any(section in heading for heading in headings[paper]), f"{paper} {what}: {section}"
