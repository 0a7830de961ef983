"""How large an effect is: its own parameters, and the gap that it leaves after tuning, over the noise floor."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from tendonlab.diagnosis.search.screen import can_be_added, can_be_seen
from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.priors import free_parameters, start_of
from tendonlab.rehearsal.rig import TOLERANCE, SimulatedRig
from tendonlab.simulation.catalog import WHOLE, ParameterInfo
from tendonlab.simulation.system import System

LARGEST, STEP, STEPS = 3.0, 10.0**-0.5, 14  # typical sizes on this rig; each is a step below the one before
PROBES = 4  # experiments in which sizes are measured
FLOOR_SEED = 20  # of the noise whose size is the floor


@dataclass(frozen=True)
class Ladder:
    """An effect at growing sizes. `parameter`: the one that grows (or falls, as a stiffness), in `unit`; `amounts`: its
    values; `gaps`: the gap over noise at each, growing; `others`: its other parameters."""

    effect: str
    parameter: str
    unit: str
    amounts: tuple[float, ...]
    gaps: tuple[float, ...]
    others: dict[str, float]

    @property
    def falls(self) -> bool:
        """Whether the parameter falls as the effect grows, as the stiffness of a bristle."""
        return bool(self.amounts) and self.amounts[-1] < self.amounts[0]

    @property
    def largest_gap(self) -> float:
        """The gap over noise at the largest size that the rig could have; 0 where no size could be simulated."""
        return self.gaps[-1] if self.gaps else 0.0

    def amount(self, gap: float) -> float:
        """The parameter at which the effect leaves `gap`; the end of the ladder beyond it."""
        return float(np.exp(np.interp(np.log(gap), np.log(self.gaps), np.log(self.amounts))))

    def values(self, gap: float) -> dict[str, float]:
        """All parameters of the effect at the size that leaves `gap`."""
        return {**self.others, self.parameter: self.amount(gap)}


def withheld_effects(system: System, measured: Sequence[str]) -> list[str]:
    """The effects that a diagnosis of these outputs would consider: those that the simulator lacks, apart from laws
    that are the whole friction of an element."""
    known = [e for e in system.info.effects if not e.roles & WHOLE]
    return [e.name for e in known if can_be_seen(e, measured) and can_be_added(e, system)]


class Gauge:
    """Measures the gap over noise of an effect on rigs with the nominal parameters."""

    def __init__(self, rigs: SimulatedRig) -> None:
        chosen = [i for i, e in enumerate(rigs.runs) if e.split == "train"]
        picked = chosen[:: max(1, len(chosen) // PROBES)][:PROBES]
        runs = tuple(rigs.runs[i] for i in picked)
        self.rigs = replace(rigs, rig=replace(rigs.rig, experiments=runs), runs=runs)
        clean = self.rigs.clean({})
        self.case = make_case(clean, tolerance=TOLERANCE)
        noisy = self.rigs.noisy(np.random.default_rng(FLOOR_SEED), self.rigs.system)
        self.floor = _floor(self.case, make_case(noisy, tolerance=TOLERANCE))
        self.tangent, self.prior = self._tuning()
        self.base = self._errors(self.case)

    def gap(self, effect: str, values: dict[str, float]) -> float:
        """Rms error over noise that `effect` leaves once the parameters are tuned, to first order."""
        case = make_case(self.rigs.clean({effect: values}), tolerance=TOLERANCE)
        error = self._errors(case) - self.base  # what the start of a record costs without any effect does not count
        moved = self.tangent.T @ error
        left = error - self.tangent @ np.linalg.solve(self.tangent.T @ self.tangent + self.prior, moved)
        return float(np.sqrt(np.mean(np.square(left))))

    def ladder(self, effect: str, smallest: float) -> Ladder:
        """The effect from a gap below `smallest` to the largest size."""
        parameter = size_parameter(self.case.system, effect)
        known = set(self.case.system.info.effect(effect).parameters)
        start = {n: v for n, v in start_of(self.case.system, effect, self.case.scales).items() if n in known}
        found = list(self._descent(effect, parameter, start, smallest))[::-1]
        gaps = np.maximum.accumulate([gap for gap, _ in found]) if found else np.zeros(0)
        rising = gaps * (1 + 1e-9 * np.arange(len(gaps)))
        unit = self.case.system.unit(parameter.name)
        others = {name: value for name, value in start.items() if name != parameter.name}
        return Ladder(effect, parameter.name, unit, tuple(a for _, a in found), tuple(rising.tolist()), others)

    def _descent(
        self, effect: str, parameter: ParameterInfo, start: dict[str, float], smallest: float
    ) -> Iterator[tuple[float, float]]:
        """(gap, amount) from the largest size down, until the gap is below `smallest`."""
        for step in range(STEPS):
            amount = self._amount(parameter, start, LARGEST * STEP**step)
            try:
                gap = self.gap(effect, {**start, parameter.name: amount})
            except (NumericalError, ParameterError, DatasetError):
                continue
            if gap > 0:
                yield gap, amount
            if gap < 0.7 * smallest:
                return

    def _amount(self, parameter: ParameterInfo, start: dict[str, float], size: float) -> float:
        if parameter.purpose == "shape":  # a softer bristle is a larger effect
            return max(parameter.lower, start[parameter.name] / size)
        scales = self.case.scales
        scale = scales.get(parameter.element or "") or next(iter(scales.values()))
        return min(parameter.upper, size * scale.of(parameter.dimension) * abs(parameter.typical))

    def _errors(self, case: Case) -> np.ndarray:
        """What the nominal simulator misses of logs, over the floor."""
        return self._rows([case.run(i, case.system)["outputs"] - r.measured for i, r in enumerate(case.prepared)])

    def _tuning(self) -> tuple[np.ndarray, np.ndarray]:
        """What the free parameters and the initial states can do, (rows, columns), and the inverse variance of their
        priors."""
        case = self.case
        free = free_parameters(case.system, self.rigs.rig.parameters, case.scales)
        slopes = [f.slope(f.coordinate(f.start)) for f in free]
        shared: list[np.ndarray] = []
        columns: list[np.ndarray] = []
        spreads = [float(f.sd) for f in free]
        for i, ready in enumerate(case.prepared):
            seeds = [*(("parameter", f.index) for f in free), *ready.initial]
            gradient = case.run(i, case.system, seeds=seeds)["gradient"]
            shared.append(gradient[: len(free)])
            for own in gradient[len(free) :]:
                rest = [own if k == i else np.zeros_like(r.measured) for k, r in enumerate(case.prepared)]
                columns.append(self._rows(rest))
            spreads += list(ready.initial_sd)
        tuned = [self._rows([one[k] for one in shared]) * slope for k, slope in enumerate(slopes)]
        return np.column_stack([*tuned, *columns]), np.diag(np.array(spreads) ** -2.0)

    def _rows(self, outputs: Sequence[np.ndarray]) -> np.ndarray:
        """Measured outputs over the floor in one row, 0 where a sample is missing."""
        kept = self.case.measured
        return np.concatenate([np.nan_to_num(one[kept] / self.floor[:, None]).ravel() for one in outputs])


def size_parameter(system: System, effect: str) -> ParameterInfo:
    """The parameter that says how large an effect is: its first amplitude, else its first shape."""
    rows = [system.info.parameter(name) for name in system.info.effect(effect).parameters]
    amplitudes = [row for row in rows if row.purpose == "amplitude"]
    return (amplitudes or [row for row in rows if row.purpose == "shape"])[0]


def _floor(clean: Case, noisy: Case) -> np.ndarray:
    """Rms of what noise and scatter add to each measured output."""
    pairs = list(zip(clean.prepared, noisy.prepared, strict=True))
    added = [np.concatenate([(b.measured - a.measured)[c] for a, b in pairs]) for c in clean.measured]
    return np.array([float(np.sqrt(np.nanmean(np.square(row)))) for row in added])
