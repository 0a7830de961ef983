"""The result of `identify`: fitted values with honest uncertainty, and profiles on demand."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from numbers import Integral
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from tendonlab.arguments import whole
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.fitting.problem import Problem
from tendonlab.identification.samples import samples
from tendonlab.seed import generator
from tendonlab.simulation.equality import EqualByFields
from tendonlab.simulation.system import System

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HARDLY = 0.9  # of an output's rms about its mean: a fit that leaves more explains next to nothing of it


@dataclass(frozen=True, kw_only=True, eq=False)
class Identification(EqualByFields):
    """What `identify` found.

    `parameters`: indexed by name; value, nominal (0 where the simulator had none), sd, ci95_lower, ci95_upper, unit,
    at_bound, informed. Where no measured sample depends on a parameter, it is not informed: held at its nominal value,
    with the sd and interval of its prior. `correlations`: of the free parameters' coordinates. `residuals`: for each
    experiment a frame by time, s, with a column an output, in noise sd. `errors`: by output, over all experiments;
    rms_error, and beside it spread, the rms of what was measured about its mean in each experiment, both in unit.
    `initial`: fitted initial states by experiment. `system`: the simulator with the fitted values. `cost`: half the sum
    of squared residuals, priors included. `warnings`: those of the dataset."""

    system: System
    parameters: pd.DataFrame
    correlations: pd.DataFrame = field(repr=False)
    residuals: dict[str, pd.DataFrame] = field(repr=False)
    errors: pd.DataFrame = field(repr=False)
    initial: dict[str, dict[str, float]] = field(repr=False)
    noise_sd: dict[str, float] = field(repr=False)
    cost: float
    prior_cost: float
    converged: bool
    message: str = field(default="", repr=False)
    num_iterations: int = 0
    warnings: tuple[str, ...] = field(default=(), repr=False)
    problem: Problem = field(repr=False, compare=False)  # what the other fields were computed from

    @property
    def values(self) -> dict[str, float]:
        """Fitted values by name."""
        return {str(name): float(value) for name, value in self.parameters["value"].items()}

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Parameters that ended at a bound: their data want to go further."""
        return tuple(str(name) for name in self.parameters.index[self.parameters["at_bound"]])

    @property
    def not_informed(self) -> tuple[str, ...]:
        """Parameters that these data say nothing about."""
        return tuple(str(name) for name in self.parameters.index[~self.parameters["informed"]])

    @property
    def missed(self) -> tuple[str, ...]:
        """Outputs that the fit predicts hardly better than a constant in each experiment would."""
        rows = self.errors.iterrows()
        return tuple(str(name) for name, row in rows if row["rms_error"] > HARDLY * row["spread"] > 0)

    def ci95(self, name: str) -> tuple[float, float]:
        """Interval that holds the parameter in 95 % of such data. Raises ParameterError for one that was not fitted."""
        self._require(name)
        lower, upper = self.parameters["ci95_lower"], self.parameters["ci95_upper"]
        return float(lower[name]), float(upper[name])

    def samples(self, num_points: int, *, seed: int | np.random.Generator = 0) -> pd.DataFrame:
        """Values of the fitted parameters that agree with the data about as well, one point per row, for `tl.sweep`.

        They are normal about the fit in its coordinates (the logarithm of a parameter that the fit keeps positive),
        with its sd and correlations. A draw with any value outside its bounds is rejected and drawn anew. Parameters at
        a bound and those not informed stay at their values. Raises ParameterError for a number below 1."""
        whole("num_points", num_points, 1)
        drawn = pd.DataFrame({name: np.full(num_points, value) for name, value in self.values.items()})
        moving = self.parameters.index[self.parameters["informed"] & ~self.parameters["at_bound"]]
        free = [f for f in self.problem.free if f.name in moving]
        names = [f.name for f in free]
        value, sd = (self.parameters.loc[names, column].to_numpy(dtype=float) for column in ("value", "sd"))
        correlations = self.correlations.loc[names, names].to_numpy(dtype=float)
        drawn[names] = samples(free, value, sd, correlations, num=num_points, random=generator(seed))
        return drawn

    def profile(self, name: str, *, num_points: int = 9, reach: float = 3.0) -> pd.DataFrame:
        """Profile likelihood of one parameter: columns value, cost (over the optimum's, in nats) and converged, over
        `reach` standard deviations to either side within bounds, all other parameters refitted at each point.

        Raises ParameterError for a parameter that was not fitted, fewer than 2 points or a reach that is no positive
        number. The nats count the stated noise as independent; `sd` and `ci95` do not."""
        self._require(name)
        if not isinstance(num_points, Integral) or num_points < 2:
            raise ParameterError(f"num_points = {num_points!r}: expected at least 2, a whole number")
        if not 0 < reach < np.inf:
            raise ParameterError(f"reach = {reach}: expected a positive number of standard deviations")
        free = next(f for f in self.problem.free if f.name == name)
        value, sd = self.values[name], float(self.parameters["sd"][name])
        centre, width = free.coordinate(value), sd / free.slope(free.coordinate(value))
        inside = [free.value(centre + reach * width * s) for s in np.linspace(-1, 1, num_points)]
        points = sorted({min(max(v, free.lower), free.upper) for v in inside} | {value})
        rows = []
        for outward in ([v for v in points if v >= value], [v for v in reversed(points) if v < value]):
            at = self.problem
            for point in outward:  # each from its inner neighbour
                fit = at.with_fixed(name, point).solve()
                at = at.at(fit.system, fit.initial)
                x = free.coordinate(point)
                prior = 0.5 * ((x - free.mean) / free.sd) ** 2 if np.isfinite(free.sd) else 0.0
                rows.append((point, fit.cost + prior - self.cost, fit.converged))
        return pd.DataFrame(sorted(rows), columns=["value", "cost", "converged"])

    def plot(self, ax: Axes | None = None, *, experiment: str | None = None) -> Axes:
        """Draw the residuals of one experiment (the first unless named), an output a line, in noise sd."""
        import matplotlib.pyplot as plt

        name = next(iter(self.residuals)) if experiment is None else experiment
        if name not in self.residuals:
            raise ParameterError(f"experiment {name!r} was not fitted; {expected_one_of(name, list(self.residuals))}")
        ax = plt.gca() if ax is None else ax
        for output, values in self.residuals[name].items():
            ax.plot(values.index, values, lw=0.8, label=str(output))
        ax.set(xlabel="time (s)", ylabel="residual (noise sd)", title=name)
        ax.legend()
        return ax

    def to_dict(self) -> dict[str, Any]:
        """Plain types, without the residuals; None for what nothing bounds."""
        rows: Mapping[str, Mapping[str, Any]] = self.parameters.to_dict(orient="index")  # type: ignore[assignment]
        return {
            "system": self.system.to_dict(),
            "converged": self.converged,
            "message": self.message,
            "num_iterations": self.num_iterations,
            "cost": self.cost,
            "prior_cost": self.prior_cost,
            "parameters": {
                name: {
                    "value": row["value"],
                    "nominal": row["nominal"],
                    "sd": _bounded(row["sd"]),
                    "unit": row["unit"],
                    "ci95": [_bounded(row["ci95_lower"]), _bounded(row["ci95_upper"])],
                    "at_bound": bool(row["at_bound"]),
                    "informed": bool(row["informed"]),
                }
                for name, row in rows.items()
            },
            "errors": self.errors.to_dict(orient="index"),
            "correlations": self.correlations.to_dict(),
            "initial": self.initial,
            "noise_sd": self.noise_sd,
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        state = "converged" if self.converged else f"not converged: {self.message}"
        state += f", hardly better than a constant: {', '.join(self.missed)}" if self.missed else ""
        fitted = self.parameters[self.parameters["informed"]].iterrows()
        shown = ", ".join(f"{n} = {r['value']:.4g} ± {r['sd']:.2g} {r['unit']}" for n, r in fitted)
        return f"Identification({self.system.kind}, {state}; {shown}{self._silence('; ')})"

    def _repr_html_(self) -> str:
        state = "converged" if self.converged else f"<b>not converged</b>: {escape(self.message)}"
        state += f"; <b>hardly better than a constant</b>: {', '.join(self.missed)}" if self.missed else ""
        tables = (table.to_html(float_format=lambda v: f"{v:.4g}") for table in (self.parameters, self.errors))
        notes = "".join(f"<li>{escape(warning)}</li>" for warning in self.warnings)
        return f"<p>{state}{escape(self._silence('; '))}</p>{''.join(tables)}" + (f"<ul>{notes}</ul>" if notes else "")

    def _silence(self, before: str) -> str:
        held = ", ".join(self.not_informed)
        return f"{before}not informed by these data: {held}" if held else ""

    def _require(self, name: str) -> None:
        if name not in self.parameters.index:
            known = [str(n) for n in self.parameters.index]
            raise ParameterError(f"{name!r} was not fitted; {expected_one_of(name, known)}")


def _bounded(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
