"""A fit as it is posed: a model, its free parameters and each experiment's own unknowns, against the training
experiments of a case and under one noise floor."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from tendonlab import _core
from tendonlab._core import Free
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import TOLERANCES, Case, fine_enough
from tendonlab.fitting.centred import centred
from tendonlab.fitting.fitted import Fitted, Run
from tendonlab.fitting.floor import Sensitivities, whitenings
from tendonlab.fitting.noise import Floor, blocks_of, white
from tendonlab.fitting.priors import free_parameters, with_scale_held
from tendonlab.fitting.uncertainty import informed
from tendonlab.simulation.system import System

NUM_RESTARTS = 3
NUM_CENTRED = 2  # times that a fit goes on once its friction is centred
MAX_ITERATIONS, NEARLY = 25, 1e-6  # of a fit of a diagnosis
PLAIN = 1e-3  # relative change of the cost at which a fit of single experiments' own unknowns ends
BETTER = 0.99  # share of a run's cost that its own unknowns must at most leave to start again from them


@dataclass(frozen=True, kw_only=True, eq=False)
class Problem:
    """Fits start at the values of `system`. `added`: its effects beyond the nominal ones. `initial`: starting values of
    each training experiment's own unknowns; empty: their prior means."""

    case: Case
    floor: Floor
    system: System
    added: tuple[str, ...] = ()
    free: tuple[Free, ...] = ()
    initial: tuple[tuple[float, ...], ...] = ()

    def solve(self, *, max_iterations: int = 50, tolerance: float = 1e-8, **options: Any) -> Fitted:
        """The model at its optimum; `options` as `_core.fit` has them. Friction that all runs share ends in the
        parameters. Raises NumericalError where a simulation fails
        at the start."""
        options |= {"max_iterations": max_iterations, "tolerance": tolerance}
        fit = self._fitted(_core.fit(*self._stated(), initial=self.initial, **options))
        for _ in range(NUM_CENTRED):
            if (there := centred(self.case, fit, self.tightness)) is None:
                break
            again = self.at(*there)
            better = again._fitted(_core.fit(*again._stated(), initial=again.initial, **options))
            if not better.cost < fit.cost:
                break
            fit = better
        return fit

    def linearise(self) -> Fitted:
        """The model at the start. Raises NumericalError where a simulation fails."""
        return self._fitted(_core.linearise(*self._stated(), initial=self.initial))

    def at(self, system: System, initial: Sequence[Sequence[float]]) -> Problem:
        """The same problem started from these values of its parameters and of the experiments' own unknowns."""
        free = tuple(f.started(system.parameters[f.name]) for f in self.free)
        return replace(self, system=system, free=free, initial=tuple(tuple(own) for own in initial))

    def under(self, level: float) -> Problem:
        """The same problem under noise of `level` times the power."""
        return replace(self, floor=self.floor.under(level))

    def with_fixed(self, name: str, value: float) -> Problem:
        """The same problem with one free parameter held at `value`."""
        free = tuple(f for f in self.free if f.name != name)
        return replace(self, system=self.system.with_parameters({name: value}), free=free)

    def reseated(self, fit: Fitted, cancel: _core.Cancel, *, steps: int = 0, **options: Any) -> Fitted:
        """The `fit` of this problem, again with the initial states of some runs found anew from what is believed of
        them: early steps of a fit may leave a run that starts at rest in a place where stiction holds it. `steps`:
        iterations for these states; `options`: of the new fit, as `solve` has them. From where no simulation runs, no
        run starts anew."""
        for _ in range(NUM_RESTARTS):
            if cancel.is_set() or not any(len(run.own) for run in fit.runs):
                return fit
            try:
                again = self._from_belief(fit, cancel, steps, options)
            except NumericalError:
                return fit
            if again is None or not again.cost < fit.cost:
                return fit
            fit = again
        return fit

    def _from_belief(self, fit: Fitted, cancel: _core.Cancel, steps: int, options: Mapping[str, Any]) -> Fitted | None:
        """The `fit` again, with the runs that fit better so started from what is believed of them; None without any."""
        alone = replace(self, free=(), system=fit.system, initial=())
        fresh = alone.solve(cancel=cancel, max_iterations=steps) if steps else alone.linearise()
        better = [new.cost < BETTER * old.cost for new, old in zip(fresh.runs, fit.runs, strict=True)]
        if not any(better):
            return None
        own = [new if b else old for new, old, b in zip(fresh.initial, fit.initial, better, strict=True)]
        return self.at(fit.system, own).solve(cancel=cancel, **options)

    def return_to_prior(self, fit: Fitted) -> Fitted:
        """The `fit` of this problem with every parameter that the data do not constrain back at its prior's middle.

        A limit that the fit stays clear of constrains nothing there, but may do so at its prior: then it stays."""
        known = np.array(fit.informed)
        while not known.all():
            held = {f.name: f.value(f.mean) for f, seen in zip(self.free, known, strict=True) if not seen}
            there = self.at(fit.system.with_parameters(held), fit.initial).linearise()
            seen_there = known | np.array(there.informed)
            if (seen_there == known).all():
                return replace(
                    there,
                    informed=tuple(known.tolist()),
                    converged=fit.converged,
                    message=fit.message,
                    num_iterations=fit.num_iterations,
                )
            known = seen_there
        return replace(fit, informed=tuple(known.tolist()))

    @property
    def tightness(self) -> float:
        """Factor on the sd of the experiments' own unknowns. Where n samples count as one, all of them together would
        push friction n times as far from run to run as the one allows, to imitate what the model lacks."""
        return float(np.sqrt(self.floor.share))

    def _stated(self) -> tuple[Any, ...]:
        system, case = self.system, self.case
        tasks = [
            case.task(i, self.floor.whitening(case.prepared[i].measured), system, tightness=self.tightness)
            for i in case.train
        ]
        flags = system.active(keep_zero=True)
        return system.kind, system.values(), flags, tasks, self.free, case.settings()

    def _fitted(self, solved: dict[str, Any]) -> Fitted:
        values = {f.name: solved["values"][f.index] for f in self.free}
        return Fitted(
            added=self.added,
            system=self.system.with_parameters(values),
            free=self.free,
            x=np.array(solved["x"]),
            initial=tuple(tuple(own) for own in solved["initial"]),
            runs=tuple(self._run(i, t, solved) for t, i in enumerate(self.case.train)),
            at_bound=tuple(solved["at_bound"]),
            informed=tuple(informed(solved["jacobian"], self.free).tolist()),
            cost=solved["cost"],
            prior_cost=solved["prior_cost"],
            converged=solved["converged"],
            message=solved["message"],
            num_iterations=solved["iterations"],
            levels=self.floor.levels,
            known=np.array(self.floor.known) if self.floor.known else self.floor.levels,
            shares=np.array(self.floor.shares) if self.floor.shares else np.ones(len(self.floor.sd)),
        )

    def _run(self, i: int, t: int, solved: dict[str, Any]) -> Run:
        ready = self.case.prepared[i]
        outputs, samples = self.floor.whitening(ready.measured).cells()
        return Run(
            residual=solved["residuals"][t],
            jacobian=solved["jacobian"][t],
            by_own=solved["jacobian_initial"][t] / self.tightness,
            own=(np.array(solved["initial"][t]) - self.case.own_mean(i)) / self.case.own_sd(i),
            output=outputs,
            block=blocks_of(np.asarray(ready.core.time))[samples],
        )


def finer(problem: Problem, fit: Fitted, cancel: _core.Cancel) -> tuple[Problem, Fitted]:
    """The problem and its `fit`, fitted on from there under finer tolerances as long as the simulator's own error is
    too large there: what is fine enough for the start need not be for the end."""
    for _ in TOLERANCES:
        there = fine_enough(replace(problem.case, system=fit.system), problem.case.noise)
        if there.tolerance >= problem.case.tolerance or cancel.is_set():
            break
        case = replace(problem.case, tolerance=there.tolerance, num_attempts=there.num_attempts)
        problem = replace(problem, case=case)
        fit = problem.at(fit.system, fit.initial).solve(cancel=cancel)
    return problem, fit


def initial_state(case: Case, system: System, i: int) -> tuple[float, ...]:
    """The free parts of the initial state of experiment i, fitted to its first 0.2 s by `system` as it is."""
    first = case.beginning(i)
    mean = tuple(first.own_mean(0).tolist())
    if not mean or not np.isfinite(first.prepared[0].measured[case.measured]).any():
        return mean
    return Problem(case=first, floor=white(case.noise), system=system).solve(max_iterations=10).initial[0]


NUM_RELEVELLED, SAME_LEVEL = 3, 0.05  # refits under the noise that a fit leaves, and the change that is none


@dataclass(frozen=True)
class Fitter:
    """Poses and solves fits of one case under one noise floor."""

    case: Case
    floor: Floor
    cancel: _core.Cancel
    seen: Sequence[Sensitivities] = ()

    @cached_property
    def whitening(self) -> list[_core.Whitening]:
        """Of every experiment; of those held out along what was `seen` to differ from run to run."""
        return whitenings(self.case, self.floor, self.seen)

    def fit(
        self,
        system: System,
        *,
        added: Sequence[str] = (),
        initial: Sequence[Sequence[float]] = (),
        max_iterations: int = MAX_ITERATIONS,
        tolerance: float = NEARLY,
        goal: float = math.inf,
        goal_within: int = 1,
        solve: bool = True,
        known: bool = False,
    ) -> Fitted:
        """Fit `system` from its own values, with priors about the nominal ones, and the `initial` unknowns of each
        experiment. `goal`: a cost; a fit too slow to get below within `goal_within` iterations ends early. `solve`
        False: only linearise there. `known`: fit those unknowns alone."""
        problem = pose(self.case, self.floor, system, added=() if known else added, initial=initial, known=known)
        if not solve:
            return problem.linearise()
        return problem.solve(
            cancel=self.cancel,
            max_iterations=max_iterations,
            tolerance=tolerance,
            goal=goal,
            goal_within=goal_within,
        )

    def settled(self, fit: Fitted) -> Fitted:
        """The fit with its runs reseated. Without repeats: again under the noise that it leaves itself, until that
        stays, or its evidence falls. Its rows count by the memory of its own residuals."""
        fit = self._reseated(fit)
        if self.floor.repeated:
            return fit
        for _ in range(NUM_RELEVELLED):
            if np.allclose(fit.own_levels, fit.levels, rtol=SAME_LEVEL):
                break
            own = replace(self.floor, sd=fit.own_levels.tolist())
            again = replace(self, floor=own).fit(fit.system, added=fit.added, initial=fit.initial)
            if not again.counted().evidence > fit.counted().evidence:
                break
            fit = again
        return fit.counted(fit.own_shares)

    def _reseated(self, fit: Fitted) -> Fitted:
        """The fit, again where some runs fit better from the initial states that are believed of them."""
        floor = replace(self.floor, sd=fit.levels.tolist())
        problem = pose(self.case, floor, fit.system, added=fit.added, initial=fit.initial)
        return problem.reseated(fit, self.cancel, max_iterations=MAX_ITERATIONS, tolerance=NEARLY)

    def releveled(self, fit: Fitted) -> Fitted:
        """Without repeats: the fit as it is, under the noise that it leaves itself."""
        if self.floor.repeated:
            return fit
        there = fit.under(fit.own_levels)
        return there.counted(there.own_shares)

    def left_by(self, model: Fitted) -> Fitter:
        """The fitter whose floor is what `model` leaves; itself where repeats determine the floor."""
        if self.floor.repeated:
            return self
        return replace(self, floor=self.floor.left_by(model.levels, model.shares))

    def under(self, level: float) -> Fitter:
        """The same under noise of `level` times the power, for fits to the training experiments."""
        return replace(self, floor=self.floor.under(level))


def pose(
    case: Case,
    floor: Floor,
    system: System,
    *,
    added: Sequence[str] = (),
    initial: Sequence[Sequence[float]] = (),
    known: bool = False,
) -> Problem:
    """The fit of `system`, which has the effects `added` beyond the nominal ones, from its own values and from the
    `initial` unknowns of each experiment. `known`: its parameters are, and only those unknowns are fitted."""
    rows = [] if known else free_parameters(system, case.dataset.parameters, case.scales, added=added)
    if case.swings_freely:
        rows = with_scale_held(system, rows)
    free = tuple(f.started(system.parameters[f.name]) for f in rows)
    start = tuple(tuple(own) for own in initial)
    return Problem(case=case, floor=floor, system=system, added=tuple(added), free=free, initial=start)
