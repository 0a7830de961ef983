"""Orders of a shaft: a line where the signal turns with it, at any speed and any spacing."""

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers.s2.orders import order_spectrum

TURNS = np.cumsum(np.random.default_rng(0).uniform(0.0, 0.02, 4000))  # 40 turns, unevenly


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_wave_of_an_order_is_a_line_of_its_amplitude(way: float) -> None:
    values = 3.0 + 0.7 * np.sin(2 * np.pi * 2.0 * TURNS + 0.4) + 0.2 * np.cos(2 * np.pi * 1.0 * TURNS)
    found = order_spectrum(way * TURNS, values)
    assert found.index.tolist() == pytest.approx(np.linspace(0.0, 4.0, 401))
    assert found.idxmax() == pytest.approx(2.0)
    assert found[2.0] == pytest.approx(0.7, rel=0.05)
    assert found[1.0] == pytest.approx(0.2, rel=0.15)
    assert found[3.0] < 0.05
    assert found[0.0] < 0.05  # the mean is taken away


def test_lines_are_as_narrow_as_one_cycle_in_all_turns() -> None:
    turns = np.linspace(0.0, 10.0, 2001)
    found = order_spectrum(turns, np.sin(2 * np.pi * turns), highest=2.0, num_orders=80)
    assert found.index[-1] == 2.0
    assert found[1.1] < 0.02
    assert found[1.05] == pytest.approx(2 / np.pi, rel=0.05)  # half a cycle off


def test_what_has_no_orders_is_refused() -> None:
    assert order_spectrum([0.0, 0.5, 1.0], [1.0, 2.0, 3.0]).size == 401
    with pytest.raises(ParameterError, match=r"turns: 0\.99 covered; expected one or more"):
        order_spectrum([0.0, 0.5, 0.99], [1.0, 2.0, 3.0])
    with pytest.raises(ParameterError, match="values has 2 samples: expected 3"):
        order_spectrum([0.0, 0.5, 1.0], [1.0, 2.0])
    with pytest.raises(ParameterError, match=r"highest = 0\.9"):
        order_spectrum(TURNS, TURNS, highest=0.9)
    with pytest.raises(ParameterError, match="num_orders = 0"):
        order_spectrum(TURNS, TURNS, num_orders=0)
