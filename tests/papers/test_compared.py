"""Tables of differences: what is within, and where each expected number comes from."""

import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers.compared import PAPER, TWIN, Number, compared, shown


def test_a_number_is_within_its_tolerance_or_beyond_its_bound() -> None:
    table = compared(
        [
            Number("met", "N", PAPER, 1.0, 1.05, 0.1),
            Number("missed", "N", TWIN, 1.0, 1.2, 0.1),
            Number("exceeded", "1", PAPER, 0.5, 0.6, 0.0, bound=True),
            Number("not exceeded", "1", PAPER, 0.5, 0.5, 0.0, bound=True),
            Number("no number", "1", PAPER, 0.5, float("nan"), 1.0),
        ]
    )
    assert table["within"].to_dict() == {
        "met": True, "missed": False, "exceeded": True, "not exceeded": False, "no number": False
    }  # fmt: skip
    assert list(table["status"]) == ["paper", "twin", "paper, lower bound", "paper, lower bound", "paper"]
    assert "1.05" in shown(table).to_html()


def test_an_unknown_status_is_refused() -> None:
    with pytest.raises(ParameterError, match="status = 'printed'"):
        compared([Number("x", "1", "printed", 1.0, 1.0, 0.0)])
