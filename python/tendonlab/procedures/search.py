"""Global search for the parameters of a model that is not convex (S0: eq. 11)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import qmc

from tendonlab.arguments import choice, whole
from tendonlab.procedures.descent import AT_BOUND, Box, Descent, evolution, multistart, rank_of, sd_of
from tendonlab.seed import generator

if TYPE_CHECKING:
    from matplotlib.axes import Axes

METHODS = ("multistart", "evolution")


@dataclass(frozen=True, kw_only=True, eq=False)
class SearchResult:
    """What `global_search` found.

    `values`: the best parameters. `cost`: half the sum of squares of `residual` there. `jacobian`: of the residual by
    the values, shape (residuals, parameters). `hessian_rank`: rank of jacobian' jacobian; less than the number of
    parameters means that the data cannot separate some of them. `sd`: of each value for independent noise of the
    residuals' size; NaN at a bound, infinite where not identified. `at_bound`: values that ended at a bound; they count
    as fixed for the sd of the others. `success`, `message`: whether the best start converged, and how many agree.
    `costs`: where each start (or member of the last generation) ended, infinite where it failed."""

    values: np.ndarray
    cost: float
    residual: np.ndarray = field(repr=False)
    jacobian: np.ndarray = field(repr=False)
    hessian_rank: int
    sd: np.ndarray
    at_bound: np.ndarray
    success: bool
    message: str
    costs: np.ndarray = field(repr=False)

    def to_dict(self) -> dict[str, Any]:
        """The same as plain numbers, without residual and Jacobian."""
        plain = {name: getattr(self, name).tolist() for name in ("values", "sd", "at_bound", "costs")}
        return plain | {name: getattr(self, name) for name in ("cost", "hessian_rank", "success", "message")}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Costs of all starts in order: a long flat beginning means that many starts reached the same optimum."""
        from matplotlib import pyplot as plt

        ax = plt.gca() if ax is None else ax
        finite = np.sort(self.costs[np.isfinite(self.costs)])
        ax.plot(np.arange(1, len(finite) + 1), finite, ".")
        ax.set(xlabel="start, in order of cost", ylabel="cost (half the sum of squares)")
        return ax


def global_search(
    residual: Callable[[np.ndarray], ArrayLike],
    lower: ArrayLike,
    upper: ArrayLike,
    *,
    starts: int = 60,
    method: str = "multistart",
    seed: int | np.random.Generator = 0,
    log: Sequence[bool] | None = None,
    progress: bool = False,
) -> SearchResult:
    """Parameters between `lower` and `upper`, shape (p,), that minimise the sum of squares of `residual(values)`.

    "multistart": bounded least squares from `starts` points of a Latin hypercube. "evolution": differential evolution
    with `starts` members, then bounded least squares. `log`, shape (p,): parameters that are searched on a logarithmic
    scale; their lower bounds must be above 0. `residual` takes the values, shape (p,), and gives numbers, shape (m,),
    best divided by their noise's sd. Same `seed`, same result. Ctrl-C keeps the best start so far.

    Raises ParameterError: bounds that are not finite or not in order, unequal shapes, `starts` below 1 (5 for
    "evolution"), no `seed`, a residual that is no vector of numbers, or
    whose length changes; NumericalError: no start has a finite residual. Source: S0
    section 5 (at least 60 starts, or differential evolution; the rank of the Hessian)."""
    choice("method", method, METHODS)
    whole("starts", starts, 5 if method == "evolution" else 1)
    box = Box.between(lower, upper, log)
    descent = Descent(residual, box)
    rng = generator(seed)
    points = qmc.LatinHypercube(d=len(box.lower), seed=rng).random(starts)
    if method == "multistart":
        unit, success, message, costs = multistart(descent, points, progress)
    else:
        unit, success, message, costs = evolution(descent, points, rng, progress)
    unit = descent.polish(unit)
    values, slope, by_unit = box.values(unit), box.slope(unit), descent.jacobian(unit)
    at_bound = (unit < AT_BOUND) | (unit > 1.0 - AT_BOUND)
    left = descent(unit)
    return SearchResult(
        values=values,
        cost=0.5 * float(left @ left),
        residual=left,
        jacobian=by_unit / slope,
        hessian_rank=rank_of(by_unit),
        sd=sd_of(by_unit, left, at_bound) * slope,
        at_bound=at_bound,
        success=success,
        message=message if np.isfinite(by_unit).all() else f"{message}; the residual is not smooth there",
        costs=costs,
    )
