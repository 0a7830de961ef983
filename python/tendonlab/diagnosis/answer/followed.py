"""What an unknown cause follows: place, speed, load, history or time. Maps of the residual over each compete, and an
experiment is worth the nats that it brings between the best two (docs/method.md)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from tendonlab.diagnosis.answer.next_experiments import contradiction, plans, ranked
from tendonlab.diagnosis.answer.plan import Plan
from tendonlab.diagnosis.discrepancy import FOLLOWED_REPEATED, NUM_KNOTS, NUM_TIMES, SLOW, Cells, ridge, share_predicted
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import integrated_time
from tendonlab.simulation.catalog import PORT_QUANTITIES
from tendonlab.simulation.prepare import Replay

RATE = 50.0  # samples per second of a map
ANYTHING = 1.0  # nats below which an experiment tells nothing of the residual
QUANTITIES = ("position", "velocity", "load")


class Seen(NamedTuple):
    """What a model does in an experiment: its simulation, ports recorded, and the instants of its samples. Of these
    every so many counts, about `RATE` per second: residuals have a longer memory."""

    run: Mapping[str, Any]
    time: np.ndarray

    @property
    def kept(self) -> slice:
        """The samples that count."""
        return slice(None, None, max(1, int((len(self.time) - 1) / (self.time[-1] - self.time[0]) / RATE)))

    def at(self, port: int, quantity: str) -> np.ndarray:
        """One quantity at one port."""
        return np.asarray(self.run["ports"][port][PORT_QUANTITIES.index(quantity)][self.kept])

    def since_start(self) -> np.ndarray:
        """Time since the experiment began, s."""
        return np.asarray((self.time - self.time[0])[self.kept])


Look = Callable[[Seen], tuple[np.ndarray, np.ndarray]]  # velocity at a port, and what a map is over, of each sample


@dataclass(frozen=True)
class Description:
    """The residual of one output as a map over `coordinate`, which regimes name so, and over the direction of motion.
    `look`: what the map sees of a simulation. `share`: of the residual's mean square that it predicts of other
    experiments. `weights` and `precision`: of its cells. `level`: rms of what it leaves. `counts`: share of the rows
    that count as independent."""

    coordinate: str
    look: Look
    cells: Cells
    share: float
    weights: np.ndarray
    precision: np.ndarray
    level: float
    counts: float

    def rows(self, seen: Seen) -> np.ndarray:
        """Weights of the cells at each sample."""
        return self.cells.at(*self.look(seen))

    def against(self, true: Description, seen: Seen) -> float:
        """Nats that a log counts against this description where the other one is `true`."""
        scale, own, its = np.sqrt(self.counts) / self.level, self.rows(seen), true.rows(seen)
        return contradiction(scale * (its @ true.weights - own @ self.weights), scale * own, self.precision)


@dataclass(frozen=True)
class Coverage:
    """A map that adds up those of all descriptions. `precision`: of its cells after the logs that exist, in units of
    what one independent sample tells; beforehand a cell is known to the rms of the residual."""

    parts: Sequence[Description]
    precision: np.ndarray
    counts: float

    @classmethod
    def of(cls, parts: Sequence[Description], runs: Sequence[Seen]) -> Coverage:
        """After these `runs`."""
        counts = min(part.counts for part in parts)
        a = np.concatenate([np.concatenate([part.rows(seen) for part in parts], axis=1) for seen in runs])
        return cls(parts, np.eye(a.shape[1]) + counts * a.T @ a, counts)

    def gain(self, seen: Seen) -> float:
        """Nats that a log tells of the map: by how much it lessens the entropy of the cells."""
        a = np.concatenate([part.rows(seen) for part in self.parts], axis=1)
        _, before = np.linalg.slogdet(self.precision)
        _, after = np.linalg.slogdet(self.precision + self.counts * a.T @ a)
        return 0.5 * float(after - before)


def advise_unknown(case: Case, driven: Replay, model: Fitted) -> list[dict[str, Any]]:
    """Experiments on a rig that `model` does not explain, best first, each with its `reference`: ranked by the nats
    that they are expected to bring between the two best descriptions of what the model leaves. Where these predict no
    more than noise does, or nothing separates them, the one that tells most of a map over all coordinates together."""
    planned = plans(case, driven, rests=True)
    if not planned:
        return []
    runs = [
        Seen(case.run(i, model.system, own, ports=True), case.experiments[i].time)
        for i, own in zip(case.train, model.initial, strict=True)
    ]
    known = sorted(descriptions(case, runs), key=lambda one: -one.share)
    if not known:
        return []
    seen = {id(plan): run for plan in planned if (run := _simulated(case, model, plan)) is not None}
    planned = [plan for plan in planned if id(plan) in seen]
    best, covered = known[:2], Coverage.of(known, runs)

    def between(plan: Plan) -> float:
        return min(a.against(b, seen[id(plan)]) for a, b in (best, best[::-1]))

    is_clear = best[0].share >= FOLLOWED_REPEATED and len(best) == 2
    separating = ranked(case, planned, [one.coordinate for one in best], between) if is_clear else []
    return separating or ranked(case, planned, [], lambda plan: covered.gain(seen[id(plan)]), least=ANYTHING)[:1]


def _simulated(case: Case, model: Fitted, plan: Plan) -> Seen | None:
    """The plan as the model plays it; None where it cannot."""
    try:
        made = plan.played(case, model.system, ports=True)
        return Seen(made.run, made.log.time)
    except NumericalError:
        return None


def descriptions(case: Case, runs: Sequence[Seen]) -> list[Description]:
    """Of what a model leaves of the output that it explains worst, at the port where one of them predicts most.
    `runs`: the training experiments as it simulates them."""
    logs = [case.prepared[i].measured for i in case.train]
    residuals = [(seen.run["outputs"] - y)[:, seen.kept] for seen, y in zip(runs, logs, strict=True)]
    together = np.concatenate(residuals, axis=1)
    worst = max(case.measured, key=lambda c: float(np.nanmean(np.square(together[c]))) / case.noise[c] ** 2)
    at_ports = [
        [_learnt(name, look, runs, [r[worst] for r in residuals]) for name, look in looks]
        for port in range(len(case.system.info.ports))
        if (looks := _looks(case, runs, port))
    ]
    return max(at_ports, key=lambda made: max(one.share for one in made), default=[])


def _looks(case: Case, runs: Sequence[Seen], port: int) -> list[tuple[str, Look]]:
    """What varies at a port that moves, by the name of its coordinate."""
    name = case.system.info.ports[port].name

    def varies(quantity: str) -> bool:
        return bool(np.ptp(np.concatenate([seen.at(port, quantity) for seen in runs])) > 0.0)

    def along(quantity: str) -> Look:
        return lambda seen: (seen.at(port, "velocity"), seen.at(port, quantity))

    def history(seen: Seen) -> tuple[np.ndarray, np.ndarray]:
        velocity = seen.at(port, "velocity")
        return velocity, since_reversal(velocity, seen.at(port, "position"))

    def passed(seen: Seen) -> tuple[np.ndarray, np.ndarray]:
        return seen.at(port, "velocity"), seen.since_start()

    if not varies("velocity"):
        return []
    found = [(f"{name}_{quantity}", along(quantity)) for quantity in QUANTITIES if varies(quantity)]
    return [*found, (f"{name}_history", history), ("time", passed)]


def since_reversal(velocity: np.ndarray, position: np.ndarray) -> np.ndarray:
    """The way gone since the motion last turned, at each sample: all that friction with a memory goes by."""
    slow = SLOW * float(np.sqrt(np.mean(np.square(velocity))))
    moves = np.flatnonzero(np.abs(velocity) > slow)
    turns = moves[1:][np.diff(np.sign(velocity[moves])) != 0.0]
    last = np.zeros(len(position), dtype=int)
    last[turns] = turns
    return np.asarray(np.abs(position - position[np.maximum.accumulate(last)]))


def _learnt(
    coordinate: str,
    look: Look,
    runs: Sequence[Seen],
    residuals: Sequence[np.ndarray],
) -> Description:
    """The map learnt from all runs."""
    velocities, over = zip(*map(look, runs), strict=True)
    cells = Cells.spanning(velocities, over, NUM_TIMES if coordinate == "time" else NUM_KNOTS)
    each = [cells.at(velocity, place) for velocity, place in zip(velocities, over, strict=True)]
    kept = [np.isfinite(r) for r in residuals]
    a, r = (np.concatenate([rows[ok] for rows, ok in zip(part, kept, strict=True)]) for part in (each, residuals))
    precision = a.T @ a + ridge(a.T @ a)
    weights = np.linalg.solve(precision, a.T @ r)
    level = max(float(np.sqrt(np.mean(np.square(r - a @ weights)))), np.finfo(float).tiny)
    left = [(y - rows @ weights)[ok] for rows, y, ok in zip(each, residuals, kept, strict=True) if ok.any()]
    counts = 1.0 / float(np.mean([integrated_time(one) for one in left]))
    share = share_predicted(each, residuals)
    return Description(coordinate, look, cells, share, weights, precision * counts / level**2, level, counts)
