"""Motions that a rig could be asked to make: within the travel, speed and acceleration that its logs show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from tendonlab.fitting.case import Case
from tendonlab.report.numbers import unit_text
from tendonlab.simulation.catalog import unit as unit_of
from tendonlab.simulation.system import System

DURATION, RATE = 6.0, 250.0
EASE = 0.5  # s in which a motion starts from rest
SEEN = 0.995  # quantile of logged speeds and accelerations that a rig is taken to manage
SLOWEST, USUAL, FULL = 0, 1, 2  # of `paths`
NUM_SPEEDS, SLOW = 5, 0.03  # constant speeds, and the slowest one as a share of the fastest
SPARE, CORNER = 0.9, 0.25  # share of the travel that they use, and of each way in which they turn


@dataclass(frozen=True)
class Motion:
    """A position path of the looped axis at `RATE`, in words. `payload`: effort of gravity at 90 degrees that a load
    adds to the parameter in the role "payload", N·m or N."""

    words: str
    path: np.ndarray
    payload: float = 0.0

    def payload_of(self, system: System) -> dict[str, float]:
        """What the load adds to the parameters of `system`."""
        row = system.info.with_role("payload")
        return {} if row is None or not self.payload else {row.name: self.payload}


@dataclass(frozen=True)
class Reach:
    """What the logs show of the looped axis."""

    middle: float
    travel: float
    speed: float
    acceleration: float
    unit: str


def instants() -> np.ndarray:
    """Of the samples of a motion, s."""
    return np.arange(0.0, DURATION, 1 / RATE)


def eased(path: np.ndarray, seconds: float = EASE) -> np.ndarray:
    """A path that leaves its first position from rest within `seconds`."""
    x = np.clip(instants() / seconds, 0, 1)
    return np.asarray(path[0] + x**2 * (3 - 2 * x) * (path - path[0]))


def motions(case: Case, output: str) -> list[Motion]:
    """Slow, middling and full reversals, a sweep, micro motion and constant speeds; full reversals with more payload
    where gravity acts."""
    made = paths(seen_reach(case, case.outputs.index(output)), output.replace("_", " "))
    row = case.system.info.with_role("payload")
    gravity = 0.0 if row is None else case.system.parameters[row.name]
    if gravity != 0.0:
        heavier = 0.5 * abs(gravity)
        full = made[FULL]
        effort = unit_text(unit_of("effort", case.system.axis))
        words = f"{full.words}, with a load that adds {heavier:.2g} {effort} of gravity at 90 degrees"
        made.append(Motion(words, full.path, heavier))
    return made


def paths(reach: Reach, place: str) -> list[Motion]:
    """Slow, middling and full reversals, a sweep, micro motion and constant speeds."""
    return [
        _reversals(reach, place, "slow reversals", 0.1, 0.1),
        _reversals(reach, place, "reversals", 0.5, 0.5),
        _reversals(reach, place, "full-travel triangles", 1.0, 1.0),
        _sweep(reach, place),
        _micro_motion(reach, place),
        _constant_speeds(reach, place),
    ]


def rested(motion: Motion) -> Motion:
    """The motion after a rest of half its duration: the same places and speeds, later."""
    wait = round(0.5 * DURATION * RATE)
    path = np.concatenate([np.full(wait, motion.path[0]), eased(motion.path)[:-wait]])
    return replace(motion, words=f"a rest of {0.5 * DURATION:g} s, then {motion.words}", path=path)


def seen_reach(case: Case, c: int) -> Reach:
    """What the logs show of output c."""
    runs = [
        (experiment.time, ready.measured[c]) for experiment, ready in zip(case.experiments, case.prepared, strict=True)
    ]
    return reach_of(runs, "m" if case.system.axis == "linear" else "rad")


def reach_of(runs: Sequence[tuple[np.ndarray, np.ndarray]], unit: str) -> Reach:
    """What logs of one signal, in `unit`, show: time and samples of each."""
    positions, speeds, accelerations = [], [], []
    for stamps, samples in runs:
        kept = np.isfinite(samples)
        time = np.asarray(stamps)[kept]
        width = max(1, round(0.02 * len(time) / (time[-1] - time[0])))
        x = np.convolve(samples[kept], np.ones(width) / width, mode="valid")
        v = np.gradient(x, time[: len(x)])
        positions.append(x)
        speeds.append(np.abs(v))
        accelerations.append(np.abs(np.gradient(v, time[: len(x)])))
    whole = np.concatenate(positions)
    return Reach(
        middle=float(np.median(whole)),
        travel=float(np.ptp(whole)) / 2,
        speed=float(np.quantile(np.concatenate(speeds), SEEN)),
        acceleration=float(np.quantile(np.concatenate(accelerations), SEEN)),
        unit=unit,
    )


def _reversals(reach: Reach, place: str, kind: str, share: float, of_speed: float) -> Motion:
    """Triangles, their corners rounded to the acceleration that was seen: at least one, so narrow that the rig goes
    through it at the speed that was seen."""
    span, speed = min(share * reach.travel, reach.speed * DURATION / 4), of_speed * reach.speed
    cycles = max(1.0, speed * DURATION / (4 * span))
    triangle = 2 / np.pi * np.arcsin(np.sin(2 * np.pi * cycles * instants() / DURATION))
    reached = 4 * span * cycles / DURATION
    words = f"{kind} of the {place} over ±{span:.2g} {reach.unit} at {reached:.2g} {reach.unit}/s"
    return Motion(words, reach.middle + _rounded(span * triangle, 2 * reached / reach.acceleration))


def _sweep(reach: Reach, place: str) -> Motion:
    span, top = 0.3 * reach.travel, 3.0
    span = min(span, reach.speed / (2 * np.pi * top), reach.acceleration / (2 * np.pi * top) ** 2)
    path = reach.middle + span * np.sin(2 * np.pi * (0.2 * instants() + 0.5 * (top - 0.2) * instants() ** 2 / DURATION))
    return Motion(f"a sine sweep of the {place} from 0.2 to 3 Hz over ±{span:.2g} {reach.unit}", path)


def _micro_motion(reach: Reach, place: str) -> Motion:
    small = 0.01 * reach.travel
    stairs = 0.3 * reach.travel * np.round(4 / np.pi * np.arcsin(np.sin(2 * np.pi * instants() / DURATION)))
    moved = _rounded(stairs, np.sqrt(1.2 * reach.travel / reach.acceleration) + 0.3 * reach.travel / reach.speed)
    path = reach.middle + moved + small * np.sin(2 * np.pi * 2 * instants())
    words = f"micro motion of the {place}, ±{small:.2g} {reach.unit} at 2 Hz about several positions"
    return Motion(words, path)


def _constant_speeds(reach: Reach, place: str) -> Motion:
    """Forth and back from one place, at one constant speed after another: what friction follows with its speed."""
    lasts = DURATION / (2 * NUM_SPEEDS)  # one way
    top = min(reach.speed, SPARE * 2 * reach.travel / lasts, reach.acceleration * CORNER * lasts / 2)
    speeds = top * np.geomspace(SLOW, 1.0, NUM_SPEEDS)
    each, since = np.divmod(instants(), 2 * lasts)
    path = speeds[each.astype(int)] * np.minimum(since, 2 * lasts - since) + reach.middle - top * lasts / 2
    over = f"over at most ±{top * lasts / 2:.2g} {reach.unit} at {speeds[0]:.2g} to {top:.2g} {reach.unit}/s"
    return Motion(f"constant speeds of the {place}, forth and back {over}", _rounded(path, CORNER * lasts))


def _rounded(path: np.ndarray, seconds: float) -> np.ndarray:
    """Averaged twice over a window: corners become parabolas, steps become smooth moves."""
    width = max(1, round(min(seconds, 0.25 * DURATION) * RATE))
    for _ in range(2):
        padded = np.pad(path, (width // 2, width - 1 - width // 2), mode="edge")
        path = np.convolve(padded, np.ones(width) / width, mode="valid")
    return path
