"""Angles that wrap: jumps of a whole turn between two samples are taken back, and records set to one turn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from tendonlab.data.said import listed
from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.records import Controller, Experiment, SignalSpec

TURN = 2.0 * np.pi
SMALL = TURN / 8  # the largest step that is no jump, and how far a jump may be from one turn
TOGETHER = TURN / 4  # range of the difference of two angles that move as one

Columns = dict[str, np.ndarray]


def without_wraps(
    experiments: Sequence[Experiment],
    signals: Mapping[str, SignalSpec],
    info: SystemInfo,
    controller: Controller | None,
) -> tuple[tuple[Experiment, ...], list[str]]:
    """The experiments with measured angles that wrap unwrapped, and references and targets as these need it; and a
    warning for each signal that was changed."""
    held = [signal.name for signal in info.inputs if signal.between == "hold"]
    rotary = [s for s in signals.values() if s.si_unit == "rad" and s.role in ("input", "output", "reference")]
    angles = [s.name for s in rotary if s.role != "reference" and s.name not in held]
    read: list[Columns] = [{s.name: e.data[s.name].to_numpy(dtype=float) for s in rotary} for e in experiments]
    columns = [dict(record) for record in read]
    wrapping = [name for name in angles if any(jumps(record[name]) for record in read)]
    _set_angles(columns, angles, wrapping)
    outputs = [s.name for s in rotary if s.role == "output"]
    for given in [s.name for s in rotary if s.name not in angles] if outputs else []:
        is_reference = controller is not None and given == controller.reference
        output = controller.measured if controller is not None and is_reference else outputs[0]
        for column in columns:
            column[given] = _as_asked(column[given], column[output], may_turn=output in wrapping)
    found: list[Experiment] = []
    told: dict[str, list[str]] = {}
    for experiment, column, record in zip(experiments, columns, read, strict=True):
        changed = {n: v for n, v in column.items() if not np.array_equal(v, record[n], equal_nan=True)}
        for name in changed:
            told.setdefault(name, []).append(experiment.name)
        found.append(_with(experiment, changed) if changed else experiment)
    return tuple(found), [
        f"{name} wraps, with jumps of a whole turn: it was unwrapped, or set to the turn of the other records, in "
        f"{listed(names)}"
        for name, names in told.items()
    ]


def jumps(values: np.ndarray) -> bool:
    """Whether neighbours differ by nearly one turn somewhere, and by far less than half a turn everywhere else."""
    steps = np.abs(np.diff(values[np.isfinite(values)]))
    far = steps > TURN / 2
    return bool(far.any() and (np.abs(steps - TURN * far) < SMALL).all())


def _set_angles(columns: Sequence[Columns], angles: Sequence[str], wrapping: Sequence[str]) -> None:
    """Unwrap the angles that are `wrapping` somewhere. All records of one then lie at the whole turn next to that of
    the first record, which is the turn next to 0 where it jumps itself, but for those that do not jump themselves and
    would lie apart from that record there as well; angles that move as one lie at one turn."""
    leader = next((name for name in angles if name not in wrapping), next(iter(wrapping), ""))
    for name in sorted(wrapping, key=lambda name: name != leader):
        first = next(column[name] for column in columns if np.isfinite(column[name]).any())
        anchor = _middle(unwrapped(first))
        anchor -= TURN * np.round(anchor / TURN) if jumps(first) else 0.0
        there = _turned(unwrapped(first), _middle(unwrapped(first)) - anchor)
        for column in columns:
            values = unwrapped(column[name])
            beside = values - column[leader]
            moves_along = (
                name != leader and np.isfinite(beside).any() and np.nanmax(beside) - np.nanmin(beside) < TOGETHER
            )
            off = _middle(beside) if moves_along else _middle(values) - anchor
            turned = _turned(values, off)
            if moves_along or jumps(column[name]) or _overlap(turned, there):
                column[name] = turned


def _as_asked(asked: np.ndarray, output: np.ndarray, *, may_turn: bool) -> np.ndarray:
    """What was `asked` of an output: unwrapped only where that brings it nearer to the output, as it may ask for a
    whole turn at once; at the output's own turn where that output wraps."""
    tried = [asked, unwrapped(asked)] if jumps(asked) else [asked]
    if may_turn:
        tried = [_turned(values, _middle(values - output)) for values in tried]
    both = np.isfinite(output)
    return min(tried, key=lambda values: float(np.sum(np.square(values - output)[both])))


def unwrapped(values: np.ndarray) -> np.ndarray:
    """The values, which may miss samples, without jumps of a whole turn, from the first one on."""
    there, out = np.isfinite(values), values.copy()
    if jumps(values):
        turns = np.cumsum(np.round(np.diff(values[there]) / TURN))
        out[there] -= TURN * np.concatenate([[0.0], turns])
    return out


def _overlap(values: np.ndarray, others: np.ndarray) -> bool:
    """Whether two records share angles."""
    if not (np.isfinite(values).any() and np.isfinite(others).any()):
        return True
    return bool(np.nanmin(values) <= np.nanmax(others) and np.nanmin(others) <= np.nanmax(values))


def _middle(values: np.ndarray) -> float:
    return float(np.nanmedian(values)) if np.isfinite(values).any() else 0.0


def _turned(values: np.ndarray, off: float) -> np.ndarray:
    """The values less the whole turns that are next to `off`."""
    return values - TURN * float(np.round(off / TURN))


def _with(experiment: Experiment, changed: Columns) -> Experiment:
    """The experiment with columns `changed`. A stated initial angle is moved by the whole turns to the first sample."""
    initial = dict(experiment.initial)
    for name in changed.keys() & initial.keys():
        first = changed[name][np.isfinite(changed[name])][0]
        initial[name] += TURN * float(np.round((first - initial[name]) / TURN))
    return replace(experiment, data=experiment.data.assign(**changed), initial=initial)
