"""What is free in a fit and what is believed of it beforehand: the user's `sd`, else the library's defaults, scaled to
the rig by what it was seen to do (0.3 in log, 0.6 for friction and damping; effects 3 of their unit, shapes 0.7 in log,
fractions 0.3)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab import _core
from tendonlab._core import Free
from tendonlab.data import NominalParameter
from tendonlab.errors import ParameterError
from tendonlab.simulation.catalog import DIMENSIONS, PORT_QUANTITIES, ParameterInfo, SystemInfo
from tendonlab.simulation.prepare import Prepared
from tendonlab.simulation.system import System

OF_TORQUE = ("inertia", "effort", "damping", "stiffness")  # dimensions that scale with all torques
LOG_SD, FRICTION_LOG_SD, SHAPE_LOG_SD, AMPLITUDE_SD = 0.3, 0.6, 0.7, 3.0
FRACTION_SD = 0.3  # of a shape that lies between 0 and 1


@dataclass(frozen=True)
class Scale:
    """What an element was seen to do: rms effort and speed, travel (sd of position), in SI."""

    effort: float
    flow: float
    displacement: float

    def of(self, dimension: str) -> float:
        """The unit in which a typical value of this dimension counts, SI."""
        scale, per = DIMENSIONS[dimension].scale, DIMENSIONS[dimension].per
        return self._one(scale) / self._one(per)

    def _one(self, scale: str | None) -> float:
        return 1.0 if scale is None else float(getattr(self, scale))


def scales(system: System, experiments: Sequence[Prepared]) -> dict[str, Scale]:
    """Scale of every element, from replays of the nominal simulator; a sensor's is its own signal's sd."""
    info = system.info
    settings = [
        _core.Settings(
            tolerance=1e-4, position_scale=e.position_scale, velocity_scale=e.velocity_scale, ports=PORT_QUANTITIES
        )
        for e in experiments
    ]
    runs = [
        _core.simulate(system.kind, system.values(), system.active(), e.core, [], s)
        for e, s in zip(experiments, settings, strict=True)
    ]
    ports = np.concatenate([r["ports"] for r in runs], axis=2)
    found: dict[str, Scale] = {}
    for i, port in enumerate(info.ports):
        velocity, position, load, force = ports[i]
        effort = max(_rms(load), _rms(force)) if port.load == "effort" else _rms(force)
        seen = (effort, _rms(velocity), float(np.std(position)))
        known = found.get(port.element, Scale(0.0, 0.0, 0.0))
        most = (max(a, b) for a, b in zip(seen, (known.effort, known.flow, known.displacement), strict=True))
        found[port.element] = Scale(*most)
    found = {name: Scale(*map(_positive, (s.effort, s.flow, s.displacement))) for name, s in found.items()}
    first = found[info.ports[0].element]
    for c, output in enumerate(info.outputs):
        measured = np.concatenate([e.measured[c] for e in experiments])
        spread = float(np.nanstd(measured)) if np.isfinite(measured).any() else 1.0
        found[f"sensor.{output.name}"] = Scale(first.effort, first.flow, _positive(spread))
    return {element.name: found.get(element.name, found[element.acts_on]) for element in info.elements}


def free_parameters(
    system: System, nominal: Mapping[str, NominalParameter], of: Mapping[str, Scale], *, added: Sequence[str] = ()
) -> list[Free]:
    """The free parameters of `system`: its nominal ones with sd != 0, then those of the effects in `added`."""
    info = system.info
    rows: list[Free] = []
    new = {name for effect in added for name in info.effect(effect).parameters}
    for index, p in enumerate(info.parameters):
        if p.name not in system.parameters or p.purpose == "share":
            continue
        unit = (of.get(p.element or "") or next(iter(of.values()))).of(p.dimension)
        scale = unit * abs(p.typical)
        if p.name in new and p.purpose == "condition":
            continue
        if p.name in new:
            rows.append(_effect_parameter(index, p, scale or unit, system.parameters[p.name]))
            continue
        stated = nominal.get(p.name)
        if stated is None or stated.sd == 0 or (stated.sd is None and known_by_default(p, stated.value)):
            continue
        rows.append(_nominal_parameter(info, index, p, stated, scale))
    if not rows:
        raise ParameterError("no parameter is free: expected at least one with sd > 0 or without sd")
    return rows


def with_scale_held(system: System, rows: Sequence[Free]) -> list[Free]:
    """The free parameters `rows` of a rig that no known torque moves: logs tell ratios of torques, inertias, stiffness
    and damping there. So the one of these that is known best is taken at its word, unless one of them is known."""
    free = {row.name for row in rows}
    of_torque = [
        p.name for p in system.info.parameters if p.dimension in OF_TORQUE and system.parameters.get(p.name, 0.0) != 0.0
    ]
    if not free.issuperset(of_torque):
        return list(rows)
    best = min((row for row in rows if row.log and row.name in of_torque), key=lambda row: row.sd, default=None)
    return [row for row in rows if row is not best]


def start_of(system: System, effect: str, of: Mapping[str, Scale]) -> dict[str, float]:
    """Starting values of an added effect: amplitudes 0, shapes typical of the rig."""
    values = {}
    for name in system.info.effect(effect).parameters:
        p = system.info.parameter(name)
        scale = (of.get(p.element or "") or next(iter(of.values()))).of(p.dimension)
        values[name] = p.typical if p.purpose == "share" else 0.0 if p.purpose == "amplitude" else scale * p.typical
    return values


def known_by_default(p: ParameterInfo, value: float) -> bool:
    """A torque constant or gear ratio without `sd` is taken at its word: only the torques' ratio to it can be seen. So
    is 0 for what is usually not there."""
    usual = p.dimension in ("effort_per_command", "ratio") and p.purpose == "structure"
    return usual or (value == 0.0 and p.typical == 0.0)


def is_fraction(p: ParameterInfo) -> bool:
    """Whether a parameter is a shape between 0 and 1, both included: no logarithm suits it."""
    return p.purpose == "shape" and (p.lower, p.upper) == (0.0, 1.0)


def default_log_sd(info: SystemInfo, p: ParameterInfo) -> float:
    """Prior sd of the logarithm of a parameter that is stated without an `sd`. Friction varies most, and where it was
    tuned without an effect it stands in for that."""
    return FRICTION_LOG_SD if info.is_friction(p) else LOG_SD


def _nominal_parameter(info: SystemInfo, index: int, p: ParameterInfo, stated: NominalParameter, scale: float) -> Free:
    lower, upper = max(p.lower, stated.lower), min(p.upper, stated.upper)

    def free(scale: float, mean: float, sd: float, *, log: bool = False) -> Free:
        return Free(
            name=p.name,
            index=index,
            log=log,
            scale=scale,
            start=stated.value,
            mean=mean,
            sd=sd,
            lower=lower,
            upper=upper,
        )

    if is_fraction(p) and stated.sd is None:
        return free(FRACTION_SD, stated.value / FRACTION_SD, 1.0)
    if p.lower >= 0 and stated.value > 0 and not is_fraction(p):
        sd = default_log_sd(info, p) if stated.sd is None else stated.sd / stated.value
        return free(stated.value, 0.0, sd, log=True)
    usual = max(AMPLITUDE_SD * scale, LOG_SD * abs(stated.value))
    if stated.sd is None or math.isinf(stated.sd):  # inf: nothing is believed, and the scale only measures
        return free(usual, stated.value / usual, 1.0 if stated.sd is None else math.inf)
    return free(stated.sd, stated.value / stated.sd, 1.0)


def _effect_parameter(index: int, p: ParameterInfo, scale: float, value: float) -> Free:
    """By its logarithm, if it is a shape that is typically positive and no fraction."""
    if is_fraction(p):
        mean = p.typical / FRACTION_SD
        return Free(
            name=p.name, index=index, log=False, scale=FRACTION_SD, start=value, mean=mean, sd=1.0,
            lower=p.lower, upper=p.upper,
        )  # fmt: skip
    logarithm = p.purpose == "shape" and p.typical > 0
    return Free(
        name=p.name, index=index, log=logarithm, scale=scale, start=value, mean=0.0,
        sd=SHAPE_LOG_SD if logarithm else AMPLITUDE_SD, lower=p.lower, upper=p.upper,
    )  # fmt: skip


def _rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(x))))


def _positive(x: float) -> float:
    return x if x > 0 and math.isfinite(x) else 1.0
