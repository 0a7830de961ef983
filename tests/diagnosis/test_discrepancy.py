"""Whether residuals follow the motion: maps learnt from other experiments predict them, or they do not."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.discrepancy import (
    FAR_SCATTERED,
    FAR_TRAINED,
    FOLLOWED,
    RINGS,
    may_be_noise,
    patterns,
    scattered,
)

TIME = np.linspace(0.0, 10.0, 1000)
RNG = np.random.default_rng(3)


def case(residual: Any) -> Any:
    """Five experiments along different sines, whose residual is that function of position, velocity and experiment."""
    paths = [(np.sin(w * TIME + w), w * np.cos(w * TIME + w)) for w in (1.0, 1.7, 2.3, 3.1, 4.2)]
    runs = [
        {"outputs": np.array([residual(q, v, k)]), "ports": np.array([[v, q, 0.0 * q, 0.0 * q]])}
        for k, (q, v) in enumerate(paths)
    ]
    return SimpleNamespace(
        train=range(5),
        measured=[0],
        scatter=((), ()),
        prepared=[SimpleNamespace(measured=np.zeros((1, len(TIME))), core=SimpleNamespace(time=5.0 + TIME))] * 5,
        system=SimpleNamespace(info=SimpleNamespace(ports=["joint"], steady=False)),
        run=lambda i, *_, **__: runs[i],
    )


MODEL: Any = SimpleNamespace(system=None, initial=[(0.0, 0.0)] * 5, over_scatter=lambda groups: float(groups))


def noise(size: np.ndarray) -> np.ndarray:
    return RNG.standard_normal(len(size))


def slow(q: np.ndarray) -> np.ndarray:
    """With a memory of 0.5 s."""
    return np.convolve(noise(q), np.ones(50) / 50.0, mode="same")


@pytest.mark.parametrize("form", [lambda q, v: np.exp(-(((q - 0.4) / 0.2) ** 2)), lambda q, v: np.sign(v) * q])
def test_what_depends_on_position_and_direction_is_predicted(form: Any) -> None:
    """Half of the mean square is noise: the maps predict the other half."""

    def left(q: np.ndarray, v: np.ndarray, _: int) -> np.ndarray:
        own = form(q, v)
        return own + np.sqrt(np.mean(own**2)) * noise(q)

    assert patterns(case(left), MODEL).followed == pytest.approx(0.5, abs=0.1)
    assert not may_be_noise(case(left), MODEL)


def test_friction_that_drifts_alike_in_every_run_is_predicted() -> None:
    def left(q: np.ndarray, v: np.ndarray, _: int) -> np.ndarray:
        own = np.sign(v) * np.exp(-TIME / 4.0)
        own -= np.sign(v) * np.mean(np.exp(-TIME / 4.0))  # what a fit has left
        return own + np.sqrt(np.mean(own**2)) * noise(q)

    assert patterns(case(left), MODEL).followed == pytest.approx(0.5, abs=0.1)


def ringing(q: np.ndarray, v: np.ndarray, k: int) -> np.ndarray:
    """A resonance of 6 Hz with a quality of 10 that white noise excites: half of the mean square."""
    decay = np.exp(-2.0 * np.pi * 6.0 * TIME / 20.0) * np.sin(2.0 * np.pi * 6.0 * TIME)
    own = np.convolve(noise(q), decay)[: len(q)]
    return own / np.sqrt(np.mean(own**2)) + noise(q)


def test_a_resonance_is_no_noise() -> None:
    rig = case(ringing)
    assert patterns(rig, MODEL).ringing == pytest.approx(0.5, abs=0.2)
    assert patterns(rig, MODEL).frequency == pytest.approx(6.0, rel=0.1)
    assert not may_be_noise(rig, MODEL)


def test_steady_points_have_no_frequencies_and_no_time() -> None:
    """The order of their rows means nothing."""
    drifting, rig = case(lambda q, v, k: TIME - 5.0 + noise(q)), case(ringing)
    assert patterns(drifting, MODEL).followed > FOLLOWED
    drifting.system.info.steady = rig.system.info.steady = True
    assert patterns(drifting, MODEL).followed < FOLLOWED
    assert patterns(rig, MODEL).ringing == 0.0


def test_a_band_in_which_the_rig_is_moved_is_no_resonance() -> None:
    """Friction of another size in every run fills it."""
    rig, signs = case(ringing), iter(range(100))
    fast = 2.0 * np.pi * 6.0
    for run in {id(rig.run(k)): rig.run(k) for k in rig.train}.values():
        sign = (-1.0) ** next(signs)
        run["ports"] = np.array([[np.cos(fast * TIME), np.sin(fast * TIME), 0.0 * TIME, 0.0 * TIME]])
        run["outputs"] = np.array([sign * np.sign(np.cos(fast * TIME)) + noise(TIME)])
    assert patterns(rig, MODEL).ringing < RINGS


def test_how_runs_begin_is_no_drift() -> None:
    """An initial state that is a little wrong leaves the same in every run, soon over."""
    assert patterns(case(lambda q, v, k: np.exp(-TIME / 0.1) + 0.05 * noise(q)), MODEL).followed < FOLLOWED


@pytest.mark.parametrize("left", [lambda q, v, k: noise(q), lambda q, v, k: slow(q), lambda q, v, k: (-1.0) ** k * q])
def test_noise_is_not_predicted(left: Any) -> None:
    """White, slow, or in each experiment of another sign."""
    rig = case(left)
    assert patterns(rig, MODEL).ringing < RINGS
    assert patterns(rig, MODEL).followed < FOLLOWED
    assert may_be_noise(rig, MODEL)


def test_too_much_is_no_noise() -> None:
    large: Any = SimpleNamespace(**{**vars(MODEL), "over_scatter": lambda _: 1.01 * FAR_TRAINED})
    assert not may_be_noise(case(lambda q, v, k: noise(q)), large)


def test_friction_that_differs_too_much_from_run_to_run_is_no_noise() -> None:
    """Factors of two elements behind a state: the second one's rms is 5 %, where 2 % is plausible."""
    factors = [(0.3, 0.01, 0.05 * sign) for sign in (1, -1, 1, -1, 1)]
    wild: Any = SimpleNamespace(**{**vars(MODEL), "initial": factors})
    rig = case(lambda q, v, k: noise(q))
    assert scattered(rig, wild) == pytest.approx(6.25)
    assert not may_be_noise(rig, wild)
    assert scattered(rig, SimpleNamespace(initial=[(0.3, 0.01, 0.02)] * 5)) < FAR_SCATTERED  # type: ignore[arg-type]
    rig.scatter = ()
    assert scattered(rig, wild) == 0.0


def test_samples_that_were_not_measured_and_exact_models_are_no_discrepancy() -> None:
    assert patterns(case(lambda q, v, k: np.where(q > 0.5, np.nan, noise(q))), MODEL).followed < FOLLOWED
    assert patterns(case(lambda q, v, k: 0.0 * q), MODEL).followed == 0.0
    once = case(lambda q, v, k: np.sign(v) if k == 0 else np.nan * q)
    assert patterns(once, MODEL).followed == 0.0  # no other experiment tells
