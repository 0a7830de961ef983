"""Experiments of a joint whose two cables are pulled by nuts: the velocity of the nut that pulls cable 1, m/s.

Every run begins at rest where the joint is level with its base, and follows a motion of the joint as rigid cables
would. Groups of runs differ by the preload of the cables and by a payload at the second link.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from tendonlab.blind.description import Array, Experiment

from .recorded import recorded

Draw = np.random.Generator
Shape = Callable[[Array, Draw], Array]

ANCHOR = 0.065  # m, from the axis to where the cables pull
REST, EASE = 0.3, 0.5  # s at the start of each run, and in which a wave grows
LARGEST = 0.65  # rad
GROUPS: tuple[dict[str, float], ...] = (
    {},
    {"pretension": 100.0},
    {"link_2_mass": 0.3},
    {"pretension": -60.0, "link_2_mass": 0.15},
)


def sine(time: Array, draw: Draw) -> Array:
    return np.asarray(draw.choice([-1.0, 1.0]) * np.sin(2.0 * np.pi * draw.uniform(0.12, 0.25) * time))


def multi_sine(time: Array, draw: Draw) -> Array:
    frequencies, phases = draw.uniform(0.1, 0.5, 4), draw.uniform(0, 6.28, 4)
    waves = np.sin(2.0 * np.pi * frequencies[:, None] * time + phases[:, None]) - np.sin(phases)[:, None]
    return np.asarray((0.18 / (0.25 + frequencies)) @ waves)


def growing(time: Array, draw: Draw) -> Array:
    return np.asarray((0.1 + 0.9 * time / time[-1]) * np.sin(2.0 * np.pi * draw.uniform(0.25, 0.4) * time))


def small(time: Array, draw: Draw) -> Array:
    """Little moves there and back on the way to one side."""
    drift = draw.choice([-1.0, 1.0]) * time / time[-1]
    return np.asarray(0.7 * drift + 0.2 * np.sin(2.0 * np.pi * draw.uniform(0.4, 0.7) * time))


def moves(time: Array, draw: Draw) -> Array:
    """Set points, each held for a while; between them an even speed with ramps."""
    return _between(time, draw, rests=(0.4, 0.9))


def turns(time: Array, draw: Draw) -> Array:
    """Set points at which the joint turns back at once."""
    return _between(time, draw, rests=(0.0, 0.0))


def _between(time: Array, draw: Draw, *, rests: tuple[float, float]) -> Array:
    out, at, angle, sense = np.zeros_like(time), 0.0, 0.0, draw.choice([-1.0, 1.0])
    while at < time[-1]:
        goal = sense * draw.uniform(0.3, 1.0)
        lasts = abs(goal - angle) / draw.uniform(0.35, 0.8) + 0.3
        out += (goal - angle) * _trapezoid((time - at) / lasts, min(0.5, 0.3 / lasts))
        at, angle, sense = at + lasts + draw.uniform(*rests), goal, -sense
    return out


def _trapezoid(x: Array, ramp: float) -> Array:
    """Share of a move whose velocity is a trapezoid with ramps of this share of its time."""
    x = np.clip(x, 0.0, 1.0)
    rise, fall = np.minimum(x, ramp), np.maximum(x - 1.0 + ramp, 0.0)
    return np.asarray((0.5 * rise**2 / ramp + (x - rise) - 0.5 * fall**2 / ramp) / (1.0 - ramp))


Plan = tuple[Shape, float, int]  # motion, size, rad, and group
# the motion that is repeated, four more to fit, three held out of another kind, size or group
RICH: tuple[Plan, ...] = (
    (moves, 0.45, 0),
    (turns, 0.5, 1),
    (multi_sine, 0.4, 0),
    (small, 0.45, 2),
    (moves, 0.5, 3),
    (growing, 0.3, 0),
    (turns, 0.4, 2),
    (multi_sine, 0.35, 1),
)
POOR: tuple[Plan, ...] = (
    (sine, 0.4, 0),
    (sine, 0.3, 0),
    (sine, 0.5, 1),
    (sine, 0.2, 2),
    (moves, 0.45, 0),
    (sine, 0.35, 1),
    (turns, 0.4, 0),
    (sine, 0.45, 2),
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
    runs = recorded(draw, plans, lambda plan, by: _velocity(plan, time, by), seconds=seconds, has_repeats=has_repeats)
    return [Experiment(reference=velocity, add=dict(GROUPS[group]), **named) for named, (_, _, group), velocity in runs]


def _velocity(plan: Plan, time: Array, draw: Draw) -> Array:
    """Of the nut, m/s, as the drive logs it."""
    shape, size, _ = plan
    since = np.maximum(time - REST, 0.0)
    x = np.clip(since / EASE, 0.0, 1.0)
    waves = shape not in (moves, turns)  # which begin softly on their own
    eased = x * x * (3.0 - 2.0 * x) if waves else 1.0
    angle = np.clip(size * draw.uniform(0.8, 1.2) * eased * shape(since, draw), -LARGEST, LARGEST)
    velocity = np.gradient(ANCHOR * np.sin(angle), time[1])
    velocity[0] = 0.0
    return np.asarray(np.round(velocity, 9))
