"""The first noise floor, the fit from which it follows, and the fit that the search starts from."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.diagnosis.answer.notes import _on_the_floor
from tendonlab.diagnosis.floor import renewed
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.floor import Sensitivities, estimate, with_steady_starts
from tendonlab.fitting.problem import Fitter
from tendonlab.fitting.rough import rough_fit


@pytest.mark.parametrize("is_at_bound", [False, True])
def test_a_rough_fit_that_ends_at_a_bound_is_made_under_noise_as_large_as_its_misfit(
    is_at_bound: bool, twin_case: Any, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It then starts again at what is stated, and ends near it."""
    ended = replace(nominal, at_bound=(is_at_bound,) * len(nominal.free))
    monkeypatch.setattr(Fitter, "fit", lambda self, system, **options: ended)
    fit = rough_fit(twin_case, _core.Cancel())
    assert (fit is not ended) == is_at_bound
    if is_at_bound:
        assert not any(fit.at_bound)
        assert fit.mean_square < 0.5 * 20**2 * nominal.mean_square  # in units of noise that is 20 times less
        sds = [abs(x - f.mean) / f.sd for f, x in zip(fit.free, fit.x, strict=True)]
        assert np.max(sds) < 5.0


def test_with_repeats_too_a_run_in_a_wrong_initial_state_starts_again_before_the_search() -> None:
    fitter: Any = SimpleNamespace(floor=SimpleNamespace(repeated=True), settled=lambda model: f"{model}, settled")
    pool: Any = None
    model: Any = "model"
    assert renewed(fitter, model, pool) == (fitter, "model, settled")


@pytest.mark.parametrize("differs", [0.0, 0.01, 3.0])
def test_no_floor_is_below_the_rounding_of_coarse_readings(twin_case: Any, differs: float) -> None:
    """Rounding that repeats does not show in repeats: rms differences of `differs` times its sd."""
    signals = dict(twin_case.dataset.signals)
    c = twin_case.measured[0]
    step = 1e-3
    signals[twin_case.outputs[c]] = replace(signals[twin_case.outputs[c]], resolution=step)
    case = replace(twin_case, dataset=replace(twin_case.dataset, signals=signals))
    rounding, draw = step / np.sqrt(12.0), np.random.default_rng(0)
    seen = []
    for ready in case.prepared:
        residual = differs * rounding * draw.standard_normal(ready.measured.shape)
        residual += 0.2 * step * (differs == 0.0) * (len(seen) % 2)  # a constant is no noise of single samples
        none = np.zeros((0, *ready.measured.shape))
        seen.append(Sensitivities(residual, none, none))
    floor = estimate(case, seen, case.train)
    assert floor.repeated
    assert floor.rms[c] == pytest.approx(max(differs, 1.0) * rounding, rel=0.03)
    assert floor.sd[c] == pytest.approx(max(differs, 1.0) * rounding, rel=0.03)


def test_friction_that_moves_next_to_nothing_differs_by_no_large_factor(twin_case: Any) -> None:
    """Friction that a rough fit put near zero could explain any noise by a huge factor."""
    draw = np.random.default_rng(1)
    seen = []
    for ready in twin_case.prepared:
        residual = twin_case.noise[:, None] * draw.standard_normal(ready.measured.shape)
        direction = 1e-9 * twin_case.noise[:, None] * draw.standard_normal((1, *ready.measured.shape))
        seen.append(Sensitivities(residual, direction, direction[:0]))
    assert estimate(twin_case, seen, twin_case.train).tau < 0.01


def test_an_assumed_floor_is_that_of_the_experiments_that_models_are_judged_by(twin_case: Any) -> None:
    """A release in training that a little friction moves far must not hide an error in a slow held-out experiment."""
    case = replace(twin_case, experiments=tuple(replace(e, repeat=None) for e in twin_case.experiments))
    seen = []
    for i, ready in enumerate(case.prepared):
        noise = np.broadcast_to(case.noise[:, None], ready.measured.shape)
        moved = (50.0 if i in case.test else 5000.0) * noise[None]  # by a friction twice as large
        seen.append(Sensitivities(np.array(noise), moved, moved[:0]))
    floor = estimate(case, seen, case.train)
    assert not floor.repeated
    assert floor.rms[case.measured] == pytest.approx(np.sqrt(2.0) * case.noise[case.measured])


@pytest.mark.parametrize(
    ("kind", "phase", "repeats"),
    [
        ("injection", 0.3, True),
        ("injection", 1.5, False),
        ("controller", 1.5, True),
    ],
)
def test_runs_whose_commands_differ_do_not_repeat(twin_case: Any, kind: str, phase: float, repeats: bool) -> None:
    """A loop in a limit cycle has another phase each time; a simulated loop needs the same reference only."""

    again = [e.name for e in twin_case.experiments if e.repeat is not None]

    def shifted(e: Any) -> Any:
        late = phase * again.index(e.name) if e.name in again else 0.0
        return replace(e, data=e.data.assign(motor_torque=0.2 * np.sin(2.0 * np.pi * 3.0 * e.time + late)))

    case = replace(
        twin_case,
        replay=replace(twin_case.replay, kind=kind),
        experiments=tuple(map(shifted, twin_case.experiments)),
    )
    draw = np.random.default_rng(2)
    seen = []
    for ready in case.prepared:
        none = np.zeros((0, *ready.measured.shape))
        seen.append(Sensitivities(case.noise[:, None] * draw.standard_normal(ready.measured.shape), none, none))
    floor = estimate(case, seen, case.train)
    assert floor.repeated == repeats
    assert any("marked as repeats do not repeat" in said for said in _on_the_floor(case, floor)) != repeats


@pytest.mark.parametrize("away", [0.0, 30.0])
def test_repeats_that_a_wrong_model_starts_from_other_places_show_what_they_do_from_believed_ones(
    twin_case: Any, away: float
) -> None:
    """Without the friction that stops them, a model may start each repeat so that it ends where the log does."""
    draw, seen, believed = np.random.default_rng(3), [], {}
    for i, ready in enumerate(twin_case.prepared):
        noise = twin_case.noise[:, None] * draw.standard_normal(ready.measured.shape)
        start = away * (-1.0) ** i * twin_case.noise[:, None] * np.exp(-np.linspace(0.0, 9.0, noise.shape[1]))
        none = np.zeros((0, *noise.shape))
        seen.append(Sensitivities(start - noise, none, none))
        believed[i] = Sensitivities(-noise, none, none)
    chosen = with_steady_starts(twin_case, seen, believed)
    if away == 0.0:
        assert all(a is b for a, b in zip(chosen, seen, strict=True))
    floor = estimate(twin_case, chosen, twin_case.train)
    assert floor.repeated
    assert floor.rms[twin_case.measured] == pytest.approx(twin_case.noise[twin_case.measured], rel=0.05)
    none_known = with_steady_starts(twin_case, seen, {})
    assert all(a is b for a, b in zip(none_known, seen, strict=True))
