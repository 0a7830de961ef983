"""The equation of motion as a regression: its residual, and a column for every number that may differ."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab.checking.equation import Equation, Stretch
from tendonlab.checking.logs import Logs
from tendonlab.checking.regression import MOST_STEPS, Fit, Unknown, fit, growth, impossible
from tendonlab.data import NominalParameter
from tendonlab.fitting.priors import default_log_sd, known_by_default
from tendonlab.simulation.catalog import ParameterInfo

NUDGE = 1e-3  # relative change by which a column is found
EXTRA = 0.3  # of the rms that an equation predicts: sd of offsets, and of friction that the simulator may lack
OFFSET = 0.1  # of the travel: sd of the zero of an angle
LATER = 0.1  # of the step of the logs, by which the column of a lag is found
LATE = 0.02  # s: sd of a lag that an output has in all experiments
LEAST_POWER = 0.01  # to which a parameter must raise what the inputs contribute, to count as a gain

Column = tuple[Unknown, np.ndarray]


@dataclass(frozen=True)
class Terms:
    """`residual` (equations, samples) at the nominal parameters, `columns` (unknowns, equations, samples), `size`: rms
    of what each equation predicts, in the unit of its residual."""

    residual: np.ndarray
    columns: np.ndarray
    unknowns: tuple[Unknown, ...]
    size: np.ndarray

    def slopes(self, x: np.ndarray) -> np.ndarray:
        """What the equations change with each unknown at `x` (unknowns, equations, samples)."""
        return np.asarray(self.columns * growth(x, self.unknowns)[:, None, None])

    def fit(self, share: np.ndarray, *, steps: int = MOST_STEPS) -> Fit:
        """The most probable unknowns; `share` of the samples of each equation counts as independent. Of infinite cost
        where the equations have no value, as far beyond what a simulator was made for."""
        if not np.isfinite(self.residual).all():
            return impossible(len(self.unknowns), self.residual)
        return fit(self.residual, self.columns, self.unknowns, self.size, share, steps=steps)


@np.errstate(all="ignore")  # wrong logs may lead anywhere; what has no value is left out
def terms(equation: Equation, logs: Logs) -> Terms:
    """The regression of `equation` on `logs`; with a lag of each output where the logs are thinned."""
    stretches, num = equation.along(logs), len(logs.run)
    free = _free(equation)
    nudges = {k: _nudge(p, stated) for k, (p, stated, _) in free.items()}
    residual, *moved = equation.nudged(stretches, num, nudges)
    silent, *moved_silent = equation.nudged(
        [s.without_inputs(equation.system, set(logs.driving) - set(equation.prescribed)) for s in stretches],
        num,
        nudges,
    )
    zeros, stiffness = _zeros(equation, logs, stretches, residual)
    size = _size(equation, logs, residual, silent, stiffness)
    rows = []
    for (k, nudge), after, after_silent in zip(nudges.items(), moved, moved_silent, strict=True):
        unstated = _where_free(k, stretches, num)
        slope, driven = (after - residual) / nudge, unstated * (residual - silent)
        grown = unstated * (after - after_silent - residual + silent) / nudge
        gain = _gain(*free[k], unstated * residual, slope, driven, grown)
        rows.append(gain or _believed(*free[k], slope / size[:, None], size))
    rows += [*zeros, *_extras(equation, logs, size)]
    if logs.changing:
        each = zip(equation.measured, slopes_of_lags(equation, logs, residual), strict=True)
        rows += [(Unknown(f"lag of {name}", sd=LATE), slope) for name, slope in each]
    seen = [(u, c) for u, c in rows if np.any(c) and np.isfinite(c).all()]
    columns = np.array([c for _, c in seen]).reshape(len(seen), *residual.shape)
    return Terms(residual, columns, tuple(u for u, _ in seen), size)


def _free(equation: Equation) -> dict[int, tuple[ParameterInfo, NominalParameter, float]]:
    """The parameters that may differ from their nominal values, by their index, and the sd of the logarithm of those
    without a stated one."""
    info = equation.system.info
    stated = [(p, equation.dataset.parameters.get(p.name)) for p in info.parameters]
    return {
        k: (p, nominal, default_log_sd(info, p))
        for k, (p, nominal) in enumerate(stated)
        if nominal is not None and p.name in equation.system.parameters and _is_free(p, nominal)
    }


def _where_free(parameter: int, stretches: Sequence[Stretch], num: int) -> np.ndarray:
    """1 at samples of experiments that do not state the parameter of that index, 0 elsewhere."""
    free = np.ones(num)
    for stretch in stretches:
        if parameter in stretch.under.fixed:
            free[stretch.own] = 0.0
    return free


def _nudge(p: ParameterInfo, stated: NominalParameter) -> float:
    """A small change of a parameter, within its bounds."""
    nudge = NUDGE * (abs(stated.value) or abs(p.typical) or 1.0)
    return nudge if stated.value + nudge <= p.upper else -nudge


def _gain(
    p: ParameterInfo,
    stated: NominalParameter,
    usual: float,
    residual: np.ndarray,
    slope: np.ndarray,
    driven: np.ndarray,
    grown: np.ndarray,
) -> Column | None:
    """A parameter that scales what the inputs contribute: it scales all else in those equations inversely, so that
    residuals stay in the unit of what was logged. If it scaled the inputs, the least gain would leave the least
    residual. `slope`, `grown`: how the residual and what the inputs contribute, `driven`, change with it; nothing where
    an experiment states its value. None for any other parameter, and for one that may have either sign."""
    if stated.value == 0.0 or (p.lower < 0 and p.role != "command_gain"):
        return None
    square = np.sum(np.square(driven), axis=1)
    power = np.sum(grown * driven, axis=1) * stated.value / np.where(square > 0, square, 1.0)
    strongest = float(power[np.argmax(np.abs(power))])
    if abs(strongest) < LEAST_POWER:
        return None
    column = power[:, None] * residual - slope * stated.value
    sd = usual if stated.sd is None else stated.sd / abs(stated.value)
    return Unknown(p.name, sd=sd, logarithm=True), column * np.sign(strongest)


def _size(
    equation: Equation, logs: Logs, residual: np.ndarray, silent: np.ndarray, stiffness: dict[str, np.ndarray]
) -> np.ndarray:
    """Rms of what the inputs contribute to the first equation and an axis to its own; what an output varies."""
    sizes = [rms((residual - silent)[0])] if equation.moved else []
    for k, name in enumerate(equation.moved[1:], start=1):
        sizes.append(rms(stiffness[name][k] * logs.moving[name][0]))
    sizes += [float(np.std(logs.others[name])) for name in equation.others]
    return np.array([size or rms(residual[k]) or 1.0 for k, size in enumerate(sizes)])


def _zeros(
    equation: Equation, logs: Logs, stretches: Sequence[Stretch], residual: np.ndarray
) -> tuple[list[Column], dict[str, np.ndarray]]:
    """Columns of where each angle is zero, and what the equations change with each angle."""
    columns, stiffness = [], {}
    for axis, name in equation.axes.items():
        travel = OFFSET * float(np.std(logs.moving[name][0])) or 1.0
        moved = equation.evaluate([s.shifted(axis, NUDGE * travel) for s in stretches], len(logs.run))
        slope = (moved - residual) / NUDGE
        stiffness[name] = slope / travel
        columns.append((Unknown(f"zero of {name}", sd=1.0), slope))
    return columns, stiffness


def _is_free(p: ParameterInfo, stated: NominalParameter) -> bool:
    """Whether a parameter may differ from its nominal value; a gain or ratio without `sd` is taken at its word."""
    if p.purpose in ("share", "condition") or stated.sd == 0:
        return False
    return stated.sd is not None or not known_by_default(p, stated.value)


def _believed(p: ParameterInfo, stated: NominalParameter, usual: float, slope: np.ndarray, size: np.ndarray) -> Column:
    """What is believed of a parameter: of its logarithm where it cannot be negative, as in a fit. `slope` is relative
    to the equations' `size`."""
    scale = abs(stated.value) or EXTRA / (float(np.max(np.sqrt(np.mean(slope**2, axis=1)))) or 1.0)
    sd = usual if stated.sd is None else stated.sd / scale
    if not stated.value:
        sd = 1.0 if stated.sd is None else sd
        return Unknown(p.name, sd=sd, positive=p.lower >= 0), slope * scale * size[:, None]
    return Unknown(p.name, sd=sd, logarithm=p.lower >= 0 and stated.value > 0), slope * scale * size[:, None]


def _extras(equation: Equation, logs: Logs, size: np.ndarray) -> Iterator[Column]:
    """An offset of every equation, and friction that the simulator may lack. Of every run, where a part moves as
    prescribed: where it began was not logged."""
    for k, unit in enumerate(size):
        parts = [("offset", np.ones(len(logs.run)), False)]
        velocity = sliding(equation, logs, k)
        if velocity is not None:
            parts += [("dry friction", np.sign(velocity), True), ("viscous friction", velocity, True)]
        for name, part, positive in parts:
            column = np.zeros((len(size), len(logs.run)))
            column[k] = part * unit / (rms(part) or 1.0)
            yield Unknown(name, sd=EXTRA, positive=positive), column
        for run in np.unique(logs.run) if equation.prescribed else ():
            column = np.zeros((len(size), len(logs.run)))
            column[k, logs.run == run] = unit
            yield Unknown("start of a run", sd=EXTRA), column


def sliding(equation: Equation, logs: Logs, k: int) -> np.ndarray | None:
    """The velocity that friction in equation k follows: of the axis, or the logged one of a system without degrees of
    freedom."""
    if k < len(equation.moved):
        return np.asarray(logs.moving[equation.moved[k]][1])
    flows = [s.name for s in equation.system.info.inputs if s.dimension == "flow" and s.name in logs.driving]
    return logs.driving[flows[0]][0] if flows and not equation.system.info.dof else None


def slopes_of_lags(equation: Equation, logs: Logs, at: np.ndarray, kept: np.ndarray | None = None) -> np.ndarray:
    """What the equations, which leave `at`, change per second by which each output is taken earlier (outputs,
    equations, samples); `kept`: at these samples alone. Nothing where that turns the direction of dry friction: a jump
    has no slope."""
    nudge = LATER * logs.step
    slopes = np.zeros((len(equation.measured), *at.shape))
    here = logs if kept is None else logs.at(kept)
    for slope, name in zip(slopes, equation.measured, strict=True):
        later = logs.nudged(name, nudge)
        later = later if kept is None else later.at(kept)
        if name in logs.others:  # what it should read stays
            row = equation.predicted.index((name,))
            slope[row] = (later.others[name][0] - here.others[name][0]) / nudge
            continue
        slope[:] = (equation.evaluate(equation.along(later), at.shape[1]) - at) / nudge
        slope[:, here.moving[name][1] * later.moving[name][1] <= 0] = 0.0
    return slopes


def rms(x: np.ndarray) -> float:
    """Root of the mean square; 0 of nothing."""
    return float(np.sqrt(np.mean(np.square(x)))) if x.size else 0.0
