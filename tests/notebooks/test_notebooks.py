"""Notebooks are kept without their outputs, and each has a test that executes it."""

from pathlib import Path

import nbformat
import pytest
from notebooks.execute import FOLDER

NOTEBOOKS = sorted(path.stem for path in FOLDER.glob("*.ipynb"))


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_is_stripped(name: str) -> None:
    for cell in nbformat.read(FOLDER / f"{name}.ipynb", as_version=4).cells:
        assert cell.get("outputs", []) == []
        assert cell.get("execution_count") is None


def test_each_is_executed() -> None:
    here = Path(__file__)
    executed = [path.stem.removeprefix("test_") for path in here.parent.glob("test_*.py") if path != here]
    assert sorted(executed) == NOTEBOOKS
    assert [name[:2] for name in NOTEBOOKS] == ["s0", "s1", "s2", "s3", "s4", "st"]
