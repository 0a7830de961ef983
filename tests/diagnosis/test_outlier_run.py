"""One training experiment that alone leaves more than noise does not decide."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.answer.outlier_run import OutlierRun, find_outlier_run
from tendonlab.diagnosis.answer.verdict import Levels, decide
from tendonlab.diagnosis.search.contest import Round
from tendonlab.fitting.noise import Floor

FLOOR = Floor(np.array([1.0]), [[]], [1.0], 0.008, repeated=True)


def fit_of(*levels: float, own: float = 0.0) -> Any:
    """A fit whose runs leave these mean squares, of which the share `own` is what their own unknowns cost."""
    runs = [
        SimpleNamespace(residual=np.sqrt((1.0 - own) * level) * np.tile([1.0, -1.0], 50), cost=100.0 * level)
        for level in levels
    ]
    return SimpleNamespace(runs=runs, mean_square=float(np.mean(levels)))


def found(*levels: float, floor: Floor = FLOOR) -> OutlierRun | None:
    names = [SimpleNamespace(name=f"run-{k}") for k in range(1, len(levels) + 2)]
    case: Any = SimpleNamespace(experiments=names, train=range(1, len(levels) + 1))  # the first one is held out
    return find_outlier_run(case, fit_of(*levels), floor)


def test_the_run_that_alone_leaves_more_than_noise_is_named() -> None:
    outlier = found(1.0, 1.1, 3.6, 1.1, 1.0)
    assert outlier is not None
    assert (outlier.run, outlier.name) == (2, "run-4")
    assert (outlier.level, outlier.others) == (pytest.approx(3.6), pytest.approx(1.05))


@pytest.mark.parametrize(
    "levels",
    [
        (1.0, 1.1, 1.9, 1.1, 1.0),  # 1.22 together: at the floor as it is
        (1.0, 1.1, 5.1, 1.1, 1.0),  # no noise does that
        (1.0, 1.6, 3.6, 1.1, 1.0),  # the others are not at the floor
        (1.0, 1.0, 3.6, 1.0),  # too few others
        (1.3, 1.3, 1.4, 1.3, 1.3),  # all are above it
    ],
)
def test_elsewhere_no_run_is_left_out(levels: tuple[float, ...]) -> None:
    assert found(*levels) is None


def test_friction_that_differs_from_run_to_run_counts() -> None:
    """Residuals alone are at the floor: what the runs' own friction costs is not."""
    case: Any = SimpleNamespace(experiments=[], train=range(5))
    assert find_outlier_run(case, fit_of(1.4, 1.4, 1.5, 1.4, 1.4, own=0.3), FLOOR) is None


def test_without_repeats_no_run_is_left_out() -> None:
    floor = Floor(np.array([1.0]), [[]], [1.0], 0.008, repeated=False)
    assert found(1.0, 1.1, 3.6, 1.1, 1.0, floor=floor) is None


@pytest.mark.parametrize(("nominal", "verdict"), [(1.0, "no_gap"), (40.0, "parameters_only")])
def test_the_others_decide(nominal: float, verdict: str) -> None:
    outlier, levels = found(1.0, 1.1, 3.6, 1.1, 1.0), (1.0, 1.1, 3.6, 1.1, 1.0)
    assert outlier is not None
    contest: Any = Round((), (), (), {None: 1.0}, None, frozenset())
    whole = Levels(nominal=nominal * 1.56, tuned=1.56, refitted=1.1, explained=None, left=1.1, repeated=True)
    assert decide([contest], (), whole).verdict == "unknown_effect"
    others = outlier.left_out(whole, fit_of(*(nominal * level for level in levels)))
    assert decide([contest], (), others).verdict == verdict
