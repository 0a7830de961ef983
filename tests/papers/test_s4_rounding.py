"""Intervals that count what the encoders of S4's rig round away."""

import numpy as np
import pandas as pd
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s4

FREE = ("cable_stiffness", "pretension", "friction_coefficient", "contact_coefficient_asymmetry")
FREE += ("contact_viscous", "bristle_stiffness")


@pytest.fixture(scope="module")
def truth() -> pd.DataFrame:
    return s4.run_rig(s4.case("E1"))


def found(truth: pd.DataFrame, seed: int, *, num_replicates: int = 20) -> pd.DataFrame:
    model = s4.case("E1").model()
    start = s4.tension_simulator(model.mechanism, model.contact)
    reading = s4.measured(truth, seed=seed, jitter=s4.JITTER)
    options = {"free": FREE, "drive": s4.printed_drive(), "inertia": model.mechanism.J, "seed": 1000 + seed}
    fit = s4.fit_rounded(reading, start, num_replicates=num_replicates, **options)
    return fit.assign(twin=[start.parameters[name] for name in fit.index])


@pytest.mark.cpu(30)
def test_the_bias_is_seen_and_taken_off(truth: pd.DataFrame) -> None:
    """Bristle stiffness and viscous friction are read too small, by 1 % each, and corrected."""
    fit = found(truth, 0, num_replicates=8)
    for name in ("bristle_stiffness", "contact_viscous"):
        row = fit.loc[name]
        assert -0.03 < row["bias"] / row["twin"] < 0.0
        assert row["value"] == pytest.approx(row["twin"], rel=0.03)
    assert (fit["ci95_lower"] < fit["value"]).all()
    assert (fit["value"] < fit["ci95_upper"]).all()


@pytest.mark.slow
def test_the_intervals_cover(truth: pd.DataFrame) -> None:
    """Of 120 intervals, six parameters by twenty seeds, 89 to 99 % hold the twin, none wider than 1.5 times the spread
    demands."""
    fits = [found(truth, seed, num_replicates=12) for seed in range(20)]
    held = np.array([(fit["ci95_lower"] <= fit["twin"]) & (fit["twin"] <= fit["ci95_upper"]) for fit in fits])
    assert 0.89 <= held.mean() <= 0.99
    spread = np.std([fit["value"] for fit in fits], axis=0, ddof=1)
    width = np.mean([fit["ci95_upper"] - fit["ci95_lower"] for fit in fits], axis=0)
    assert np.all(width <= 1.5 * 2 * 1.96 * spread)


def test_too_few_replicates_are_refused(truth: pd.DataFrame) -> None:
    with pytest.raises(ParameterError, match="num_replicates = 2"):
        found(truth, 0, num_replicates=2)
