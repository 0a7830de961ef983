"""Bands of S2's bushing forces: as wide as what the parameters and the sensor leave open."""

import numpy as np
import pytest

from tendonlab.papers import s2
from tendonlab.papers.s2.forces import BRANCHES, covariance_of, force_band

BRANCH = dict(s2.constants().bushings[0])
ANGLE = np.linspace(0.2, 1.4, 7)
SENSE = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0])


def band(covariance: np.ndarray, **options: float) -> tuple[np.ndarray, np.ndarray]:
    return force_band(BRANCH, covariance, ANGLE, SENSE, tension=250.0, **options)


def force(values: dict[str, float]) -> np.ndarray:
    return np.asarray(s2.bushing_law(values).force(velocity=SENSE, wrap_angle=ANGLE, load=250.0))


def test_a_band_lies_around_the_force_and_is_that_of_the_sensor_where_the_law_is_known() -> None:
    lower, upper = band(np.zeros((8, 8)), noise_sd=1.5)
    assert 0.5 * (lower + upper) == pytest.approx(force(BRANCH))
    assert upper - lower == pytest.approx(np.full(7, 2 * 1.959964 * 1.5))
    lower, upper = band(np.zeros((8, 8)), noise_sd=1.5, confidence=0.5)
    assert upper - lower == pytest.approx(np.full(7, 2 * 0.674490 * 1.5), rel=1e-5)


def test_a_band_is_what_drawn_parameters_scatter() -> None:
    rng = np.random.default_rng(2)
    sd = 1e-3 * np.abs([BRANCH[name] for name in BRANCHES])
    correlated = np.outer(sd, sd) * np.where(np.eye(8, dtype=bool), 1.0, 0.4)
    draws = rng.multivariate_normal([BRANCH[name] for name in BRANCHES], correlated, size=2000)
    forces = np.array([force(dict(zip(BRANCHES, row, strict=True))) for row in draws])
    lower, upper = band(correlated, noise_sd=0.0)
    assert (upper - lower) / (2 * 1.959964) == pytest.approx(np.std(forces, axis=0), rel=0.06)  # of 2000 draws


def test_half_widths_are_quantiles_of_the_sd() -> None:
    halves = {name: 0.1 * (k + 1) for k, name in enumerate(BRANCHES)}
    found = covariance_of(halves)
    assert np.sqrt(np.diag(found)) == pytest.approx(0.1 * np.arange(1, 9) / 1.959964)
    assert np.count_nonzero(found - np.diag(np.diag(found))) == 0
    assert np.sqrt(covariance_of(halves, confidence=0.5)[0, 0]) == pytest.approx(0.1 / 0.674490, rel=1e-5)
