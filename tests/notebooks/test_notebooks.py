"""Every notebook runs from top to bottom in a fresh kernel, and is kept without its outputs."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from twin import TwinDiagnosis

NOTEBOOKS = sorted((Path(__file__).resolve().parents[2] / "notebooks").glob("*.ipynb"))
LONGEST = 60  # s a cell, on a busy machine
PAPERS = ["s0", "s1", "s2", "s3", "s4"]
WITHIN = "assert len(differences) > 10\nassert differences['within'].all(), differences[~differences['within']]"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_runs(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, twin_diagnosis: TwinDiagnosis) -> None:
    """In an empty folder: a notebook may rely on nothing but the package. What the demo found is not sought again. That
    of a paper leaves its table of differences, all of them within their tolerances."""
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    monkeypatch.setenv("PYDEVD_DISABLE_FILE_VALIDATION", "1")
    notebook = nbformat.read(path, as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell(twin_diagnosis.reuse))
    if path.stem[:2] in PAPERS:
        notebook.cells.append(nbformat.v4.new_code_cell(WITHIN))
    NotebookClient(notebook, timeout=LONGEST, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert [output.text for output in outputs if output.get("name") == "stderr"] == []
    assert any("image/png" in output.get("data", {}) for output in outputs)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_is_stripped(path: Path) -> None:
    for cell in nbformat.read(path, as_version=4).cells:
        assert cell.get("outputs", []) == []
        assert cell.get("execution_count") is None


def test_there_are_notebooks() -> None:
    assert [path.stem[:2] for path in NOTEBOOKS] == [*PAPERS, "st"]
    assert NOTEBOOKS[-1].stem == "start_here"
