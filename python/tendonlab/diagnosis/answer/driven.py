"""A planned experiment on a rig whose logs prescribe all that drives it: inputs within the range, the speed and the
rate of change that the logs show of each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from tendonlab.data.units import convert
from tendonlab.diagnosis.answer.motions import (
    DURATION,
    EASE,
    FULL,
    RATE,
    SLOWEST,
    USUAL,
    Motion,
    Reach,
    eased,
    instants,
    paths,
    reach_of,
    rested,
)
from tendonlab.diagnosis.answer.plan import Played
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.report.numbers import unit_text
from tendonlab.report.words import listing, words
from tendonlab.simulation.catalog import InputInfo, unit
from tendonlab.simulation.system import System

PLACES, SPEEDS = ("angle", "displacement"), ("flow", "speed", "angular_speed")
SLOWLY = "slowly goes through its range"
MOST_SLOWED, SLOWED = 2.0, 1.1  # times, by which a plan may be slower than its motions, and from which its words say so
EASES, LONGEST_EASE = 3.4, 2.0  # times speed over acceleration: how long it takes to reach a speed from rest; s
MOVES = 1e-6  # of its range: what an input that moves changes by in a second
SPARE = 0.1  # of the range of an output, by which a planned experiment may leave it
LOADED = 0.9  # of the range of a load that is used: single samples may have been further out


@dataclass(frozen=True)
class Driven:
    """Every input that drives the rig, SI, at `time`. `like`: index of the experiment whose conditions hold. `slower`:
    how many times longer than `instants()` it takes."""

    words: str
    inputs: Mapping[str, np.ndarray]
    like: int
    slower: float = 1.0

    @property
    def time(self) -> np.ndarray:
        """Of the samples, s."""
        return instants() * self.slower

    def stated(self, case: Case) -> dict[str, dict[str, float]]:
        """The conditions of the experiment that it is like."""
        like = case.experiments[self.like]
        return {key: dict(given) for key, given in (("add", like.add), ("conditions", like.conditions)) if given}

    def reference(self, case: Case) -> pd.DataFrame:
        """`t` in s, and the inputs as the logs have them: their columns and units."""
        names = [row.name for row in case.system.info.inputs if row.name in self.inputs]
        specs = [(case.dataset.signals[name], self.inputs[name]) for name in names]
        columns = {spec.column: convert(values, unit=spec.si_unit, to=spec.unit) for spec, values in specs}
        return pd.DataFrame({"t": self.time, **columns})

    def played(self, case: Case, of: System, *, ports: bool = False) -> Played:
        """What a rig that `of` is would do and log, begun where the first training experiment began. Raises
        NumericalError where an output would leave the range that the logs show."""
        like, held = case.experiments[case.train[0]], case.experiments[self.like]
        time = np.arange(0.0, self.time[-1], float(np.median(np.diff(like.time))))
        columns = {name: np.full(len(time), _first(like.data[name])) for name in like.data.columns}
        columns |= {name: np.interp(time, self.time, values) for name, values in self.inputs.items()}
        there = replace(like, conditions=held.conditions, add=held.add, repeat=None, averaged=False)
        planned = replace(there, name="next", data=pd.DataFrame(columns, index=time))
        run = case.playing(planned).run(0, of, ports=ports)
        made = dict(zip(case.outputs, run["outputs"], strict=True))
        _require_seen(case, made)
        data = pd.DataFrame({n: made.get(n, values) for n, values in columns.items()}, index=pd.Index(time, name="t"))
        return Played(replace(planned, data=data), run)


def drives(case: Case, *, rests: bool = False) -> list[Driven]:
    """Reversals at three speeds, a sweep, micro motion and constant speeds of the inputs that move the rig, other
    inputs held; and reversals under loads that change slowly or with the motion. `rests`: also reversals after a rest;
    else also the full reversals, under a load that changes slowly where there is one, under the other conditions of the
    training experiments. None that the inputs could follow only much more slowly than its words say."""
    given = [_Channel.of(case, row) for row in case.system.info.inputs if _is_logged(case, row)]
    varying = [one for one in given if one.reach.speed > MOVES * one.reach.travel > 0]
    moved = [one for one in varying if one.row.dimension in (*PLACES, *SPEEDS)]
    moved = moved or [one for one in varying if one.row.required]
    loads = [one for one in varying if one not in moved and not one.row.limit and one.row.dimension != "ratio"]
    if not moved:
        return []
    shapes, others = [_shapes(one, rests) for one in moved], [one for one in given if one not in moved]
    others = [one for one in others if one not in loads]
    made = [
        Driven(said, inputs, case.train[0], slower) for said, inputs, slower in _combined(moved, loads, others, shapes)
    ]
    full = [plan for plan in made if plan.words.startswith(shapes[0][FULL].words)]
    differing = _other_conditions(case)
    if not differing or not full:
        return made
    chosen = next((plan for plan in full if SLOWLY in plan.words), full[0])
    usual = [_under(case, plan, case.train[0]) for plan in made]
    return usual + ([] if rests else [_under(case, chosen, i) for i in differing])


def _other_conditions(case: Case) -> list[int]:
    """The first training experiment under each set of conditions but that of the very first."""
    found: dict[str, int] = {}
    for i in case.train:
        found.setdefault(repr(sorted(_conditions(case, i).items())), i)
    return list(found.values())[1:]


def _conditions(case: Case, i: int) -> dict[str, float]:
    """Parameters of the rig under the conditions of an experiment, where these change any."""
    e, usual = case.experiments[i], case.system.parameters
    there = {name: e.conditions.get(name, usual.get(name, 0.0)) + e.add.get(name, 0.0) for name in e.conditions | e.add}
    return {name: value for name, value in there.items() if name in usual and value != usual[name]}


def _under(case: Case, plan: Driven, i: int) -> Driven:
    """The plan under the conditions of experiment i."""
    changed = _conditions(case, i)
    values = (f"{words(n)} of {v:.3g} {unit_text(case.system.unit(n))}".rstrip() for n, v in changed.items())
    where = f"at a {listing(values)}" if changed else "under the nominal conditions"
    return replace(plan, words=f"{plan.words}, {where}", like=i)


def _combined(
    moved: list[_Channel], loads: list[_Channel], others: list[_Channel], shapes: list[list[Motion]]
) -> Iterator[tuple[str, dict[str, np.ndarray], float]]:
    """Words and inputs of each plan that the inputs can follow, and how many times slower than `instants()`."""
    channels = [*moved, *loads, *others]
    resting, still = [one.rest for one in loads], [one.rest for one in others]
    slowly = [one.swept(-np.cos(2 * np.pi * instants() / DURATION)) for one in loads]
    place = listing(one.place for one in loads)
    for k, together in enumerate(zip(*shapes, strict=True)):  # what moves a rig does so
        said, moving = together[0].words, [motion.path for motion in together]
        asked = [(said, resting)]
        if loads and k in (SLOWEST, FULL):
            asked.append((f"{said} while the {place} {SLOWLY}", slowly))
        if loads and k == FULL:
            with_it = [one.swept(_unit(together[0].path)) for one in loads]
            asked.append((f"{said} while the {place} follows the motion", with_it))
        for text, loading in asked:
            followed = list(zip(channels, [*moving, *loading, *still], strict=True))
            slower = max(one.slowing(path) for one, path in followed)
            if slower <= MOST_SLOWED:
                inputs = {one.row.name: one.along(path, slower) for one, path in followed}
                yield text + (f", {slower:.1f} times slower" if slower > SLOWED else ""), inputs, slower


@dataclass(frozen=True)
class _Channel:
    """An input as the logs show it. `reach`: of the way gone where the input is a speed, of the input itself elsewhere;
    `start`: where the first training experiment begins."""

    row: InputInfo
    reach: Reach
    start: float

    @classmethod
    def of(cls, case: Case, row: InputInfo) -> _Channel:
        runs = [(e.time, e.data[row.name].to_numpy(dtype=float)) for e in case.experiments if row.name in e.data]
        measured = unit(row.dimension, case.system.axis)
        if row.dimension in SPEEDS:
            from scipy.integrate import cumulative_trapezoid

            gone = [(time, cumulative_trapezoid(values, time, initial=0.0)) for time, values in runs]
            return cls(row, reach_of(gone, measured.removesuffix("/s")), 0.0)
        first = case.experiments[case.train[0]].data[row.name]
        return cls(row, reach_of(runs, unit_text(measured)), _first(first))

    @property
    def place(self) -> str:
        """Its noun in a description."""
        name = self.row.name
        return f"{words(name.removesuffix('_velocity'))} position" if self.row.dimension in SPEEDS else words(name)

    @property
    def rest(self) -> np.ndarray:
        """The path of an input that is held: in the middle of what the logs show, or where it starts if it cannot be
        led there."""
        middle = np.full(len(instants()), self.reach.middle)
        return middle if self.slowing(middle) <= MOST_SLOWED else np.full(len(instants()), self.start)

    def swept(self, shape: np.ndarray) -> np.ndarray:
        """Its range along a shape from -1 to 1."""
        return np.asarray(self.reach.middle + LOADED * self.reach.travel * shape)

    def slowing(self, path: np.ndarray) -> float:
        """How many times slower the input must follow a path, for its speed and acceleration in the logs."""
        led = self._to(path)
        speed, bend = (float(np.max(np.abs(led(instants(), order)))) for order in (1, 2))
        return max(1.0, _over(speed, self.reach.speed), float(np.sqrt(_over(bend, self.reach.acceleration))))

    def along(self, path: np.ndarray, slower: float) -> np.ndarray:
        """The input that follows a path, led there from its start, so many times slower."""
        led = self._to(path)
        if self.row.dimension not in SPEEDS:
            return np.asarray(led(instants()))
        speed = np.asarray(led(instants(), 1) / slower)
        speed[0] = 0.0  # what rounding leaves there would have a sense, and friction would start with it
        return speed

    def _to(self, path: np.ndarray) -> CubicSpline:
        return CubicSpline(instants(), _led(path, self.start, self.reach), bc_type=((1, 0.0), "not-a-knot"))


def _led(path: np.ndarray, start: float, reach: Reach) -> np.ndarray:
    """A smooth move from `start`, then the path from rest."""
    away = abs(path[0] - start)
    lasts = max(1.5 * _over(away, reach.speed), np.sqrt(6.0 * _over(away, reach.acceleration)))
    num = int(np.ceil(min(lasts, 0.5 * DURATION) * RATE))
    x = np.arange(num) / max(num, 1)
    first = RATE * abs(float(path[1] - path[0]))
    gently = eased(path, min(max(EASE, EASES * _over(first, reach.acceleration)), LONGEST_EASE))
    return np.concatenate([start + x**2 * (3 - 2 * x) * (path[0] - start), gently])[: len(path)]


def _over(part: float, whole: float) -> float:
    return 0.0 if not part > 0.0 else part / whole if whole > 0.0 else np.inf


def _shapes(channel: _Channel, rests: bool) -> list[Motion]:
    made = paths(channel.reach, channel.place)
    return [*made, rested(made[USUAL])] if rests else made


def _unit(path: np.ndarray) -> np.ndarray:
    """A path scaled to the range from -1 to 1."""
    return np.asarray(2.0 * (path - path.min()) / np.ptp(path) - 1.0)


def _is_logged(case: Case, row: InputInfo) -> bool:
    columns = case.experiments[case.train[0]].data.columns
    return row.name in columns and row.replaced_by not in columns


def _first(samples: pd.Series) -> float:
    kept = samples.dropna()
    return float(kept.iloc[0]) if len(kept) else np.nan


def _require_seen(case: Case, made: Mapping[str, np.ndarray]) -> None:
    for c in case.measured:
        seen = np.concatenate([ready.measured[c] for ready in case.prepared])
        low, high = np.nanmin(seen), np.nanmax(seen)
        planned, spare = made[case.outputs[c]], SPARE * (high - low)
        if not (low - spare <= planned.min() and planned.max() <= high + spare):
            raise NumericalError(f"{case.outputs[c]} would leave the range that the logs show")
