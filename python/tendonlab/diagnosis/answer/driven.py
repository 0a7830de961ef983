"""A planned experiment on a rig whose logs prescribe all that drives it: inputs within the range, the speed and the
rate of change that the logs show of each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from tendonlab.data.units import convert
from tendonlab.diagnosis.answer.motions import DURATION, RATE, Motion, Reach, eased, instants, paths, reach_of, rested
from tendonlab.diagnosis.answer.plan import Played
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.report.numbers import unit_text
from tendonlab.report.words import listing, words
from tendonlab.simulation.catalog import InputInfo, unit
from tendonlab.simulation.system import System

PLACES, SPEEDS = ("angle", "displacement"), ("flow", "speed", "angular_speed")
SLOWEST, FULL = 0, 2  # of `paths`: those that are also made under changing loads
SPARE = 0.1  # of the range of an output, by which a planned experiment may leave it
LOADED = 0.9  # of the range of a load that is used: single samples may have been further out


@dataclass(frozen=True)
class Driven:
    """Every input that drives the rig, SI, at `instants()`. `like`: index of the experiment whose conditions hold."""

    words: str
    inputs: Mapping[str, np.ndarray]
    like: int

    def stated(self, case: Case) -> dict[str, dict[str, float]]:
        """The conditions of the experiment that it is like."""
        like = case.experiments[self.like]
        return {key: dict(given) for key, given in (("add", like.add), ("conditions", like.conditions)) if given}

    def reference(self, case: Case) -> pd.DataFrame:
        """`t` in s, and the inputs as the logs have them: their columns and units."""
        specs = [(case.dataset.signals[name], values) for name, values in self.inputs.items()]
        columns = {spec.column: convert(values, unit=spec.si_unit, to=spec.unit) for spec, values in specs}
        return pd.DataFrame({"t": instants(), **columns})

    def played(self, case: Case, of: System, *, ports: bool = False) -> Played:
        """What a rig that `of` is would do and log, begun where the first training experiment began. Raises
        NumericalError where an output would leave the range that the logs show."""
        like, held = case.experiments[case.train[0]], case.experiments[self.like]
        time = np.arange(0.0, instants()[-1], float(np.median(np.diff(like.time))))
        columns = {name: np.full(len(time), _first(like.data[name])) for name in like.data.columns}
        columns |= {name: np.interp(time, instants(), values) for name, values in self.inputs.items()}
        there = replace(like, conditions=held.conditions, add=held.add, repeat=None, averaged=False)
        planned = replace(there, name="next", data=pd.DataFrame(columns, index=time))
        run = case.playing(planned).run(0, of, ports=ports)
        made = dict(zip(case.outputs, run["outputs"], strict=True))
        _require_seen(case, made)
        data = pd.DataFrame({n: made.get(n, values) for n, values in columns.items()}, index=pd.Index(time, name="t"))
        return Played(replace(planned, data=data), run)


def drives(case: Case, *, rests: bool = False) -> list[Driven]:
    """Reversals at three speeds, a sweep and micro motion of the inputs that move the rig, other inputs held; and
    reversals under loads that change slowly or with the motion. `rests`: also reversals after a rest; else also the
    last full reversals under the other conditions of the training experiments."""
    given = [_Channel.of(case, row) for row in case.system.info.inputs if _is_logged(case, row)]
    varying = [one for one in given if one.reach.travel > 0]
    moved = [one for one in varying if one.row.dimension in (*PLACES, *SPEEDS)]
    moved = moved or [one for one in varying if one.row.required]
    loads = [one for one in varying if one not in moved and not one.row.limit and one.row.dimension != "ratio"]
    if not moved:
        return []
    shapes, others = [_shapes(one, rests) for one in moved], [one for one in given if one not in moved]
    made = [Driven(said, inputs, case.train[0]) for said, inputs in _combined(moved, loads, others, shapes)]
    full = [plan for plan in made if plan.words.startswith(shapes[0][FULL].words)]
    return made + ([] if rests else [_under(case, full[min(1, len(full) - 1)], i) for i in _other_conditions(case)])


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
    return replace(plan, words=f"{plan.words}, at a {listing(values)}" if changed else plan.words, like=i)


def _combined(
    moved: list[_Channel], loads: list[_Channel], others: list[_Channel], shapes: list[list[Motion]]
) -> Iterator[tuple[str, dict[str, np.ndarray]]]:
    """Words and inputs of each plan."""
    held = {one.row.name: one.along(one.still) for one in others}
    slowly = {one.row.name: one.along(one.swept(np.sin(2 * np.pi * instants() / DURATION))) for one in loads}
    place = listing(one.place for one in loads)
    for k, together in enumerate(zip(*shapes, strict=True)):  # what moves a rig does so
        said = together[0].words
        moving = {one.row.name: one.along(motion.path) for one, motion in zip(moved, together, strict=True)}
        yield said, held | moving
        if loads and k in (SLOWEST, FULL):
            yield f"{said} while the {place} slowly goes through its range", held | moving | slowly
        if loads and k == FULL:
            with_it = {one.row.name: one.along(one.swept(_unit(together[0].path))) for one in loads}
            yield f"{said} while the {place} follows the motion", held | moving | with_it


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
        return words(self.row.name.removesuffix("_velocity") if self.row.dimension in SPEEDS else self.row.name)

    @property
    def still(self) -> np.ndarray:
        return np.full(len(instants()), self.reach.middle)

    def swept(self, shape: np.ndarray) -> np.ndarray:
        """Its range along a shape from -1 to 1."""
        return np.asarray(self.reach.middle + LOADED * self.reach.travel * shape)

    def along(self, path: np.ndarray) -> np.ndarray:
        """The input that follows a path: led there from its start, and played as slowly as its speed and acceleration
        in the logs ask for."""
        led = CubicSpline(instants(), _led(path, self.start, self.reach))
        speed, bend = (float(np.max(np.abs(led(instants(), order)))) for order in (1, 2))
        slower = max(1.0, _over(speed, self.reach.speed), np.sqrt(_over(bend, self.reach.acceleration)))
        if self.row.dimension in SPEEDS:
            return np.asarray(led(instants() / slower, 1) / slower)
        return np.asarray(led(instants() / slower))


def _led(path: np.ndarray, start: float, reach: Reach) -> np.ndarray:
    """A smooth move from `start`, then the path from rest."""
    away = abs(path[0] - start)
    lasts = max(1.5 * _over(away, reach.speed), np.sqrt(6.0 * _over(away, reach.acceleration)))
    num = int(np.ceil(min(lasts, 0.5 * DURATION) * RATE))
    x = np.arange(num) / max(num, 1)
    return np.concatenate([start + x**2 * (3 - 2 * x) * (path[0] - start), eased(path)])[: len(path)]


def _over(part: float, whole: float) -> float:
    return part / whole if part > 0.0 else 0.0


def _shapes(channel: _Channel, rests: bool) -> list[Motion]:
    made = paths(channel.reach, channel.place)
    return [*made, rested(made[1])] if rests else made


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
