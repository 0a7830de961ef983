"""Experiments of a bench with two cables in sheaths: the load follows a motion while the drive commands a torque.

The load is a damper and, in poor sessions, a spring; in rich ones its torque changes with the way that it has gone, and
in some runs the torque ripples a little at all times. Groups of runs differ by pretension and by the bends of the
sheaths.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tendonlab.blind.description import Array, Experiment

from .recorded import recorded

Draw = np.random.Generator
Shape = Callable[[Array, Draw], Array]

SPEED, TORQUE, RIPPLE = 0.6, 16.0, 0.4  # rad/s, N*m, N*m: usual peaks
REST = 0.4  # s at the start of each run
GROUPS: tuple[dict[str, float], ...] = (
    {},
    {"pretension": 60.0},
    {"wrap_angle": -1.8},
    {"pretension": -45.0, "wrap_angle": 1.2},
)


def _waves(time: Array, frequencies: Array, phases: Array, weights: Array) -> Array:
    angles = 2.0 * np.pi * frequencies[:, None] * time + phases[:, None]
    return np.asarray(weights @ np.sin(angles))


def sine(time: Array, draw: Draw) -> Array:
    frequency = np.array([draw.uniform(0.15, 0.5)])
    return _waves(time, frequency, draw.uniform(0, 6.28, 1), np.ones(1))


def multi_sine(time: Array, draw: Draw) -> Array:
    frequencies = draw.uniform(0.1, 1.2, 4)
    return _waves(time, frequencies, draw.uniform(0, 6.28, 4), 0.55 / (0.6 + frequencies))


def superposed(time: Array, draw: Draw) -> Array:
    """Odd harmonics: sin + sin(3.)/3 + sin(5.)/5 of one period."""
    order = np.array([1.0, 3.0, 5.0])
    return _waves(time, order * draw.uniform(0.1, 0.2), order * draw.uniform(0, 6.28), 1.0 / order)


def ramps(time: Array, draw: Draw) -> Array:
    """Moves at even speeds, slow and fast, that turn back at once or after a rest."""
    knots, speeds, at, sense = [0.0], [0.0], 0.0, draw.choice([-1.0, 1.0])
    while at < time[-1]:
        speed, rest = sense * float(np.exp(draw.uniform(np.log(0.3), 0.0))), draw.uniform(0.2, 0.6)
        for value, lasts in ((speed, draw.uniform(0.6, 1.4)), (0.0, rest * draw.choice([0.0, 1.0]))):
            knots += [at + 0.15, at + max(lasts, 0.2)]
            speeds += [value, value]
            at += max(lasts, 0.2)
        sense = -sense
    return np.asarray(np.interp(time, knots, speeds))


def moves(time: Array, draw: Draw) -> Array:
    """Fast moves there and back, each followed by standstill."""
    out, at, sense = np.zeros_like(time), draw.uniform(0.0, 0.3), draw.choice([-1.0, 1.0])
    while at < time[-1]:
        lasts = draw.uniform(0.5, 0.9)
        x = np.clip((time - at) / lasts, 0.0, 1.0)
        out += sense * draw.uniform(0.6, 1.3) * np.sin(np.pi * x) ** 2
        at, sense = at + lasts + draw.uniform(0.3, 0.9), -sense
    return out


def growing(time: Array, draw: Draw) -> Array:
    """A sine from little above the usual thresholds of sliding to well above."""
    return np.asarray((0.3 + 0.7 * (time / time[-1]) ** 2) * np.sin(2.0 * np.pi * draw.uniform(0.3, 0.6) * time))


def stairs(time: Array, draw: Draw) -> Array:
    """Levels that are held, with ramps between."""
    knots = np.concatenate([[0.0], np.cumsum(draw.uniform(0.6, 1.6, 24))])
    levels = np.repeat(draw.uniform(-1.0, 1.0, 13), 2)[: knots.size]
    return np.asarray(np.interp(time, knots, levels))


SPRING = None  # the torque of a load that is a spring
Plan = tuple[Shape, Shape | None, float, int]  # motion, torque, size of both, group
# the motion that is repeated, four more to fit, three held out of another kind, size or group
RICH: tuple[Plan, ...] = (
    (ramps, multi_sine, 1.0, 0),
    (sine, sine, 1.0, 0),
    (multi_sine, multi_sine, 1.0, 1),
    (moves, stairs, 1.0, 2),
    (ramps, sine, 0.8, 3),
    (growing, multi_sine, 1.0, 0),
    (superposed, SPRING, 1.1, 2),
    (multi_sine, stairs, 1.0, 1),
)
POOR: tuple[Plan, ...] = (
    (sine, SPRING, 1.0, 0),
    (sine, SPRING, 0.7, 0),
    (sine, SPRING, 1.2, 1),
    (sine, SPRING, 0.9, 2),
    (ramps, SPRING, 1.0, 0),
    (sine, SPRING, 0.85, 1),
    (superposed, SPRING, 1.0, 0),
    (sine, SPRING, 1.1, 2),
)


def session(
    draw: Draw, *, excitation: str, sample_time: float, num_samples: int, has_repeats: bool = True
) -> list[Experiment]:
    """Ten experiments, "rich" or "poor", in the order recorded; one repeated at the start, in the middle and at the
    end. Without repeats, other motions of the same kind take the places of the second and third.
    """
    plans = RICH if excitation == "rich" else POOR
    time: Array = np.arange(num_samples, dtype=float) * sample_time
    seconds = num_samples * sample_time
    runs = recorded(draw, plans, lambda plan, by: _signals(plan, time, by), seconds=seconds, has_repeats=has_repeats)
    return [
        Experiment(reference=torque, others={"input_velocity": velocity}, add=dict(GROUPS[plan[3]]), **named)
        for named, plan, (torque, velocity) in runs
    ]


def _signals(plan: Plan, time: Array, draw: Draw) -> tuple[Array, Array]:
    """Torque, N*m, and velocity, rad/s, of a run that begins at rest."""
    motion, torque, size, _ = plan
    x = np.clip((time - REST) / 0.6, 0.0, 1.0)
    eased = x * x * (3.0 - 2.0 * x)
    velocity = size * SPEED * draw.uniform(0.7, 1.2) * eased * motion(np.maximum(time - REST, 0.0), draw)
    peak, damping = size * TORQUE * draw.uniform(0.7, 1.2), draw.uniform(0.0, 0.25)
    wave = _spring(velocity) if torque is SPRING else torque(1.5 * np.cumsum(np.abs(velocity)) * time[1] / SPEED, draw)
    wave = wave + damping * velocity / (SPEED * size)
    ripple = RIPPLE * eased * multi_sine(2.0 * time, draw) if torque is stairs else 0.0
    return np.asarray(peak * wave + ripple), velocity


def _spring(velocity: Array) -> Array:
    """Torque of a load that is a spring, over its peak; without a mean."""
    turned = np.cumsum(velocity)
    return np.asarray((turned - turned.mean()) / max(float(np.max(np.abs(turned - turned.mean()))), 1e-9))
