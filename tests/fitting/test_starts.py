"""Starts of fits: cooling goes on while it helps, and a run that was left in a wrong place starts again."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.cli.demo import bundled
from tendonlab.errors import NumericalError
from tendonlab.fitting import problem as problem_module
from tendonlab.fitting.case import make_case
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter, pose
from tendonlab.fitting.starts import STEPS, annealed
from tendonlab.rehearsal.build import simulated_rig


class Fits:
    """A problem whose fits end at these misfits, one after the other; notes under how much noise."""

    def __init__(self, *misfits: float) -> None:
        self.left, self.levels = list(misfits), []

    def linearise(self) -> Any:
        return self._next()

    def under(self, level: float) -> Any:
        self.levels.append(level)
        return self

    def at(self, system: str, initial: str) -> Any:
        self.started = (system, initial)
        return self

    def solve(self, *, cancel: Any, max_iterations: int, tolerance: float) -> Any:
        assert max_iterations == STEPS
        return self._next()

    def _next(self) -> Any:
        misfit = self.left.pop(0)
        return SimpleNamespace(whitened_square=misfit, system=f"ended at {misfit}", initial=(misfit,))


@pytest.mark.parametrize(
    ("misfits", "levels"),
    [
        ([40.0, 0.2, 0.3, 0.1], [40.0, 8.0, 2.4]),  # until it is near the floor: 0.24
        ([40.0, 0.6], [40.0]),  # a fit that does not halve the misfit ends it
        ([0.5, 0.1], [1.0]),
        ([1e6, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4, 0.4], [1e6, 4e5, 1.6e5, 6.4e4, 2.56e4, 1.024e4]),  # six at the most
    ],
)
def test_cooling_goes_on_while_the_misfit_halves(misfits: list[float], levels: list[float]) -> None:
    fits = Fits(*misfits)
    annealed(fits, _core.Cancel())  # type: ignore[arg-type]
    assert fits.levels == pytest.approx(levels)
    assert fits.started == (f"ended at {misfits[len(levels)]}", (misfits[len(levels)],))


@pytest.mark.cpu(20)
def test_a_run_in_a_wrong_initial_state_starts_again() -> None:
    rig = tl.load(bundled())
    case = make_case(rig, experiments=rig.train)
    right = pose(case, white(case.noise), case.system).solve(max_iterations=20)
    run = next(t for t, one in enumerate(right.runs) if len(one.own))
    wrong = [tuple(np.add(own, 0.2) if t == run else own) for t, own in enumerate(right.initial)]
    problem = pose(case, white(case.noise), right.system)
    there = problem.at(right.system, wrong).linearise()
    assert there.cost > 1.1 * right.cost
    assert problem.reseated(there, _core.Cancel(), steps=2 * STEPS).cost < 1.001 * right.cost
    fitter = Fitter(case, white(case.noise), _core.Cancel())
    assert fitter.settled(there).counted().evidence > fitter.settled(right).counted().evidence - 1.0
    cancel = _core.Cancel()
    cancel.set()
    assert problem.reseated(there, cancel) is there


@pytest.mark.parametrize("fails", ["linearise", "solve"])
def test_a_run_that_cannot_be_simulated_from_elsewhere_stays(fails: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One simulation that ends in an error ended a whole diagnosis."""
    rig = tl.load(bundled())
    case = make_case(rig, experiments=rig.train[:1])
    problem = pose(case, white(case.noise), case.system)
    right = problem.linearise()
    wrong = [tuple(np.add(own, 0.2)) for own in right.initial]
    there = problem.at(case.system, wrong).linearise()
    assert there.cost > right.cost

    def stops(*_: Any, **__: Any) -> Any:
        raise NumericalError("simulation stopped")

    monkeypatch.setattr(problem_module.Problem, fails, stops)
    assert problem.reseated(there, _core.Cancel()) is there


@pytest.mark.slow
@pytest.mark.cpu(200)
def test_fits_of_a_sticking_rig_find_its_values_and_know_how_well() -> None:
    """The simulator identified on the bundled rig, drawn anew with noise and scatter of friction. Intervals hold 89 %
    of 20 draws of 11 values, less than 95: few runs, and friction that jumps. Fits that end in a wrong optimum hold far
    fewer, and a part of them does not converge."""
    rig, effects = tl.load(bundled()), ["joint:stribeck"]
    true = tl.identify(rig, effects=effects, progress=False).system
    drawn, held, count = simulated_rig(rig), 0, 0
    for seed in range(20):
        fit = tl.identify(drawn.noisy(np.random.default_rng(seed), true), effects=effects, progress=False)
        assert fit.converged
        for name, row in fit.parameters.iterrows():
            held += row["ci95_lower"] <= true.parameters[str(name)] <= row["ci95_upper"]
            count += 1
    assert held / count > 0.85, f"{held} of {count}"
