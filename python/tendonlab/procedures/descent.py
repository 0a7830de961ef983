"""Bounded least squares from many points: the parts of `global_search`."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import differential_evolution, least_squares
from tqdm import tqdm

from tendonlab.arguments import samples
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.progress import track

SAME_COST = 1e-4  # relative: starts that end this near the best have found the same optimum
AT_BOUND = 1e-6  # of the range: descents stay inside the box and come as near as this and nearer
STEP = 6e-6  # of the range, for central differences
DEPENDENT = 1e-7  # singular value of the normalised Jacobian, relative to the greatest, that differences call 0


class Found(NamedTuple):
    """Best point in the unit cube, whether its descent converged, in words, and the cost of every start."""

    unit: np.ndarray
    success: bool
    message: str
    costs: np.ndarray


@dataclass(frozen=True)
class Box:
    """The box between the bounds as the unit cube; some edges are logarithmic."""

    lower: np.ndarray
    upper: np.ndarray
    log: np.ndarray

    @classmethod
    def between(cls, lower: ArrayLike, upper: ArrayLike, log: Sequence[bool] | None) -> Box:
        """Raises ParameterError: bounds that are not in order, unequal shapes, a logarithm of what is not above 0."""
        below, above = samples("lower", lower), samples("upper", upper)
        if len(below) != len(above):
            raise ParameterError(f"upper has {len(above)} values: expected {len(below)}, as many as lower")
        chosen = np.zeros(len(below), dtype=bool) if log is None else np.asarray(log, dtype=bool)
        if chosen.shape != below.shape:
            raise ParameterError(f"log has shape {chosen.shape}: expected {below.shape}, one truth value per parameter")
        for k in range(len(below)):
            if not below[k] < above[k]:
                raise ParameterError(f"upper[{k}] = {above[k]}: expected a bound above lower[{k}] = {below[k]}")
            if chosen[k] and below[k] <= 0.0:
                raise ParameterError(f"lower[{k}] = {below[k]}: expected a bound above 0 on a logarithmic scale")
        return cls(below, above, chosen)

    def values(self, unit: np.ndarray) -> np.ndarray:
        """Parameters at a point of the unit cube."""
        straight = self.lower + unit * (self.upper - self.lower)
        bent = self.lower * np.exp(unit * self._decades())
        return np.asarray(np.clip(np.where(self.log, bent, straight), self.lower, self.upper))

    def slope(self, unit: np.ndarray) -> np.ndarray:
        """Derivative of the parameters by the coordinates of the unit cube."""
        return np.asarray(np.where(self.log, self.values(unit) * self._decades(), self.upper - self.lower))

    def _decades(self) -> np.ndarray:
        return np.asarray(np.log(np.where(self.log, self.upper / np.where(self.log, self.lower, 1.0), 1.0)))


class Descent:
    """A residual in the coordinates of the unit cube, and least squares on it."""

    def __init__(self, residual: Callable[[np.ndarray], ArrayLike], box: Box) -> None:
        self._residual = residual
        self._box = box
        self._num: int | None = None  # of residuals
        self._broke = False  # whether the residual was ever not finite

    def __call__(self, unit: np.ndarray) -> np.ndarray:
        row = np.asarray(self._residual(self._box.values(unit)), dtype=float)
        if row.ndim != 1 or not row.size:
            raise ParameterError(f"residual gives shape {row.shape}: expected one row of numbers")
        self._num = len(row) if self._num is None else self._num
        if len(row) != self._num:
            raise ParameterError(f"residual gives {len(row)} numbers: expected {self._num}, as many as before")
        self._broke |= not bool(np.isfinite(row).all())
        return row

    def cost(self, unit: np.ndarray) -> float:
        """Half the sum of squares; infinite where the residual is not finite."""
        with np.errstate(over="ignore", invalid="ignore"):
            cost = 0.5 * float(np.sum(self(unit) ** 2))
        return cost if math.isfinite(cost) else math.inf

    def least(self, start: np.ndarray, *, tolerance: float = 1e-8) -> Any | None:
        """Bounded least squares from `start`; None where the residual is not finite there or on the way."""
        if not math.isfinite(self.cost(start)):
            return None
        self._broke = False
        inside = np.clip(start, 1e-10, 1.0 - 1e-10)
        limits = {"ftol": tolerance, "xtol": tolerance, "gtol": tolerance, "max_nfev": 200 * len(start)}
        try:
            return least_squares(self, inside, bounds=(0.0, 1.0), **limits)
        except ParameterError:
            raise
        except (ValueError, np.linalg.LinAlgError):
            if not self._broke:  # then it is the caller's own
                raise
            return None

    def polish(self, unit: np.ndarray) -> np.ndarray:
        """The optimum to the last digits, and exactly on the bounds that it has come to."""
        end = self.least(unit, tolerance=1e-14)
        best = unit if end is None else min((unit, end.x), key=self.cost)
        snapped = np.where(best < AT_BOUND, 0.0, np.where(best > 1.0 - AT_BOUND, 1.0, best))
        return snapped if self.cost(snapped) <= self.cost(best) * (1.0 + 1e-9) else np.asarray(best)

    def jacobian(self, unit: np.ndarray) -> np.ndarray:
        """By central differences; one-sided at a bound."""
        columns = []
        for k in range(len(unit)):
            ahead, behind = unit.copy(), unit.copy()
            ahead[k], behind[k] = min(unit[k] + STEP, 1.0), max(unit[k] - STEP, 0.0)
            columns.append((self(ahead) - self(behind)) / (ahead[k] - behind[k]))
        return np.column_stack(columns)


def multistart(descent: Descent, points: np.ndarray, progress: bool) -> Found:
    """The best of descents from all `points`. Raises NumericalError where none is finite."""
    ends: list[Any | None] = []
    note = ""
    try:
        for point in track(points, label="search", total=len(points), unit="start", shown=progress):
            ends.append(descent.least(point))
    except KeyboardInterrupt:
        if not any(end is not None for end in ends):
            raise
        note = f"interrupted after {len(ends)} of {len(points)} starts; "
    kept = [end for end in ends if end is not None]
    if not kept:
        raise NumericalError(f"residual is not finite from any of {len(ends)} starts; the bounds may be too wide")
    best = min(kept, key=lambda end: float(end.cost))
    costs = np.array([math.inf if end is None else end.cost for end in ends])
    scale = float(np.median([descent.cost(point) for point in points]))  # on exact data the best cost is 0
    agree = int(np.sum(costs <= best.cost * (1.0 + SAME_COST) + 1e-3 * SAME_COST * min(scale, 1e300)))
    message = f"{note}{agree} of {len(ends)} starts ended at the best cost; {best.message}"
    return Found(best.x, bool(best.success) and not note, message, costs)


def evolution(descent: Descent, points: np.ndarray, generator: np.random.Generator, progress: bool) -> Found:
    """Differential evolution that begins with `points`. Raises NumericalError where no member is finite."""
    with tqdm(desc="search", unit="generation", disable=not progress) as bar:

        def count(*_: Any, **__: Any) -> bool:
            bar.update()
            return False

        bounds = [(0.0, 1.0)] * points.shape[1]
        try:
            found = differential_evolution(
                descent.cost, bounds, init=points, seed=generator, tol=1e-6, polish=False, callback=count
            )
        except RuntimeError as error:  # what scipy makes of any ValueError
            if isinstance(error.__cause__, ParameterError):
                raise error.__cause__ from None
            raise
    if not math.isfinite(found.fun):
        raise NumericalError(f"residual is not finite for any of {len(points)} members; the bounds may be too wide")
    return Found(found.x, bool(found.success), str(found.message), np.asarray(found.population_energies))


def rank_of(jacobian: np.ndarray) -> int:
    """Rank of the Jacobian, and so of jacobian' jacobian; 0 where it is not finite."""
    if not np.isfinite(jacobian).all():
        return 0
    return int(np.linalg.matrix_rank(_normalised(jacobian)[0], tol=DEPENDENT))


def sd_of(jacobian: np.ndarray, residual: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    """Sd of each coordinate for independent noise of the residual's size: NaN where `fixed`, infinite where the data do
    not separate it from others, or are not more than the coordinates."""
    sd = np.full(jacobian.shape[1], math.nan)
    if not np.isfinite(jacobian).all() or fixed.all():
        return sd
    directions, norm = _normalised(jacobian[:, ~fixed])
    _, singular, rows = np.linalg.svd(directions, full_matrices=len(directions) < directions.shape[1])
    known = np.zeros(len(rows), dtype=bool)
    known[: len(singular)] = singular > DEPENDENT
    spare = len(residual) - int(known.sum())
    if spare < 1:
        sd[~fixed] = math.inf
        return sd
    noise = float(residual @ residual) / spare
    variance = noise * np.sum((rows[known] / singular[known[: len(singular)], None]) ** 2, axis=0) / norm**2
    mixed = np.sum(rows[~known] ** 2, axis=0) > 1e-6
    sd[~fixed] = np.where(mixed, math.inf, np.sqrt(variance))
    return sd


def _normalised(jacobian: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Columns of length 1 (0 for what has no effect at all), and their lengths (then 1)."""
    norm = np.linalg.norm(jacobian, axis=0)
    none = norm <= 1e-10 * max(float(norm.max()), 1e-300)
    length = np.where(none, 1.0, norm)
    return np.where(none, 0.0, jacobian) / length, length
