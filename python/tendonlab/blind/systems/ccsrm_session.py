"""What the driver of the two coupled joints does: angle histories of joint 2, rad, and what joint 1 carries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from tendonlab.blind import excitation as motion
from tendonlab.blind.description import Array, Experiment

SMOOTH = 0.06  # s, twice: a drive does not change its speed at once
ARM = 0.2  # m, from the axis to the payload


def ramps(time: Array, draw: motion.Draw, *, size: float = 1.0) -> Array:
    """Ramps at a few speeds with standstill between them and at the end, turning at each."""
    wave = motion.slow_reversals(time, draw, size=size)
    width = max(1, round(SMOOTH / (time[1] - time[0])))
    for _ in range(2):
        wave = uniform_filter1d(wave, width, mode="nearest")
    return np.asarray(wave)


PLANS: dict[str, motion.Plans] = {
    "rich": (
        (ramps, 0.8, False),
        (motion.chirp, 0.5, False),
        (motion.multi_sine, 0.22, False),
        (motion.sine, 0.3, True),
        (ramps, 0.4, True),
        (motion.micro_sine, 1.0, False),
        (motion.sine, 0.45, False),
        (motion.multi_sine, 0.16, True),
    ),
    "poor": (
        (motion.sine, 0.4, False),
        (motion.sine, 0.3, False),
        (motion.sine, 0.5, False),
        (motion.sine, 0.2, False),
        (ramps, 0.8, False),
        (motion.sine, 0.35, False),
        (motion.multi_sine, 0.22, False),
        (motion.sine, 0.4, False),
    ),
}


def session(
    draw: motion.Draw, *, excitation: str, sample_time: float, num_samples: int, has_repeats: bool = True
) -> list[Experiment]:
    """Like `excitation.session`; a payload only adds to the inertia of joint 1."""
    runs = motion.session(
        draw,
        excitation=excitation,
        sample_time=sample_time,
        num_samples=num_samples,
        has_repeats=has_repeats,
        arm=ARM,
        plans=PLANS,
    )
    return [replace(run, add={n: x for n, x in run.add.items() if n == "joint_inertia"}) for run in runs]
