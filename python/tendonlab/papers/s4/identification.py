"""Stiffness and friction coefficients from measured tensions, as on the rig of S4 section V; effects that distort
them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab.arguments import positive, samples
from tendonlab.errors import ParameterError
from tendonlab.procedures import reversal_mask


@dataclass(frozen=True, kw_only=True)
class StiffnessFit:
    """k, N/m, and T_p, N; `residual`, N: what the straight line leaves of T22 (a loop where more than L2 stretches);
    `rms`, N; `reach`, rad: range of the synchronous error that was used."""

    k: float
    T_p: float
    residual: np.ndarray
    rms: float
    reach: tuple[float, float]


def identify_stiffness(T22: np.ndarray, dtheta: np.ndarray, *, r: float, T_p: float | None = None) -> StiffnessFit:
    """Stiffness of a middle section from its tension T22, N, against the synchronous error `dtheta`, rad (S4 eq. 37).

    With `T_p` given k is the closed form sum (T22 - T_p) r dtheta / sum (r dtheta)²; without, both are fitted, since
    the relation is affine. `fit_tensions` is the same by Ceres, and fits friction too. Raises ParameterError where the
    error does not vary or a sample is not finite."""
    T22, dtheta = samples("T22", T22), samples("dtheta", dtheta)
    stretch = positive("r", r, "m") * dtheta
    if not np.ptp(stretch) > 0:
        raise ParameterError("dtheta is constant: expected a synchronous error that varies; it identifies no stiffness")
    if T_p is None:
        (k, T_p), *_ = np.linalg.lstsq(np.column_stack([stretch, np.ones_like(stretch)]), T22, rcond=None)
    else:
        k = np.sum((T22 - T_p) * stretch) / np.sum(stretch**2)
    left = T22 - T_p - k * stretch
    reach = (float(np.min(dtheta)), float(np.max(dtheta)))
    return StiffnessFit(k=float(k), T_p=float(T_p), residual=left, rms=float(np.sqrt(np.mean(left**2))), reach=reach)


def pointwise_stiffness(T22: np.ndarray, dtheta: np.ndarray, *, r: float, T_p: float, share: float = 0.2) -> np.ndarray:
    """k sample by sample, N/m (S4 eq. 36); NaN where |dtheta| is not above `share` of its largest, so also
    where it is zero: the paper leaves out what is below 20 %, noise divided by next to nothing."""
    T22, dtheta = samples("T22", T22), samples("dtheta", dtheta)
    large = np.abs(dtheta) > share * np.max(np.abs(dtheta))
    k = np.full(dtheta.shape, np.nan)
    k[large] = (T22[large] - T_p) / (positive("r", r, "m") * dtheta[large])
    return k


def friction_coefficient(T_out: Any, T_in: Any, wrap: Any) -> Any:
    """mu_c = |ln(T_out / T_in) / theta_w| (S4 eq. 38). Raises ParameterError for a tension (slack) or a wrap
    angle at or below zero."""
    for name, T in (("T_out", T_out), ("T_in", T_in)):
        if not np.min(T) > 0:
            raise ParameterError(f"{name} = {float(np.min(T)):g}: expected more than 0 N; the ratio means nothing")
    positive("wrap", np.min(wrap), "rad")
    return np.abs(np.log(np.asarray(T_out) / T_in) / wrap)


@dataclass(frozen=True, kw_only=True)
class FrictionFit:
    """Friction coefficient of contact 21 with joint 1 turning forwards and backwards: means of `mu` where `kept`."""

    mu_plus: float
    mu_minus: float
    mu: np.ndarray
    kept: np.ndarray


def identify_friction(
    T21: np.ndarray,
    T22: np.ndarray,
    theta1: np.ndarray,
    om1: np.ndarray,
    time: np.ndarray,
    *,
    theta_w0: float,
    r: float,
    sigma_2: float = 0.0,
    share: float = 0.4,
    around: float = 0.25,
) -> FrictionFit:
    """Friction coefficients from the tensions at contact 21 (S4 eq. 38), the wrap angle theta_w0 - theta_1 with them.

    `sigma_2`, N·s/m, takes the viscous share sigma_2 r om1 out of T22 - T21 first: the ratio contains it, so its mean
    and sigma_2 must not be used together. Left out: |om1| below `share` of its largest and what is within `around`, s,
    of a reversal, where the bristle, not the ratio, decides."""
    T22, om1 = np.asarray(T22, dtype=float), np.asarray(om1, dtype=float)
    mu = friction_coefficient(np.asarray(T21) + sigma_2 * r * om1, T22, theta_w0 - np.asarray(theta1))
    kept = reversal_mask(time, om1, share=share, around=around)
    forwards, backwards = kept & (om1 > 0), kept & (om1 < 0)
    if not (forwards.any() and backwards.any()):
        raise ParameterError("om1: expected motion in both directions away from reversals")
    return FrictionFit(mu_plus=float(mu[forwards].mean()), mu_minus=float(mu[backwards].mean()), mu=mu, kept=kept)


def identify_friction_and_viscosity(
    T21: np.ndarray,
    T22: np.ndarray,
    theta1: np.ndarray,
    om1: np.ndarray,
    time: np.ndarray,
    *,
    theta_w0: float,
    r: float,
) -> tuple[float, float, float]:
    """(mu_plus, mu_minus, sigma_2) fitted together to T22 - T21 = T22 (1 - exp(-mu theta_w s)) + sigma_2 r om1, which
    counts the viscous share once. Reversals are left out as in `identify_friction`."""
    from scipy.optimize import least_squares

    kept = reversal_mask(time, np.asarray(om1, dtype=float))
    friction, T, wrap, om = (np.asarray(x)[kept] for x in (T22 - T21, T22, theta_w0 - theta1, om1))
    direction = np.sign(om)

    def left(x: np.ndarray) -> np.ndarray:
        mu = np.where(direction > 0, x[0], x[1])
        return np.asarray(T * (1 - np.exp(-mu * wrap * direction)) + 1e3 * x[2] * r * om - friction)

    found = least_squares(left, [0.1, 0.1, 0.1])
    return float(found.x[0]), float(found.x[1]), float(1e3 * found.x[2])
