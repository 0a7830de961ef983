"""How strong an effect is: gap/noise, the rms residual of the refitted nominal simulator over the rig's total floor.

The residual comes from noise-free runs, after the nominal parameters were refitted (Gauss-Newton in their
logarithms); the floor is the rms of white, coloured, quantisation and run-to-run scatter. Both are pooled over the
measured outputs, each in its own floor.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .lanes import alike, lanes_of, scene_of
from .plant import simulate
from .rig import (
    LACKING,
    Rig,
    effect_parameters,
    free_parameters,
    full_truth,
    largest_amplitude,
    nominal_parameters,
    nominal_values,
)

Array = NDArray[np.float64]

PERIOD = 0.01  # s, of the samples that are compared
NUDGE = 0.02  # finite difference in log parameters
PRIOR_SD = 0.3  # of a log parameter
SMALLEST = 2e-3  # amplitude
TOLERANCE = 0.12  # of log gap/noise: where the search stops
NUM_LINEAR, NUM_EXACT = 4, 6
RIVAL_AMPLITUDE = 0.1
ORDER = 6  # of the autoregressive model of the floor


@dataclass(frozen=True, kw_only=True)
class Strength:
    """`gap_noise` reached at `amplitude`; `nominal_gap_noise`: before any refit; `floor`: rms noise of every
    output, SI.

    `limited`: the physical limit of the amplitude was met before the target; `met`: the target was, within 20 % or
    what the rig allows.
    `separation`: nats that tell the effect from each of its rivals, by name.
    """

    amplitude: float
    gap_noise: float
    nominal_gap_noise: float
    floor: Array
    limited: bool
    met: bool
    separation: dict[str, float]


def tune(rigs: Sequence[Rig]) -> list[Strength]:
    """Find the amplitude of every rig's effect that gives its target gap/noise, within 20 % unless the physical
    limit is met.
    """
    out: dict[int, Strength] = {}
    for group in alike(rigs):
        for has_effect, search in ((True, _tune_effects), (False, _measure)):
            rows = [i for i in group if (rigs[i].kind in LACKING) == has_effect]
            out |= dict(zip(rows, search([rigs[i] for i in rows]) if rows else [], strict=True))
    return [out[i] for i in range(len(rigs))]


def measured(rigs: Sequence[Rig], amplitudes: Sequence[float]) -> list[Strength]:
    """Strength of the effect of every rig at a given amplitude; the rigs are alike, and all lack an effect."""
    tuner, search = _Tuner(rigs), _Search(rigs)
    search.amplitude = np.array(amplitudes, dtype=float)
    tuner.start()
    tuner.linear(search.amplitude)  # begins the refit
    search.learn(tuner.exact(search.amplitude), search.everyone)
    before, rivals = tuner.nominal_gap(), separations(tuner)
    return [search.strength(i, before=before[i], floor=tuner.floor[i], separation=rivals[i]) for i in range(len(rigs))]


def _measure(rigs: Sequence[Rig]) -> list[Strength]:
    """Floor and nominal gap of rigs that lack nothing."""
    tuner, search = _Tuner(rigs), _Search(rigs)
    tuner.run_truth(search.amplitude)
    before = tuner.nominal_gap()
    return [search.strength(i, before=before[i], floor=tuner.floor[i], separation={}) for i in range(len(rigs))]


def _tune_effects(rigs: Sequence[Rig]) -> list[Strength]:
    tuner, search = _Tuner(rigs), _Search(rigs)
    tuner.start()
    for _ in range(NUM_LINEAR):
        search.learn(tuner.linear(search.amplitude), search.everyone)
        search.move()
    found: dict[int, Strength] = {}
    active, current = search.everyone, tuner
    for turn in range(NUM_EXACT):
        search.learn(current.exact(search.amplitude[active]), active)
        before, rivals = current.nominal_gap(), separations(current)
        for row, i in enumerate(active):
            found[int(i)] = search.strength(
                int(i), before=before[row], floor=current.floor[row], separation=rivals[row]
            )
        open_rows = np.flatnonzero(~search.is_done()[active])
        if not open_rows.size or turn == NUM_EXACT - 1:
            break
        active, current = active[open_rows], current.subset(open_rows)
        search.move()
    return [found[i] for i in range(len(rigs))]


class _Search:
    """Amplitudes on their way to the targets, in logarithms."""

    def __init__(self, rigs: Sequence[Rig]) -> None:
        self.everyone = np.arange(len(rigs))
        self.has_effect = np.array([rig.kind in LACKING for rig in rigs])
        self.largest = np.array([largest_amplitude(rig) if rig.kind in LACKING else 0.0 for rig in rigs])
        self.target = np.log([rig.target for rig in rigs])
        self.met_within = [rig.met_within for rig in rigs]
        self.amplitude = np.where(self.has_effect, np.minimum(0.3, self.largest), 0.0)
        self.gap = np.zeros(len(rigs))
        self.last: tuple[Array, Array] | None = None

    def learn(self, gap: Array, rows: NDArray[np.int64]) -> None:
        self.gap[rows] = gap

    def _off(self) -> Array:
        return np.where(self.has_effect, np.log(np.maximum(self.gap, 1e-6)) - self.target, 0.0)

    def _at_limit(self) -> NDArray[np.bool_]:
        return np.asarray(self.has_effect & (self.amplitude >= self.largest * (1 - 1e-9)))

    def is_done(self) -> NDArray[np.bool_]:
        off = self._off()
        stuck = (self._at_limit() & (off < 0)) | ((self.amplitude <= SMALLEST) & (off > 0))
        return np.asarray((np.abs(off) < TOLERANCE) | stuck)

    def move(self) -> None:
        """Scale the amplitudes of all that are not done, by the slope of the last two gaps where there is one."""
        logs, slope = np.log(np.maximum(self.amplitude, 1e-12)), np.ones_like(self.gap)
        if self.last is not None:
            run, rise = logs - self.last[0], np.log(np.maximum(self.gap, 1e-6)) - self.last[1]
            slope = np.where(np.abs(run) > 0.02, np.clip(rise / np.where(run == 0, 1.0, run), 0.6, 3.0), 1.0)
        self.last = (logs, np.log(np.maximum(self.gap, 1e-6)))
        moved = np.clip(
            self.amplitude * np.exp(-np.clip(self._off() / slope, -1.8, 1.8)),
            SMALLEST,
            np.maximum(self.largest, SMALLEST),
        )
        self.amplitude = np.where(self.has_effect & ~self.is_done(), moved, self.amplitude)

    def strength(self, row: int, *, before: float, floor: Array, separation: dict[str, float]) -> Strength:
        gap = float(self.gap[row]) if self.has_effect[row] else 0.0
        return Strength(
            amplitude=float(self.amplitude[row]),
            gap_noise=gap,
            nominal_gap_noise=float(before),
            floor=floor,
            limited=bool(self._at_limit()[row]),
            met=bool(not self.has_effect[row] or abs(self._off()[row]) < self.met_within[row]),
            separation=separation,
        )


def separations(tuner: _Tuner) -> list[dict[str, float]]:
    """What tells each rig's effect from its rivals, nats: half the whitened sum of squares left when the rival is
    refitted instead.

    Below 2 nats no analysis of these logs can tell which it was.
    """
    names = [rig.system.rivals.get(rig.effect, ()) for rig in tuner.rigs]
    out: list[dict[str, float]] = [{} for _ in names]
    depth = max((len(group) for group in names), default=0)
    if not depth:
        return out
    truth, noise = tuner.truth, tuner.noise
    for turn in range(depth):
        chosen = [group[turn] if turn < len(group) else "" for group in names]
        column = tuner.rival(chosen)
        for i, name in enumerate(chosen):
            if name:
                out[i][name] = tuner.separation(i, column[i], truth=truth[i], noise=noise[i])
    return out


class _Tuner:
    """Noise-free and noisy runs of rigs that are simulated together; arrays of readings are (num_rigs, outputs,
    samples * experiments). Truth and nominal run with the same coarse step: its error cancels in their difference.
    """

    def __init__(self, rigs: Sequence[Rig]) -> None:
        self.rigs = rigs
        names = rigs[0].system.output_names
        self.num_outputs = len(names)
        self.used = np.array([[name in rig.outputs for name in names] for rig in rigs])
        self.free = [free_parameters(rig) for rig in rigs]
        self.width = max(len(names) for names in self.free)
        self.refit = np.zeros((len(rigs), self.width))  # log parameter over truth
        self.expansion = self.refit.copy()
        self.floor = np.ones((len(rigs), self.num_outputs))

    def subset(self, rows: NDArray[np.int64]) -> _Tuner:
        """The same search for some of the rigs, refit parameters kept."""
        part = copy.copy(self)
        part.rigs = [self.rigs[i] for i in rows]
        part.free = [self.free[i] for i in rows]
        for name in ("used", "refit", "expansion", "base", "slopes", "floor", "truth", "noise"):
            setattr(part, name, getattr(self, name)[rows])
        return part

    def _run(
        self,
        rigs: Sequence[Rig],
        parameters: Sequence[dict[str, float]],
        *,
        with_effect: bool,
        with_noise: bool = False,
    ) -> Array:
        """Readings of all rigs; `with_noise`: the second half of them is noisy."""
        is_noisy = [with_noise and 2 * i >= len(rigs) for i in range(len(rigs))]
        lanes = lanes_of(rigs, parameters, is_noisy=is_noisy, with_effect=with_effect)
        step, stride = rigs[0].system.coarse_step, max(1, round(PERIOD / rigs[0].sample_time))
        run = simulate(lanes, scene_of(rigs, is_noisy=is_noisy), step=step, stride=stride)
        outputs = run.outputs.reshape(self.num_outputs, run.time.size, len(rigs), -1)
        return np.moveaxis(outputs, 2, 0).reshape(len(rigs), self.num_outputs, -1)

    def start(self) -> None:
        """Readings and slopes at the true parameters, from which `linear` predicts."""
        self.base, self.slopes = self._linearise(self.refit)

    def run_truth(self, amplitude: Array) -> Array:
        parameters = [full_truth(rig, a) for rig, a in zip(self.rigs, amplitude, strict=True)]
        clean, noisy = np.split(
            self._run([*self.rigs, *self.rigs], parameters * 2, with_noise=True, with_effect=True), 2
        )
        self.noise, self.truth = noisy - clean, clean
        self.floor = np.sqrt(np.mean(self.noise**2, axis=2))
        return clean

    def _values(self, index: int, logs: Array) -> dict[str, float]:
        rig = self.rigs[index]
        values = {name: rig.truth[name] for name in nominal_parameters(rig)}
        return values | {name: values[name] * float(np.exp(x)) for name, x in zip(self.free[index], logs, strict=False)}

    @np.errstate(all="ignore")  # what has no value is NaN
    def _nominal(self, logs: Array) -> Array:
        """Readings at `logs`; NaN of a rig for whose parameters the step is too long."""
        values = [self._values(i, row) for i, row in enumerate(logs)]
        try:
            return self._run(self.rigs, values, with_effect=False)
        except ArithmeticError:
            return np.concatenate([self._alone(i, row) for i, row in enumerate(values)])

    def _alone(self, index: int, values: dict[str, float]) -> Array:
        try:
            return self._run([self.rigs[index]], [values], with_effect=False)
        except ArithmeticError:
            return np.full((1, *self.truth.shape[1:]), np.nan)

    def _linearise(self, logs: Array) -> tuple[Array, Array]:
        """Readings at `logs` and their slopes, (num_rigs, width, outputs, ...)."""
        steps = np.concatenate([np.zeros((1, self.width)), NUDGE * np.eye(self.width)])
        rigs = [rig for _ in steps for rig in self.rigs]
        values = [self._values(i, row + nudge) for nudge in steps for i, row in enumerate(logs)]
        runs = self._run(rigs, values, with_effect=False).reshape(len(steps), len(self.rigs), self.num_outputs, -1)
        return runs[0], np.moveaxis(runs[1:] - runs[0], 0, 1) / NUDGE

    def _weigh(self, residual: Array) -> Array:
        """In units of the floor, outputs that were not measured at 0."""
        weight = self.used / self.floor
        return residual * weight.reshape(weight.shape + (1,) * (residual.ndim - 2))

    def _gap(self, residual: Array) -> Array:
        square = np.mean(self._weigh(residual) ** 2, axis=2)
        return np.asarray(np.sqrt(square.sum(axis=1) / self.used.sum(axis=1)))

    def _step(self, residual: Array, slopes: Array, logs: Array) -> Array:
        """Gauss-Newton step in log parameters, with a weak prior around the truth, (num_rigs, width)."""
        weighed = self._weigh(residual).reshape(len(self.rigs), -1)
        step = np.zeros_like(logs)
        for i, rows in enumerate(slopes):
            matrix = (rows * (self.used[i] / self.floor[i])[None, :, None]).reshape(self.width, -1)
            normal = matrix @ matrix.T + np.eye(self.width) / PRIOR_SD**2
            step[i] = np.linalg.solve(normal, matrix @ weighed[i] - logs[i] / PRIOR_SD**2)
        return np.clip(step, -1.0, 1.0)

    def linear(self, amplitude: Array) -> Array:
        """gap/noise as the slopes at the true parameters predict it."""
        residual = self.run_truth(amplitude) - self.base
        step = self._step(residual, self.slopes, np.zeros_like(self.refit))
        self.refit = step
        return self._gap(residual - np.einsum("rp,rpcn->rcn", step, self.slopes))

    def exact(self, amplitude: Array) -> Array:
        """gap/noise after a Gauss-Newton step from the last refit with its own slopes: the least of before and
        after.
        """
        truth = self.run_truth(amplitude)
        self.expansion = self.refit.copy()
        self.base, self.slopes = self._linearise(self.refit)
        residual = truth - self.base
        before = self._gap(residual)
        after = self.refit + self._step(residual, self.slopes, self.refit)
        gap = self._gap(truth - self._nominal(after))
        self.refit = np.where((gap < before)[:, None], after, self.refit)
        return np.fmin(gap, before)

    def nominal_gap(self) -> Array:
        """gap/noise of the nominal simulator as the dataset states it, before any refit."""
        values = [{name: value for name, (value, _) in nominal_values(rig).items()} for rig in self.rigs]
        return self._gap(self.truth - self._run(self.rigs, values, with_effect=False))

    def rival(self, effects: Sequence[str]) -> Array:
        """Change of the refitted readings with a small amplitude of another effect each (""; none), (num_rigs,
        outputs, ...).
        """
        others = [replace(rig, effect=effect, form=0) for rig, effect in zip(self.rigs, effects, strict=True)]
        values = [self._values(i, row) for i, row in enumerate(self.expansion)]
        added = [
            v | (effect_parameters(o, RIVAL_AMPLITUDE) if o.effect else {}) for v, o in zip(values, others, strict=True)
        ]
        run = self._run(others, added, with_effect=False)
        return run - self.base

    def separation(self, row: int, column: Array, *, truth: Array, noise: Array) -> float:
        """Nats left of the truth once the nominal parameters and the rival's `column` are fitted to it, in whitened
        readings.
        """
        used = np.flatnonzero(self.used[row])
        shapes = np.concatenate([self.slopes[row], column[None], (truth - self.base[row])[None]])
        runs = len(self.rigs[row].experiments)
        white = np.stack([_whiten(shapes[:, c], noise[c], runs) for c in used], axis=1).reshape(len(shapes), -1)
        matrix, residual = white[:-1].T, white[-1]
        prior = np.zeros((self.width, self.width + 1))
        prior[:, : self.width] = np.eye(self.width) / PRIOR_SD
        rows = np.concatenate([matrix, prior])
        wanted = np.concatenate([residual, np.zeros(self.width)])
        left = wanted - rows @ np.linalg.lstsq(rows, wanted, rcond=None)[0]
        return float(0.5 * left @ left)


def _whiten(signals: Array, noise: Array, runs: int) -> Array:
    """Filter `signals`, (n, samples * runs), by the autoregressive model of `noise`, (samples * runs,); unit
    innovations.
    """
    series = noise.reshape(-1, runs)
    lagged = np.stack([series[ORDER - i : len(series) - i] for i in range(ORDER + 1)])
    past, now = lagged[1:].reshape(ORDER, -1), lagged[0].ravel()
    weights = np.linalg.lstsq(past.T, now, rcond=None)[0]
    spread = float(np.std(now - weights @ past))
    taps = np.concatenate([[1.0], -weights])
    shaped = signals.reshape(len(signals), -1, runs)
    filtered = sum(tap * shaped[:, ORDER - i : shaped.shape[1] - i] for i, tap in enumerate(taps))
    return np.asarray(filtered / spread).reshape(len(signals), -1)
