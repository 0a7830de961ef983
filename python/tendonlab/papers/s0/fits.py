"""Fits of S0's two models to friction maps: the static LuGre curve by variable projection, the load-and-ratio model by
a global search."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from typing import Generic, TypeVar

import numpy as np
from scipy.optimize import least_squares, minimize_scalar, nnls

from tendonlab.errors import ParameterError
from tendonlab.papers.s0 import twin
from tendonlab.papers.s0.bench import configuration
from tendonlab.papers.s0.maps import reference_points, reference_torques
from tendonlab.papers.s0.models import Decaying, Lugre, Proposed
from tendonlab.procedures import global_search

# bounds of the search, S0 eq. 11: F_c, F_s (N·m), theta_s (rad/s), F_v (N·m·s/rad), delta, beta, alpha, gamma
LOWER = np.array([1e-5, 0.0, 3.0, 0.0, -1.0, -1.0, 0.8, -1.0])
UPPER = np.array([0.1, 0.1, 40.0, 5e-3, 1.5, 4.0, 8.0, 3.0])
REFERENCE_WEIGHT = 12.0  # of the residual at each reference point, relative to those of the map; reconstructed
TORQUE_SCALE = 0.01  # N·m, of residuals
Model = TypeVar("Model", Lugre, Proposed, Decaying)
NAMES = tuple(f.name for f in fields(Proposed))


@dataclass(frozen=True, kw_only=True)
class Fit(Generic[Model]):
    """What a fit found: the `model`, its `rms` error over the map, N·m, the parameters `at_bound` (they have no
    symmetric interval), and, of a search, the `rank` of its Hessian."""

    model: Model
    rms: float
    at_bound: tuple[str, ...]
    rank: int | None = None

    def __repr__(self) -> str:
        bounds = f"; at a bound: {', '.join(self.at_bound)}" if self.at_bound else ""
        return f"Fit({self.model}, rms = {self.rms:.4g} N·m{bounds})"


def fit_static_lugre(
    speed: np.ndarray, torque: np.ndarray, *, alpha: float = 2.0, theta_s: tuple[float, float] = (1.0, 60.0)
) -> Fit[Lugre]:
    """Least-squares static LuGre curve of a map, all loads together as in S0 Tables 6 and 7, with F_c, F_s, F_v >= 0.

    `speed` rad/s and `torque` N·m, shape (n,); `theta_s` are the bounds of its search. By variable projection: for each
    theta_s the three others follow linearly. Raises ParameterError for shapes that differ or too few points."""
    if np.shape(speed) != np.shape(torque) or np.size(speed) < 4:
        raise ParameterError(
            f"torque has {np.size(torque)} points: expected {max(np.size(speed), 4)}, as many as speed"
        )

    def solved(at: float) -> tuple[np.ndarray, float]:
        unit = [Lugre(F_c=a, F_s=b, theta_s=at, F_v=c, alpha=alpha) for a, b, c in np.eye(3)]
        found, error = nnls(np.column_stack([u.torque(speed) for u in unit]), torque)
        return np.asarray(found), float(error)

    grid = np.geomspace(*theta_s, 40)
    k = int(np.argmin([solved(at)[1] for at in grid]))
    bracket = (float(grid[max(k - 1, 0)]), float(grid[min(k + 1, len(grid) - 1)]))
    best = minimize_scalar(lambda at: solved(at)[1], bounds=bracket, method="bounded", options={"xatol": 1e-9})
    (f_c, f_s, f_v), error = solved(best.x)
    model = Lugre(F_c=float(f_c), F_s=float(f_s), theta_s=float(best.x), F_v=float(f_v), alpha=alpha)
    at_bound = tuple(name for name in ("F_c", "F_s", "F_v") if getattr(model, name) == 0.0)
    return Fit(model=model, rms=float(error / np.sqrt(np.size(speed))), at_bound=at_bound)


def fit_proposed(
    speed: np.ndarray,
    load: np.ndarray,
    torque: np.ndarray,
    *,
    ratio: float,
    reference: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None,
    weight: float = REFERENCE_WEIGHT,
    starts: int = 60,
    seed: int = 0,
    method: str = "multistart",
) -> Fit[Proposed]:
    """Load-and-ratio model (S0 eq. 11) of a map of several loads, by a global search within S0's bounds.

    `speed` rad/s, `load` relative load, `torque` N·m: shape (n,); `ratio` N; `reference`: speed, load and torque of
    points whose residuals count `weight` times, shape (m,) each. `starts`, `seed`, `method` are those of
    `global_search`. S0 does not print its method. Raises ParameterError for shapes that differ."""
    if not np.shape(speed) == np.shape(load) == np.shape(torque):
        raise ParameterError(
            f"torque has {np.size(torque)} points: expected {np.size(speed)}, as many as speed and load"
        )
    at, carried, wanted, weights = speed, load, torque, np.ones(np.shape(speed))
    if reference is not None:
        at, carried, wanted = (np.concatenate(pair) for pair in zip((speed, load, torque), reference, strict=True))
        weights = np.concatenate([weights, np.full(len(reference[0]), weight)])

    def residual(x: np.ndarray) -> np.ndarray:
        model = Proposed(**dict(zip(NAMES, map(float, x), strict=True)))
        return np.asarray(weights * (model.torque(at, load=carried, ratio=ratio) - wanted) / TORQUE_SCALE)

    found = global_search(residual, LOWER, UPPER, starts=starts, seed=seed, method=method)
    model = Proposed(**dict(zip(NAMES, map(float, found.values), strict=True)))
    error = model.torque(speed, load=load, ratio=ratio) - torque
    at_bound = tuple(name for name, bound in zip(NAMES, found.at_bound, strict=True) if bound)
    return Fit(model=model, rms=_rms(error), at_bound=at_bound, rank=int(found.hessian_rank))


def fit_on_twin(
    transmission: str,
    *,
    reference: str | None = "proposed",
    starts: int = 60,
    seed: int = 0,
    method: str = "multistart",
) -> Fit[Proposed]:
    """The load-and-ratio model on the twin's 88 noiseless points of a transmission.

    `reference`: the column of S0 Table 8 that the three peaks are drawn to, "proposed" (what the paper's own curve has
    there; gives the reconstructed set "identified_on_twin") or "measured"; None: the points alone."""
    speed, load, torque = twin.points(transmission)
    drawn = None
    if reference is not None:
        drawn = (*reference_points(transmission), reference_torques(transmission, reference))
    ratio = configuration(transmission).ratio()
    return fit_proposed(speed, load, torque, ratio=ratio, reference=drawn, starts=starts, seed=seed, method=method)


def fit_decay(
    start: Proposed, speed: np.ndarray, load: np.ndarray, torque: np.ndarray, *, ratio: float
) -> Fit[Decaying]:
    """The load-and-ratio model with a viscous part that fades, fitted from `start` (S0 section 6: its second gap).

    Arguments as for `fit_proposed`; omega_d starts at 110 rad/s, q at 4. No reference points."""
    lower, upper = np.append(LOWER, [30.0, 1.0]), np.append(UPPER, [300.0, 12.0])
    inside = 1e-6 * (upper - lower)

    def model(x: np.ndarray) -> Decaying:
        inner = Proposed(**dict(zip(NAMES, map(float, x[:8]), strict=True)))
        return Decaying(model=inner, omega_d=float(x[8]), q=float(x[9]))

    def residual(x: np.ndarray) -> np.ndarray:
        return np.asarray((model(x).torque(speed, load=load, ratio=ratio) - torque) / TORQUE_SCALE)

    first = np.clip(np.append(start.values(), [110.0, 4.0]), lower + inside, upper - inside)
    found = least_squares(residual, first, bounds=(lower, upper), x_scale=upper - lower, max_nfev=400)
    best = model(found.x)
    at_bound = tuple(name for name, active in zip((*NAMES, "omega_d", "q"), found.active_mask, strict=True) if active)
    return Fit(model=best, rms=_rms(TORQUE_SCALE * residual(found.x)), at_bound=at_bound)


def relative_difference(a: Proposed, b: Proposed) -> dict[str, float]:
    """|a - b| / |b| of each parameter."""
    other = asdict(b)
    return {name: abs(value - other[name]) / max(abs(other[name]), 1e-300) for name, value in asdict(a).items()}


def rms_error(
    model: Callable[[np.ndarray, np.ndarray], np.ndarray], speed: np.ndarray, load: np.ndarray, torque: np.ndarray
) -> float:
    """RMS error of any model of speed and load over a map, N·m."""
    return _rms(model(speed, load) - torque)


def _rms(error: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(error))))
