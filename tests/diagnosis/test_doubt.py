"""How far the gains of single experiments may deceive."""

from __future__ import annotations

import numpy as np
import pytest

from tendonlab.diagnosis.search.trial import doubt


def test_an_effect_that_one_run_alone_shows_is_beyond_doubt() -> None:
    gains = np.array([400.0, 0.0, 1.0, 0.0])
    assert doubt(gains) == 0.0


def test_gains_that_scatter_about_nothing_are_in_doubt() -> None:
    gains = np.array([12.0, -9.0, 7.0, -8.0])
    assert doubt(gains) > gains.sum()
    assert doubt(gains) == pytest.approx(2.0 * np.std(gains, ddof=1) * 2.0)


def test_an_effect_that_costs_other_runs_little_keeps_a_little_doubt() -> None:
    assert doubt(np.array([400.0, -3.0, 2.0, 0.0])) == pytest.approx(15.0)


def test_one_experiment_alone_says_nothing_of_its_doubt() -> None:
    assert doubt(np.array([400.0])) == np.inf
