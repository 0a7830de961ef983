"""Late channels: by how much each output of each experiment lags the inputs, from the equation of motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab.checking.equation import Equation
from tendonlab.checking.logs import Logs
from tendonlab.checking.regression import FREEDOM, Fit
from tendonlab.checking.scales import ROUGH_SHARE, shares
from tendonlab.checking.terms import Terms, sliding, slopes_of_lags, terms
from tendonlab.simulation.catalog import MEMORY

SAMPLES, SCANNED = 4000, 20000  # that decide, and that the scan looks at
LONGEST, PART = 0.5, 0.25  # s, and share of the shortest experiment: lags that are looked for
GROWTH = 1.15  # from one lag that is tried to the next
FAR = 3  # steps from the common lag at which only another clock is likely to suit an experiment better
OWN = 3.0  # nats by which a lag of its own must suit an experiment better than the common one, to start the search
SCATTER = 0.02  # of the rms effort: sd of dry friction from run to run
CELLS = 96  # of a map over a turn
BENDS = (0.03, 0.1, 0.2, 0.4, 1.0)  # shares of the travel by which bristles may bend before they slide
RESOLVED = 0.25  # of a sample: no lag is known better
MOST_ROUNDS, CLOSE = 40, 0.1  # of Gauss and Newton: at most so many, until all steps are below this share of the error
ROUNDS = 12  # of a robust regression
SPOILT = 1.15  # growth of what an equation leaves of an experiment (rms) that no lag explains
MENDED = 0.96  # share of what an equation leaves of an experiment (rms) that its own lags must at most leave


@dataclass(frozen=True)
class Lags:
    """`seconds` and `sd` (channels, experiments): how far each output is behind the inputs; `channels`: the outputs;
    `weight` (channels, experiments): by how many times what the equations leave a lag of a second would change them;
    `gain` (experiments): nats by which the lags of its own suit an experiment better than those that most experiments
    share; `scanned` (experiments): nats by which a scan prefers a lag that lies far from the common one, 0 where it
    prefers a near one; `level`: what the balance of efforts leaves, relative to what the inputs contribute."""

    channels: tuple[str, ...]
    seconds: np.ndarray
    sd: np.ndarray
    weight: np.ndarray
    gain: np.ndarray
    scanned: np.ndarray
    level: float


def lags(equation: Equation, logs: Logs) -> Lags:
    """The lag of every output in every experiment, all of them together with the parameters."""
    channels = equation.measured
    scan, scanned = _scanned(equation, logs)
    late = np.tile(scan, (len(channels), 1))
    kept = logs.regular(SAMPLES)
    share = np.full(len(equation.predicted), ROUGH_SHARE)
    sd = np.full(late.shape, np.inf)
    for _ in range(MOST_ROUNDS):
        moved = logs.earlier(dict(zip(channels, late, strict=True)))
        at = terms(equation, moved.at(kept))
        fit = at.fit(share)
        if not np.isfinite(fit.cost):
            return Lags(channels, late, sd, np.zeros(late.shape), np.zeros(late.shape[1]), scanned, np.inf)
        share = shares(fit.residual, logs.run[kept])
        slopes = slopes_of_lags(equation, moved, at.residual, kept)
        own, belief = _with_friction(equation, moved.at(kept), at, slopes)
        steps = _steps(at, fit, own, belief, logs.run[kept], share, num=late.shape[1])
        step, sd = (part[: len(channels)] for part in steps)
        late = late + np.clip(step, -logs.step, logs.step)
        if np.all(np.abs(step) < CLOSE * np.hypot(sd, RESOLVED * logs.step)):
            break
    late = _with_one_clock(equation, late, sd)
    weight = _weights(slopes / (fit.level * at.size)[:, None], logs.run[kept], late.shape[1])
    gain = _gain(equation, logs, kept, late, share, fit)
    return Lags(channels, late, sd, weight, gain, scanned, float(fit.level[0]))


def _with_one_clock(equation: Equation, late: np.ndarray, sd: np.ndarray) -> np.ndarray:
    """The lags where friction with memory may delay forces: in a small motion a tension behind a contact lags by tens
    of milliseconds. There an experiment delays all its forces by what it delays the one whose lag is known best."""
    info, on = equation.system.info, equation.system.active()
    forces = [
        equation.measured.index(s.name) for s in info.outputs if s.dimension == "force" and s.name in equation.others
    ]
    if not forces or not any(acts and e.roles & MEMORY for acts, e in zip(on, info.effects, strict=True)):
        return late
    shared = np.median(late, axis=1)[:, None]
    best = np.argmin(sd[forces], axis=0)
    late = late.copy()
    late[forces] = shared[forces] + (late - shared)[forces][best, np.arange(late.shape[1])]
    return late


def _gain(
    equation: Equation, logs: Logs, kept: np.ndarray, late: np.ndarray, share: np.ndarray, fit: Fit
) -> np.ndarray:
    """Nats by which its own lags suit each experiment better than the common ones, at the parameters that suit each,
    beyond what the middle experiment gains: one late sensor spoils the parameters of all. Nothing where they mend no
    equation, or where friction suits it as well, in presliding or along a prescribed motion. Where nothing moves by an
    equation, beyond what dry friction of its own brings: friction that falls with speed is highest in a slow run."""
    common = np.repeat(np.median(late, axis=1)[:, None], late.shape[1], axis=1)
    moved = logs.earlier(dict(zip(equation.measured, common, strict=True))).at(kept)
    at = terms(equation, moved)
    without = at.fit(share)
    if not np.isfinite(without.cost):
        return np.full(late.shape[1], np.inf)
    surprise = [np.log1p((f.residual / (fit.level * at.size)[:, None]) ** 2 / FREEDOM) for f in (without, fit)]
    nats = 0.5 * (FREEDOM + 1) * (share @ (surprise[0] - surprise[1]))
    gained = np.bincount(moved.run, nats, late.shape[1])
    gained = np.where(_mended(fit, without, moved.run, late.shape[1]), np.maximum(gained - np.median(gained), 0.0), 0.0)
    left = without.residual / (without.level * at.size * FREEDOM**0.5)[:, None]
    if equation.axes:
        for i in np.flatnonzero(gained).tolist():
            bent = _by_bristles(equation, moved, left, i, share) + _by_prescribed(equation, moved, left, i, share)
            placed = _by_place(equation, moved, left, i, share)
            if gained[i] <= 0.5 * (FREEDOM + 1) * max(bent, placed):
                gained[i] = 0.0
        return np.asarray(gained)
    velocity = sliding(equation, moved, 0)
    if velocity is None:
        return gained
    here, dry = [moved.run == i for i in range(len(gained))], np.sign(velocity)[:, None]
    own = share[0] * np.array([_saved(left[0, of], dry[of]) for of in here])
    return np.asarray(gained - 0.5 * (FREEDOM + 1) * own)


def _mended(fit: Fit, without: Fit, run: np.ndarray, num: int) -> np.ndarray:
    """Whether any equation leaves less (rms) of each experiment with lags of its own than without, or of all
    experiments: one late sensor spoils the parameters of all. A resonance that the simulator lacks may make the robust
    cost of an experiment fall although no large error does."""
    own, common = (np.array([np.bincount(run, np.square(row), num) for row in of.residual]) for of in (fit, without))
    pooled = bool(np.any(own.sum(axis=1) < MENDED**2 * common.sum(axis=1)))
    return np.asarray(np.any(own < MENDED**2 * common, axis=0) | pooled)


def _weights(slopes: np.ndarray, run: np.ndarray, num: int) -> np.ndarray:
    """Rms of what a second's lag of each channel changes in each experiment, in the equation that it changes most."""
    count = np.maximum(np.bincount(run, minlength=num), 1)  # 0: nothing of that experiment is judged
    means = [np.sum(np.square(slopes[..., run == i]), axis=2) / count[i] for i in range(num)]
    square = [mean.max(axis=1, initial=0.0) for mean in means]
    return np.asarray(np.sqrt(np.array(square)).T)


def _with_friction(equation: Equation, logs: Logs, at: Terms, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What each experiment has of its own: the lags, and dry friction that differs from run to run, which on a slow
    run resembles a lag. With the inverse variances that are believed of them."""
    friction = np.zeros((len(equation.moved), *at.residual.shape))
    for k, name in enumerate(equation.moved):
        friction[k, k] = np.sign(logs.moving[name][1]) * at.size[k]
    belief = [1.0 / LONGEST**2] * len(slopes) + [1.0 / SCATTER**2] * len(friction)
    return np.concatenate([slopes, friction]), np.array(belief)


def _steps(
    at: Terms, fit: Fit, slopes: np.ndarray, own_belief: np.ndarray, run: np.ndarray, share: np.ndarray, *, num: int
) -> tuple[np.ndarray, np.ndarray]:
    """The Gauss-Newton step of what each of `num` experiments has of its own, together with the parameters, which all
    share; and the sd of each. `slopes`: what the equations change with them (unknowns, equations, samples)."""
    root = np.sqrt(fit.weight * (share / fit.level**2)[:, None]) / at.size[:, None]
    shared, own, left = at.slopes(fit.x) * root, slopes * root, fit.residual * root
    belief = np.array([1.0 / u.sd**2 for u in at.unknowns])
    information, gradient = np.diag(belief), belief * fit.x
    parts = []
    for i in range(num):
        t, d, r = (a[..., run == i].reshape(*a.shape[:-2], -1) for a in (shared, own, left))
        inverse = np.linalg.inv(d @ d.T + np.diag(own_belief))
        cross = t @ d.T @ inverse
        information = information + t @ t.T - cross @ (d @ t.T)
        gradient = gradient + t @ r - cross @ (d @ r)
        parts.append((inverse, cross, inverse @ (d @ r)))
    spread = np.linalg.pinv(information, hermitian=True)
    change = -spread @ gradient
    step = [-(alone + cross.T @ change) for _, cross, alone in parts]
    variance = [np.diag(inverse + cross.T @ spread @ cross) for inverse, cross, _ in parts]
    return np.array(step).T, np.sqrt(np.array(variance)).T


def _scanned(equation: Equation, logs: Logs) -> tuple[np.ndarray, np.ndarray]:
    """The lag of all outputs together in each experiment, in whole steps of the logs, at which the equation fits
    best; and the nats by which it does so where that lag lies far from the common one, and friction of its own, or
    friction in presliding, brings less. Without a mass, hysteresis resembles a lag of any size: none are counted."""
    kept, num = logs.regular(SCANNED), len(equation.dataset.experiments)
    at = terms(equation, logs.at(kept))
    fit = at.fit(np.full(len(at.size), ROUGH_SHARE))
    if not np.isfinite(fit.cost):
        return np.zeros(num), np.zeros(num)
    changed, scale = fit.residual - at.residual, (fit.level * at.size)[:, None]
    stride = float(np.median(np.diff(kept)))
    shortest = min(e.duration for e in equation.dataset.experiments)
    most = max(1.0, min(LONGEST, PART * shortest) / logs.step)
    sizes = np.unique(np.round(GROWTH ** np.arange(0.0, np.log(most) / np.log(GROWTH) + 1e-9))).astype(int)
    tried = np.concatenate([-sizes[::-1], [0], sizes])

    def earlier(steps: int) -> tuple[Logs, np.ndarray]:
        """The logs with all outputs that much earlier, and what the equations leave there, by their levels."""
        moved = logs.rolled(equation.measured, steps).at(kept)
        # what the parameters change follows from the motion: it moves with the outputs
        there = np.clip(np.arange(len(kept)) + round(steps / stride), 0, len(kept) - 1)
        return moved, (equation.evaluate(equation.along(moved), len(kept)) + changed[:, there]) / scale

    cost = np.empty((len(tried), num))
    for k, steps in enumerate(tried):
        moved, left = earlier(int(steps))
        cost[k] = np.bincount(moved.run, np.sum(np.log1p(left**2), axis=0), num)
    common = int(np.argmin(np.sum(cost, axis=1)))
    there = earlier(int(tried[common]))
    own = _by_friction(equation, *there)
    differs = cost[common] - np.min(cost, axis=0) > OWN / ROUGH_SHARE
    best = np.where(differs, np.argmin(cost, axis=0), common)
    inside = (best > 0) & (best < len(tried) - 1)
    gained = cost[common] - np.min(cost, axis=0)
    far = inside & (np.abs(tried[best] - tried[common]) >= FAR) & (gained > own) & bool(equation.moved)
    alike = np.ones(len(at.size))
    far &= [bool(far[i]) and gained[i] > _by_bristles(equation, *there, i, alike) for i in range(num)]
    far &= [bool(far[i]) and not _spoilt(there, earlier(int(tried[best[i]])), i) for i in range(num)]
    nats = 0.5 * (FREEDOM + 1) * ROUGH_SHARE * gained
    return np.where(inside, tried[best], 0) * logs.step, np.where(far, nats, 0.0)


def _spoilt(common: tuple[Logs, np.ndarray], own: tuple[Logs, np.ndarray], experiment: int) -> bool:
    """Whether a lag of its own makes any equation of an experiment err more (rms): outputs that are late together are
    late in all equations; torque that ripples along a ramp resembles a lag in one."""
    before, after = (np.sum(np.square(left[:, logs.run == experiment]), axis=1) for logs, left in (common, own))
    return bool(np.any(after > SPOILT**2 * before))


def _by_friction(equation: Equation, logs: Logs, left: np.ndarray) -> np.ndarray:
    """By how much dry and viscous friction of its own lowers the surprise of each experiment, as a cold one needs,
    beyond what it lowers that of the others: friction that the simulator lacks helps all of them."""
    saved = np.zeros(len(equation.dataset.experiments))
    for k, name in enumerate(equation.moved):
        columns = _friction(logs.moving[name][1])
        for i in range(len(saved)):
            here = logs.run == i
            saved[i] += _saved(left[k, here], columns[here])
    return np.maximum(saved - np.median(saved), 0.0)


def _by_bristles(equation: Equation, logs: Logs, left: np.ndarray, experiment: int, share: np.ndarray) -> float:
    """By how much friction in presliding lowers the surprise of an experiment, of each equation by its `share`: while a
    motion is too small to slide, friction is a spring, and the motion seems to lead. Nothing where none of its samples
    is judged."""
    here, saved = logs.run == experiment, 0.0
    for k, name in enumerate(equation.moved if here.any() else ()):
        position, speed = logs.moving[name][:2, here]
        for deflection in _deflections(position):
            columns = np.column_stack([_friction(speed), deflection])
            saved = max(saved, float(share[k]) * _saved(left[k, here], columns))
    return saved


def _by_prescribed(equation: Equation, logs: Logs, left: np.ndarray, experiment: int, share: np.ndarray) -> float:
    """By how much dry friction along a prescribed motion lowers the surprise of an experiment, of each equation by its
    `share`: a cold run has more of it. Where the part began was not logged, so an offset is free."""
    here = logs.run == experiment
    if not equation.prescribed or not here.any():
        return 0.0
    velocity = logs.driving[equation.prescribed[0]][0, here]
    columns = np.stack([np.ones_like(velocity), np.sign(velocity)], axis=1)
    return float(share @ [_saved(row[here], columns) for row in left])


def _by_place(equation: Equation, logs: Logs, left: np.ndarray, experiment: int, share: np.ndarray) -> float:
    """By how much a map over the place in a turn, learnt from the other experiments, lowers the surprise of one, of
    each equation by its `share`: along a slow motion, torque that ripples with the angle resembles a lag."""
    here, saved = logs.run == experiment, 0.0
    for k, name in enumerate(equation.moved if here.any() else ()):
        cell = np.floor(logs.moving[name][0] * (CELLS / (2.0 * np.pi))).astype(int) % CELLS
        weight = np.where(here, 0.0, 1.0 / (1.0 + left[k] ** 2))
        learnt = np.bincount(cell, weight * left[k], CELLS) / np.maximum(np.bincount(cell, weight, CELLS), 1.0)
        predicted = learnt[cell[here]]
        if predicted @ left[k, here] > 0.0:
            saved = max(saved, float(share[k]) * _saved(left[k, here], predicted[:, None]))
    return saved


def _friction(speed: np.ndarray) -> np.ndarray:
    """Dry and viscous friction (samples, 2), each of its own size."""
    return np.stack([np.sign(speed), speed / max(float(np.std(speed)), 1e-300)], axis=1)


def _deflections(position: np.ndarray) -> np.ndarray:
    """Of bristles that a motion bends by these shares of its travel before they slide, relative (shares, samples)."""
    most = np.array(BENDS) * max(float(np.ptp(position)), 1e-300)
    bent = np.zeros((len(most), len(position)))
    for k, moved in enumerate(np.diff(position), start=1):
        bent[:, k] = np.clip(bent[:, k - 1] + moved / most, -1.0, 1.0)
    return bent


def _saved(left: np.ndarray, columns: np.ndarray) -> float:
    """By how much the best sum of the `columns` lowers the surprise of what is `left`."""
    rest = left
    for _ in range(ROUNDS):
        weighted = columns / (1.0 + rest**2)[:, None]
        rest = left - columns @ (np.linalg.pinv(weighted.T @ columns, hermitian=True) @ (weighted.T @ left))
    return max(0.0, float(np.sum(np.log1p(left**2) - np.log1p(rest**2))))
