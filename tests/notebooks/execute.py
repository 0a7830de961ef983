"""Run a notebook from top to bottom in a fresh kernel and an empty folder: it may rely on nothing but the package."""

import re
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbclient import NotebookClient

from diagnoses import HOOK
from notebooks import papers_page

FOLDER = Path(__file__).resolve().parents[2] / "notebooks"
LONGEST = 300  # s per cell, on a busy machine
LARGEST = 1_200_000  # characters of what is shown; nbconvert adds a third and 0.4 MB: a page stays below 2 MB
WIDEST = 9.0 * 72.0  # points
WITHIN = "assert len(differences) > 10\nassert differences['within'].all(), differences[~differences['within']]"


def execute(name: str, folder: Path, monkeypatch: pytest.MonkeyPatch, *, last: str = "pass") -> None:
    """Run the notebook `name`, whose diagnoses are shared with the tests, in `folder`, then the code `last`.

    It writes nothing to stderr and draws at least one figure, none wider than 9 inches; no table shows NaN. What
    docs/papers.md names is shown by the cell that it names, and the page is no larger than 2 MB."""
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    monkeypatch.setenv("PYDEVD_DISABLE_FILE_VALIDATION", "1")
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    notebook.cells.insert(0, nbformat.v4.new_code_cell(HOOK))
    notebook.cells.append(nbformat.v4.new_code_cell(last))
    NotebookClient(notebook, timeout=LONGEST, resources={"metadata": {"path": str(folder)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert [output.text for output in outputs if output.get("name") == "stderr"] == []
    assert any(kind in output.get("data", {}) for output in outputs for kind in ("image/svg+xml", "image/png"))
    texts = {cell.id: "\n".join(_text(output) for output in cell.get("outputs", [])) for cell in notebook.cells}
    for row in papers_page.rows():
        if row.cell and name.startswith(row.paper.lower()):
            assert texts[row.cell], row
            assert [label for label in row.labels if not papers_page.shows(label, texts[row.cell])] == []
    assert sum(map(len, texts.values())) < LARGEST
    shown = "\n".join(texts.values())
    assert [width for width in map(float, re.findall(r'<svg [^>]*?width="([0-9.]+)pt"', shown)) if width > WIDEST] == []
    assert not re.search(r">\s*nan\s*<|<[\w.]+ object at ", shown, re.I)


def _text(output: Any) -> str:
    """What a page shows of an output: the drawing as SVG, whose comments hold its texts, else HTML, else plain text."""
    data = output.get("data", {})
    shown = next((data[kind] for kind in ("image/svg+xml", "text/html", "text/plain") if kind in data), "")
    return f"{shown}{output.get('text', '')}"
