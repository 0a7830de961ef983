"""Numbers read off S4 Figs 8 and 9: the error and how it changes at a reversal, loop width, ranges of tensions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from tendonlab.arguments import positive, samples


def synchronous_error(run: pd.DataFrame) -> pd.Series:
    """Delta theta = theta_2 - theta_1, rad, by time."""
    return run["theta2"] - run["theta1"]


def loop_width(run: pd.DataFrame) -> float:
    """Width in theta_2, rad, of the loop of Fig. 8b where theta_1 passes 0: forwards minus backwards, means of both."""
    theta_1, theta_2 = run["theta1"].to_numpy(), run["theta2"].to_numpy()
    at = np.flatnonzero(theta_1[:-1] * theta_1[1:] <= 0)
    share = theta_1[at] / (theta_1[at] - theta_1[at + 1])
    passed = theta_2[at] + share * (theta_2[at + 1] - theta_2[at])
    forwards = theta_1[at + 1] > theta_1[at]
    return float(passed[forwards].mean() - passed[~forwards].mean())


def spread(run: pd.DataFrame, *names: str) -> tuple[float, float]:
    """Smallest and largest value of some columns together."""
    values = run[list(names)].to_numpy()
    return float(values.min()), float(values.max())


@dataclass(frozen=True, kw_only=True)
class ErrorLevels:
    """The synchronous error, rad: largest in the window, at the reversal, `after` s later, and at start-up."""

    largest: float
    at_reversal: float
    later: float
    start: float

    @property
    def change(self) -> float:
        """By how much it changes over the reversal, rad: what S4 eq. (25) calls backlash."""
        return self.at_reversal - self.later


def error_levels(run: pd.DataFrame, *, window: float, reversal: float, after: float = 0.2) -> ErrorLevels:
    """Levels of the error of a run: beyond `window`, s, at `reversal`, s, and `after` s later."""
    error = synchronous_error(run)
    at, later = (float(np.interp(t, error.index, error)) for t in (reversal, reversal + after))
    started = error[error.index < 0.5]
    return ErrorLevels(
        largest=float(error[error.index >= window].abs().max()), at_reversal=at, later=later,
        start=float(started.abs().max()),
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Dwell:
    """How joint 1 lags behind a reversal of joint 2: it turns after `turned`, s, and has moved back by a given angle
    after `lasts`, s; `driver`, rad: what joint 2 has turned by then."""

    turned: float
    lasts: float
    driver: float


def dwell(run: pd.DataFrame, *, reversal: float, moved: float) -> Dwell:
    """From the reversal of joint 2 at `reversal`, s, until joint 1 is `moved` rad back from its own turning point."""
    later = run[(run.index >= reversal) & (run.index <= reversal + 1.5)]
    heading = float(np.sign(later["theta2"].iloc[0]))
    ahead = heading * later["theta1"].to_numpy()
    back = np.maximum.accumulate(ahead) - ahead
    end = later.iloc[int(np.argmax(back >= moved))]
    return Dwell(
        turned=float(later.index[int(np.argmax(ahead))] - reversal),
        lasts=float(later.index[int(np.argmax(back >= moved))] - reversal),
        driver=float(abs(end["theta2"] - later["theta2"].iloc[0])),
    )


def nrmse(simulated: np.ndarray, measured: np.ndarray) -> float:
    """Root mean square difference over the range of `measured`. Raises ParameterError where that does not vary."""
    reach = positive("range of measured", float(np.ptp(samples("measured", measured))))
    return float(np.sqrt(np.mean((simulated - measured) ** 2)) / reach)
