"""docs/papers.md against the notebooks: sections and cells exist, and no figure is left out."""

import re

import nbformat
import pytest

from notebooks.execute import FOLDER
from notebooks.papers_page import Shown, rows, shows

NOTEBOOKS = {path.name[:2].upper(): nbformat.read(path, 4) for path in FOLDER.glob("s?_*.ipynb")}


def test_the_page_speaks_of_all_papers() -> None:
    assert {row.paper for row in rows()} == set(NOTEBOOKS)
    assert len(rows()) > 60


@pytest.mark.parametrize("row", [row for row in rows() if row.cell], ids=lambda row: f"{row.paper} {row.what}")
def test_the_cell_of_a_row_stands_in_its_section(row: Shown) -> None:
    cells = NOTEBOOKS[row.paper].cells
    index = [k for k, cell in enumerate(cells) if cell.id == row.cell]
    assert len(index) == 1, row.cell
    assert cells[index[0]].cell_type == "code"
    before = "\n".join(cell.source for cell in cells[: index[0]] if cell.cell_type == "markdown")
    headings = re.findall(r"^#+ (.*)$", before, re.M)
    assert any(row.section in heading for heading in headings[-2:]), headings[-2:]


def test_ids_are_named_once() -> None:
    for notebook in NOTEBOOKS.values():
        ids = [cell.id for cell in notebook.cells]
        assert len(ids) == len(set(ids))


def test_figures_of_a_range_are_listed_one_by_one() -> None:
    assert Shown("S0", "Fig. 10–12", "", "").labels == ("Fig. 10", "Fig. 11", "Fig. 12")
    assert Shown("S4", "Fig. 8a, 8b", "", "").labels == ("Fig. 8a", "Fig. 8b")
    assert Shown("S4", "Table I, II", "", "").labels == ("Table I", "Table II")
    assert Shown("S0", "eq. (9), relative load", "", "").labels == ()


def test_a_label_is_not_found_in_a_longer_one() -> None:
    assert shows("Fig. 1", "<!-- Fig. 1  Joint -->")
    assert shows("Fig. 5a", "Fig. 5a(1)  Output")
    assert not shows("Fig. 1", "Fig. 12a")
    assert not shows("Table I", "Table II")
