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


def test_differences_of_rounding_and_large_ones_are_shown_plainly() -> None:
    table = compared([Number("same", "m", PAPER, 0.3, 0.1 + 0.2, 1e-9), Number("large", "N", PAPER, 20.0, 74.7, 501.6)])
    assert table["difference"]["same"] != 0.0
    html = shown(table).to_html()
    assert "e-17" not in html
    assert ">55<" in html
    assert ">502<" in html


def test_an_unknown_status_is_refused() -> None:
    with pytest.raises(ParameterError, match="status = 'printed'"):
        compared([Number("x", "1", "printed", 1.0, 1.0, 0.0)])
