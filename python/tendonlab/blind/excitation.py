"""The commanded motion: joint reference angles of ten experiments, rad, as a session with breaks between
them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from .description import Experiment

Array = NDArray[np.float64]
Draw = np.random.Generator

NUM_EXPERIMENTS = 10
GRAVITY = 9.81  # m/s^2
ARM = 0.25  # m from the axis to the payload


def slow_reversals(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    """Ramps at a few low speeds with standstill between them, turning at each."""
    speeds = size * draw.uniform(0.05, 0.6, 5) * np.array([1, -1, 1, -1, 1])
    moves = draw.uniform(0.35, 0.6, 5)
    rests = draw.uniform(0.12, 0.3, 5)
    knots, angles = [0.0], [0.0]
    for speed, move, rest in zip(speeds, moves, rests, strict=True):
        knots += [knots[-1] + rest, knots[-1] + rest + move]
        angles += [angles[-1], angles[-1] + speed * move]
    return np.interp(time, knots, angles)


def sine(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    frequency = draw.uniform(0.4, 1.2)
    return np.asarray(size * draw.uniform(0.35, 0.6) * np.sin(2 * np.pi * frequency * time))


def chirp(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    first, last = draw.uniform(0.2, 0.5), draw.uniform(3.0, 5.0)
    phase = 2 * np.pi * (first * time + (last - first) * time**2 / (2 * time[-1]))
    speed = 2 * np.pi * (first + (last - first) * time / time[-1])
    return np.asarray(size * draw.uniform(0.3, 0.45) * np.sin(phase) / (1.0 + (speed / 8.0) ** 1.5))


def multi_sine(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    frequencies = draw.uniform(0.25, 4.0, 5)
    waves = [
        np.sin(2 * np.pi * f * time + p) / (1 + f**1.3)
        for f, p in zip(frequencies, draw.uniform(0, 6.28, 5), strict=True)
    ]
    return np.asarray(size * draw.uniform(0.25, 0.4) * np.sum(waves, axis=0))


def steps(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    """Fast moves of 0.15 to 0.3 s to random angles, each followed by standstill."""
    angle, at, out = 0.0, draw.uniform(0.2, 0.4), np.zeros_like(time)
    while at < time[-1] - 0.3:
        target = size * draw.uniform(0.15, 0.6) * draw.choice([-1.0, 1.0])
        x = np.clip((time - at) / draw.uniform(0.15, 0.3), 0.0, 1.0)
        out += (target - angle) * x**3 * (10 - 15 * x + 6 * x**2)
        angle, at = target, at + draw.uniform(0.5, 0.8)
    return out


def staircase(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    """One-way moves with standstill, then back: loads the cable from rest to the far angle."""
    levels = size * np.array([0.0, 0.2, 0.45, 0.75, 0.4, 0.05]) * draw.uniform(0.8, 1.2)
    knots = np.linspace(0.2, time[-1] - 0.4, levels.size)
    out = np.full_like(time, levels[0])
    for left, right, at in zip(levels[:-1], levels[1:], knots[1:], strict=True):
        x = np.clip((time - at + 0.35) / 0.35, 0.0, 1.0)
        out += (right - left) * x * x * (3 - 2 * x)
    return out


def micro_sine(time: Array, draw: Draw, *, size: float = 1.0) -> Array:
    """Sines of growing amplitude, from presliding to sliding."""
    grow = 0.004 + 0.12 * (time / time[-1]) ** 2
    return np.asarray(size * grow * np.sin(2 * np.pi * draw.uniform(0.7, 1.4) * time))


Shape = Callable[..., Array]
# kind, size, payload: three repeats and four more to fit, three held out of another kind, amplitude or load
Plan = tuple[Shape, float, bool]
Plans = tuple[Plan, ...]
RICH: Plans = (
    (slow_reversals, 1.0, False),
    (chirp, 1.0, False),
    (multi_sine, 1.0, False),
    (steps, 1.0, False),
    (slow_reversals, 0.7, True),
    (micro_sine, 1.0, False),
    (sine, 1.3, False),
    (staircase, 1.0, True),
)
POOR: Plans = (
    (sine, 1.0, False),
    (sine, 0.7, False),
    (sine, 1.2, False),
    (sine, 0.5, False),
    (slow_reversals, 1.0, False),
    (sine, 0.85, False),
    (multi_sine, 0.8, False),
    (sine, 1.0, False),
)
PLANS: Mapping[str, Plans] = MappingProxyType({"rich": RICH, "poor": POOR})


def session(
    draw: Draw,
    *,
    excitation: str,
    sample_time: float,
    num_samples: int,
    has_repeats: bool = True,
    arm: float = ARM,
    plans: Mapping[str, Plans] = PLANS,
) -> list[Experiment]:
    """Ten experiments, "rich" or "poor", in the order recorded; one repeated at the start, in the middle and at the
    end. Without repeats, other motions of the same kind take the places of the second and third. The payload hangs
    `arm` m from the axis. `plans`: what is recorded under each excitation.
    """
    time: Array = np.arange(num_samples, dtype=float) * sample_time
    repeated, train, test = plans[excitation][0], plans[excitation][1:5], plans[excitation][5:]
    order = [("train", p) for p in train] + [("test", p) for p in test]
    order = [order[i] for i in draw.permutation(len(order))]
    first = motion(repeated, time, draw)
    others = [first, first] if has_repeats else _fresh(repeated, time, draw)
    again, label = iter([first, *others]), "A" if has_repeats else None
    slots: list[tuple[str, str | None, Array, bool]] = []
    for i, (split, plan) in enumerate(order):
        if i in (0, 4):
            slots.append(("train", label, next(again), False))
        slots.append((split, None, motion(plan, time, draw), plan[2]))
    slots.append(("train", label, next(again), False))
    return _runs(slots, draw, seconds=num_samples * sample_time, arm=arm)


def _fresh(plan: Plan, time: Array, draw: Draw) -> list[Array]:
    """Two more motions of a kind, from a stream of their own: all else is drawn alike with and without repeats."""
    fresh = draw.spawn(1)[0]
    return [motion(plan, time, fresh) for _ in range(2)]


def _runs(
    slots: list[tuple[str, str | None, Array, bool]], draw: Draw, *, seconds: float, arm: float
) -> list[Experiment]:
    """The experiments of (split, repeat, reference, whether with payload) in turn, with breaks between them."""
    mass, start, runs = float(np.round(draw.uniform(0.12, 0.25), 2)), 0.0, []
    for i, (split, repeat, reference, loaded) in enumerate(slots):
        kg = mass if loaded else 0.0
        add = {"gravity_torque": kg * (GRAVITY * arm), "joint_inertia": kg * (arm * arm)} if loaded else {}
        add = {name: float(f"{value:.6g}") for name, value in add.items()}
        runs.append(
            Experiment(
                name=f"run-{i + 1:02d}",
                reference=reference,
                start=start,
                split=split,
                repeat=repeat,
                payload=kg,
                add=add,
            )
        )
        start = float(np.round(start + seconds + draw.uniform(15, 60), 1))
    return runs


def motion(plan: Plan, time: Array, draw: Draw) -> Array:
    """A motion of a kind about a random angle, from standstill."""
    shape, size, _ = plan
    centre = draw.uniform(-0.5, 0.5)
    wave = shape(time, draw, size=size)
    x = np.clip((time - 0.1) / 0.4, 0.0, 1.0)  # from standstill: the log begins at rest
    eased = wave[0] + (wave - wave[0]) * x**3 * (10 - 15 * x + 6 * x**2)
    return np.asarray(centre + eased)
