"""Time-stepping simulation of joint 1 on its cables, many lanes at once:

    J theta1'' = lever (T21 - T11) - friction of the joint,    theta2: prescribed, a cubic spline through the samples

Midpoint stepping: half a drift, a kick, half a drift; dry friction of the joint is an impulse clipped at step * level.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from tendonlab.blind.description import Array, Lanes, Run, Scene
from tendonlab.blind.friction import Friction
from tendonlab.blind.plant import prescribed, steps_per_sample
from tendonlab.blind.sensing import Sensors

from .ccsrm_cables import Cables, ElasticEnds

SECTIONS = ("tension_11", "tension_12", "tension_13", "tension_21", "tension_22", "tension_23")


def simulate(lanes: Lanes, scene: Scene, step: float, stride: int) -> Run:
    """Run all lanes; `step` in s must divide the sample time (ValueError otherwise)."""
    rows = _Joint(lanes, scene, steps_per_sample(scene, step)).samples(stride)
    return prescribed(rows, scene, step=step, stride=stride)


class _Joint:
    def __init__(self, lanes: Lanes, scene: Scene, num_steps: int) -> None:
        self.scene, self.num_steps, self.step = scene, num_steps, scene.sample_time / num_steps
        at = np.arange(len(scene.reference)) * scene.sample_time
        self.pieces: Array = CubicSpline(at, scene.reference).c  # (4, num_samples - 1, n), the highest power first
        self.sections = [SECTIONS.index(name) for name in lanes.system.output_names[1:]]
        self.kick, self.friction = self.step / lanes.get("joint_inertia"), _friction(lanes)
        self.bristle = self.friction.bristle()
        self.groups = _groups(lanes, self.step)
        self.sensors = Sensors(lanes, scene, num_steps)
        start = np.stack([scene.reference[0], np.zeros(lanes.size)]) if scene.initial is None else scene.initial
        self.q, self.v = start[0].copy(), start[1].copy()
        tension = np.tile(lanes.get("pretension"), (len(SECTIONS), 1))
        self.tension, self.change = tension, np.zeros_like(tension)  # in the middle of the last step, over that step

    def samples(self, stride: int) -> Iterator[tuple[Array, Array]]:
        """Yield readings (outputs, n) and angle and speed of joint 1 (2, n) at every logged sample."""
        last = len(self.scene.reference) - 1
        for k in range(last + 1):
            measured = self._measure(k)
            if k >= self.scene.num_settle and (k - self.scene.num_settle) % stride == 0:
                yield measured, np.stack([self.q, self.v])
            if k < last:
                self._advance(k)

    def _measure(self, k: int) -> Array:
        tension = self.tension + 0.5 * self.change
        return self.sensors.read(k, [self.q, *tension[self.sections]])

    def _advance(self, k: int) -> None:
        a, b, c, d = self.pieces[:, k]
        self.q = self.q + 0.5 * self.step * self.v
        for j in range(self.num_steps):
            s = (j + 0.5) * self.step
            self._kick(((a * s + b) * s + c) * s + d, (3.0 * a * s + 2.0 * b) * s + c, j)
            self.q = self.q + self.step * self.v
        self.q = self.q - 0.5 * self.step * self.v

    def _kick(self, driver: Array, rate: Array, index: int) -> None:
        old, laws = self.v, self.friction
        tension, torque = self._pull(np.stack([self.q, driver]), np.stack([old, rate]))
        self.change, self.tension = tension - self.tension, tension
        force = (torque[0] - laws.smooth(old[None])[0]) * self.kick
        direction = np.sign(old + force)
        level = laws.level(old[None], load=torque[1:], direction=direction[None])
        if laws.has_bristle:
            force = force - self.kick * laws.bristle_force(self.bristle, old[None], level=level, step=self.step)[0]
            level = np.where(laws.bristled, 0.0, level)
        free = old + force
        self.v = np.copysign(np.maximum(np.abs(free) - self.kick * level[0], 0.0), free)
        if self.sensors.are_late:
            changes = [0.5 * self.step * (old + self.v), *self.change[self.sections]]
            self.sensors.note(index, [self.q, *tension[self.sections]], changes)

    def _pull(self, angle: Array, rate: Array) -> tuple[Array, Array]:
        """Tensions (6, n); torque of the cables on joint 1, and of their middle sections alone, N*m, (2, n)."""
        tension, lever = np.empty_like(self.tension), np.empty_like(self.q)
        for rows, cables in self.groups:
            tension[:, rows] = cables.tensions(angle[:, rows], rate[:, rows])
            lever[rows] = cables.lever(angle[:, rows])
        return tension, lever * (tension[3:5] - tension[:2])


def _groups(lanes: Lanes, step: float) -> list[tuple[NDArray[np.int64] | slice, Cables]]:
    """The lanes whose ends do not stretch, and those whose ends do."""
    soft = lanes.get("ends_compliance") > 0
    if not soft.any():
        return [(slice(None), Cables(lanes, step))]
    kinds = [(np.flatnonzero(~soft), Cables), (np.flatnonzero(soft), ElasticEnds)]
    return [(rows, kind(_part(lanes, rows), step)) for rows, kind in kinds if rows.size]


def _part(lanes: Lanes, rows: NDArray[np.int64]) -> Lanes:
    parameters: Mapping[str, Array] = {name: value[rows] for name, value in lanes.parameters.items()}
    named = tuple(lanes.effect[i] for i in rows) if lanes.effect else ()
    return replace(lanes, parameters=parameters, scale=lanes.scale[:, rows], form=lanes.form[rows], effect=named)


def _friction(lanes: Lanes) -> Friction:
    """Of joint 1, the last slot."""
    laws = Friction(lanes.parameters, slots=lanes.system.slots[-1:], scale=lanes.scale[-1:], form=lanes.form)
    for effect in ("coulomb", "viscous"):
        chosen = np.array([name == f"joint:{effect}" for name in lanes.effect] or np.zeros(lanes.size), dtype=bool)
        laws.choose_other_form(0, chosen & (lanes.form != 0), effect=effect)
    return laws
