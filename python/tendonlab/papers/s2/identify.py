"""The three identifications of S2: harmonic gear (Fig. 9), cable (Fig. 10), bushings (Fig. 11)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import least_squares

from tendonlab import _core
from tendonlab.arguments import positive
from tendonlab.errors import ParameterError
from tendonlab.papers.s2.equations import Array
from tendonlab.papers.s2.estimate import Estimate, from_jacobian
from tendonlab.papers.s2.values import BRANCHES
from tendonlab.procedures import split

LOWEST_FORCE = 200.0  # N, below which the fibre of the cable is not linear
REST = 1e-3  # rad/s, below which a joint velocity has no sense
WIDEST_EDGE = 0.2  # rad, where the edges c_i of the branches are looked for


def fit_gear_friction(
    speeds: ArrayLike, torque_mean: ArrayLike, torque_std: ArrayLike, *, c_m: float | None = None
) -> Estimate:
    """alpha, N*m, and beta, s/rad, of tau = alpha arctan(beta omega) by weighted least squares (S2 eq. 12, Fig. 9).

    `speeds`, rad/s, `torque_mean` and `torque_std`, N*m, one entry per set point; `c_m`: viscous friction, N*m*s/rad,
    that is taken off first. Raises ParameterError for fewer than 3 set points or a spread that is not positive."""
    omega, mean, std = (np.asarray(x, dtype=float) for x in (speeds, torque_mean, torque_std))
    if len(omega) < 3 or not omega.shape == mean.shape == std.shape:
        raise ParameterError(
            f"speeds: {omega.shape}, torque_mean: {mean.shape}, torque_std: {std.shape}; expected 3 or more of each"
        )
    if not np.all(std > 0):
        raise ParameterError(f"torque_std = {std.min()}: expected positive spreads, N*m")
    own = mean - (0.0 if c_m is None else c_m * omega)

    def residual(x: Array) -> Array:
        law = _core.friction.Arctan(friction=abs(x[0]), friction_slope=abs(x[1]))
        return np.asarray((law.force(velocity=omega) - own) / std)

    start = [2.0 / np.pi * float(np.max(np.abs(own))), 2.0 / float(np.max(np.abs(omega)))]
    found = least_squares(residual, start, jac="3-point", x_scale=start)
    values = dict(zip(("alpha", "beta"), np.abs(found.x).tolist(), strict=True))
    return from_jacobian(values, found.jac * np.sign(found.x), found.fun)


def fit_cable(
    elongation: ArrayLike,
    rate: ArrayLike,
    force: ArrayLike,
    *,
    share: float = 0.6,
    contiguous: bool = True,
    seed: int = 0,
) -> Estimate:
    """F_0, N, K, N/m, and c, N*s/m, of F = F_0 + K x + c x' by linear least squares (S2 eq. 3, Fig. 10).

    `elongation`, m, `rate`, m/s, `force`, N, shape (n,). What the fit itself puts below 200 N is left out. The first
    `share` of the samples (or a random share: `contiguous` False, `seed`) is fitted, the rest validates. The offset is
    free: elongation counts from anywhere. Warns where the rate hardly changes: c v then looks like F_0.
    Raises ParameterError where fewer than 10 samples are above 200 N."""
    x, v, f = (np.asarray(values, dtype=float) for values in (elongation, rate, force))
    kept = f >= LOWEST_FORCE
    for _ in range(2):  # chosen by the fit: noise must not decide which samples are there
        if np.count_nonzero(kept) < 10:
            raise ParameterError(
                f"force: {np.count_nonzero(kept)} samples above {LOWEST_FORCE:g} N; expected 10 or more"
            )
        design = np.stack([np.ones(len(x)), x, v], axis=1)
        rough = np.linalg.lstsq(design[kept] / _sizes(design[kept]), f[kept], rcond=None)[0]
        kept = (design / _sizes(design[kept])) @ rough >= LOWEST_FORCE
    design, f = design[kept], f[kept]
    train, rest = split(len(f), share=share, contiguous=contiguous, seed=seed)
    sizes = _sizes(design[train])
    solution = np.linalg.lstsq(design[train] / sizes, f[train], rcond=None)[0] / sizes
    error = f - design @ solution
    condition = float(np.linalg.cond(design[train] / sizes))
    return from_jacobian(
        dict(zip(("F_0", "K", "c"), solution.tolist(), strict=True)),
        design[train],
        error[train],
        condition=condition,
        validation_error=float(np.sqrt(np.mean(error[rest] ** 2)) / np.ptp(f[rest])),
        warnings=_speed_warnings(v[kept][train], condition),
    )


def fit_bushing(
    theta: ArrayLike, velocity: ArrayLike, force: ArrayLike, *, tension: float, rest: float = REST, num_edges: int = 41
) -> Estimate:
    """The eight parameters of a bushing's four branches, by least squares (S2 eq. 11, Fig. 11).

    `theta`, rad, `velocity` of the joint, rad/s (its sign chooses the branch; samples below `rest` are left out),
    `force`, N, shape (n,); `tension`: T, N, without which only b T is known. Each sense has its own four parameters and
    is fitted from the best of `num_edges` edges c within +-0.2 rad, where the model has a kink.
    Raises ParameterError where `tension` is not positive, where one sense has fewer than 20 samples or but one angle.
    """
    positive("tension", tension, "N")
    angle, speed, f = (np.asarray(values, dtype=float) for values in (theta, velocity, force))
    moving = np.abs(speed) > rest
    found: dict[str, float] = {}
    jacobian, errors = np.zeros((np.count_nonzero(moving), len(BRANCHES))), []
    row = 0
    for i, sense in ((1, 1.0), (2, -1.0)):
        here = moving & (speed * sense > 0)
        if np.count_nonzero(here) < 20:
            raise ParameterError(f"velocity: {np.count_nonzero(here)} samples of sense {sense:+g}; expected 20 or more")
        if np.ptp(angle[here]) == 0.0:
            raise ParameterError(
                f"theta = {angle[here][0]} in all samples of sense {sense:+g}: expected angles that differ"
            )
        names = (f"a{i}", f"b{i}1", f"b{i}2", f"c{i}")
        values, slopes, error = _fit_sense(angle[here], f[here], sense, names, tension, num_edges)
        found |= values
        columns = [BRANCHES.index(name) for name in names]
        jacobian[row : row + len(error), columns] = slopes
        errors.append(error)
        row += len(error)
    return from_jacobian({name: found[name] for name in BRANCHES}, jacobian, np.concatenate(errors))


def split_common_friction(branches: Mapping[str, float], theta: ArrayLike, tension: float) -> dict[str, Array]:
    """The friction in eq. 11: {"common": half the sum of both senses, "friction": half their difference}, N.

    The common part is a tension that changes with theta, no friction; the paper's b is therefore not twice a friction
    coefficient. `theta`, rad, any shape; `tension`: T, N."""
    forward, backward = (bushing_law(branches).force(velocity=s, wrap_angle=theta, load=tension) for s in (1.0, -1.0))
    return {"common": 0.5 * (forward + backward), "friction": 0.5 * (forward - backward)}


def effective_coefficients(branches: Mapping[str, float]) -> dict[str, float]:
    """Friction coefficients that the branches amount to, (b_1j - b_2j) / 4, beyond and below the edges (S2 eq. 10)."""
    return {side: (branches[f"b1{j}"] - branches[f"b2{j}"]) / 4.0 for side, j in (("beyond", 1), ("below", 2))}


def bushing_law(branches: Mapping[str, float]) -> Any:
    """The library's law with these parameters (S2 eq. 11)."""
    return _core.friction.BushingBranches(**{name: float(branches[name]) for name in BRANCHES})


def _fit_sense(
    theta: Array, force: Array, sense: float, names: tuple[str, ...], tension: float, num_edges: int
) -> tuple[dict[str, float], Array, Array]:
    """One sense from several edges: values, Jacobian of the model, error force - model."""
    other = dict.fromkeys(BRANCHES, 0.0)

    def model(x: Array) -> Array:
        law = bushing_law({**other, **dict(zip(names, x.tolist(), strict=True))})
        return np.asarray(law.force(velocity=sense, wrap_angle=theta, load=tension))

    starts = [_start(theta, force, edge, tension) for edge in np.linspace(-WIDEST_EDGE, WIDEST_EDGE, num_edges)]
    start = min(starts, key=lambda x: float(np.sum((model(x) - force) ** 2)))
    bounds = ([-np.inf] * 3 + [-1.0], [np.inf] * 3 + [1.0])
    best = least_squares(
        lambda x: model(x) - force, start, jac="3-point", bounds=bounds, x_scale=[10.0, 0.1, 0.1, 0.01]
    )
    return dict(zip(names, best.x.tolist(), strict=True)), best.jac, -best.fun


def _start(theta: Array, force: Array, edge: float, tension: float) -> Array:
    """The branches that meet at `edge`, by linear least squares."""
    away = np.sin(0.5 * (theta - edge)) * tension
    design = np.stack([np.ones(len(theta)), np.where(theta >= edge, away, 0.0), np.where(theta < edge, away, 0.0)])
    return np.append(np.linalg.lstsq(design.T, force, rcond=None)[0], edge)


def _sizes(design: Array) -> Array:
    sizes = np.linalg.norm(design, axis=0)
    return np.where(sizes > 0, sizes, 1.0)


def _speed_warnings(rate: Array, condition: float) -> tuple[str, ...]:
    """A warning where the rate varies too little to separate c v from F_0."""
    top = float(np.max(np.abs(rate)))
    levels = np.unique(np.round(rate / (0.1 * top))) if top > 0 else np.zeros(1)
    if len(levels) >= 3 or (levels.min() < 0 < levels.max()):
        return ()
    text = (
        f"rate: {len(levels)} speed in one direction (condition number {condition:.0f}); F_0 and c v look alike there"
    )
    return (f"{text}: use three speeds or both directions",)
