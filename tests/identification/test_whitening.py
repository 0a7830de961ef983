"""The whitening against the dense matrices that it stands for."""

from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.errors import ParameterError

AR = ([0.6, -0.2], [], [0.9])
SD = [0.1, 0.02, np.inf]


@pytest.fixture
def measured() -> np.ndarray:
    values = np.random.default_rng(3).normal(size=(3, 60))
    values[0, 20:25] = np.nan
    values[1, 59] = np.nan
    return values


def dense_filter(measured: np.ndarray) -> np.ndarray:
    """The filter as a matrix on the flattened signals, a row for each sample that counts."""
    rows = []
    for c, (ar, sd) in enumerate(zip(AR, SD, strict=True)):
        for t in range(measured.shape[1]):
            used = np.arange(t - len(ar), t + 1)
            if np.isfinite(sd) and used[0] >= 0 and np.isfinite(measured[c, used]).all():
                row = np.zeros(measured.shape)
                row[c, used] = np.append(-np.array(ar)[::-1], 1.0) / sd
                rows.append(row.ravel())
    return np.array(rows)


def test_filter_is_the_dense_one(measured: np.ndarray) -> None:
    whitening = _core.Whitening(AR, SD, measured)
    dense = dense_filter(measured)
    signals = np.random.default_rng(4).normal(size=(5, *measured.shape))
    assert whitening.rows() == len(dense)
    np.testing.assert_allclose(whitening.apply_many(signals), dense @ signals.reshape(5, -1).T, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(whitening.apply(signals[0]), whitening.apply_many(signals)[:, 0], rtol=1e-15)


def test_run_to_run_directions_are_the_inverse_root_of_their_covariance(measured: np.ndarray) -> None:
    rng = np.random.default_rng(5)
    plain = _core.Whitening(AR, SD, measured)
    directions, spread = rng.normal(size=(plain.rows(), 2)), np.array([0.7, 3.0])
    whitening = _core.Whitening(AR, SD, measured, directions, spread)
    values, vectors = np.linalg.eigh(np.eye(plain.rows()) + directions * spread**2 @ directions.T)
    root = vectors / np.sqrt(values) @ vectors.T
    signals = rng.normal(size=measured.shape)
    np.testing.assert_allclose(whitening.apply(signals), root @ plain.apply(signals), rtol=1e-10, atol=1e-10)


def test_a_random_effect_is_the_inverse_root_of_its_covariance() -> None:
    """Also along directions that depend on each other, and along none."""
    rng = np.random.default_rng(8)
    directions = rng.normal(size=(30, 3)) * [0.1, 2.0, 50.0]
    directions = np.column_stack([directions, directions[:, 0]])
    covariance = np.eye(30) + directions @ directions.T
    values, vectors = np.linalg.eigh(covariance)
    root, rows = vectors / np.sqrt(values) @ vectors.T, rng.normal(size=(30, 4))
    effect = _core.RandomEffect(directions)
    np.testing.assert_allclose(effect.whiten(rows), root @ rows, atol=1e-12)
    np.testing.assert_allclose(effect.whiten(rows[:, 1]), root @ rows[:, 1], atol=1e-12)
    assert effect.volume == pytest.approx(np.linalg.slogdet(covariance)[1])
    nothing = _core.RandomEffect(np.zeros((30, 0)))
    assert np.array_equal(nothing.whiten(rows), rows)
    assert nothing.volume == 0.0


def test_rows_of_a_random_effect_must_fit() -> None:
    with pytest.raises(ParameterError, match=r"expected \(30\) or \(30, m\)"):
        _core.RandomEffect(np.zeros((30, 1))).whiten(np.zeros(29))


def test_coloured_noise_becomes_white() -> None:
    """A simulated AR(2) process leaves innovations of unit variance without correlation."""
    rng = np.random.default_rng(6)
    noise = np.zeros((1, 20000))
    for t in range(2, noise.shape[1]):
        noise[0, t] = 1.2 * noise[0, t - 1] - 0.5 * noise[0, t - 2] + 0.03 * rng.normal()
    white = _core.Whitening([[1.2, -0.5]], [0.03], noise).apply(noise)
    assert np.var(white) == pytest.approx(1.0, abs=0.04)  # four standard errors, sqrt(2 / 20000)
    assert np.corrcoef(white[1:], white[:-1])[0, 1] == pytest.approx(0.0, abs=0.03)


def test_residual_is_the_whitened_difference(measured: np.ndarray) -> None:
    whitening = _core.Whitening(AR, SD, measured)
    assert not whitening.residual(np.nan_to_num(measured)).any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"sd": [np.inf] * 3}, "sd: no channel"),
        ({"ar": [[], []]}, "ar of 2 channels: expected 3"),
        ({"ar": [[np.nan], [], []]}, r"ar\[0\] = nan"),
        ({"ar": [[0.1] * 60, [], []]}, "channel 0: no 61 samples in a row"),
        ({"directions": np.ones((2, 1)), "spread": [1.0]}, r"directions of shape \(2, 1\)"),
        ({"directions": np.ones((2, 1))}, "directions of shape"),
    ],
)
def test_what_cannot_be_whitened_is_told(measured: np.ndarray, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        _core.Whitening(**{"ar": AR, "sd": SD, "measured": measured, **arguments})


def test_signals_of_another_shape_are_refused(measured: np.ndarray) -> None:
    with pytest.raises(ParameterError, match=r"signals of shape \(2, 60\): expected \(3, 60\)"):
        _core.Whitening(AR, SD, measured).residual(np.zeros((2, 60)))
