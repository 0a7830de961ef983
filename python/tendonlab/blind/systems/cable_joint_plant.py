"""Time-stepping simulation of a joint that two cables turn behind nuts whose velocity is prescribed, many lanes:

    I theta'' = r cos(theta) (F_1 - F_2) - path' (F_1 + F_2) + weight + whirl theta'^2 + load - friction of the joint
    stretch_1 = u - r sin(theta) + stretch at rest + path,   stretch_2 = -(u - r sin(theta) + ...) + path

Backward differences of second order, since cables damp the joint within 0.1 ms; every step is a few Newton steps for
the velocity, each followed by a dry friction impulse clipped at its level. Between samples the nuts go linearly.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tendonlab.blind.description import Array, Lanes, Run, Scene
from tendonlab.blind.friction import Friction
from tendonlab.blind.plant import prescribed, steps_per_sample
from tendonlab.blind.sensing import Sensors
from tendonlab.blind.unknown import stop

from .cable_joint_bushings import Bushings
from .cable_joint_cables import Cables, Pull
from .cable_joint_links import Links

NUM_NEWTON = 2
OVERTONE = 0.35  # of the other form of the ripple


def simulate(lanes: Lanes, scene: Scene, step: float, stride: int) -> Run:
    """Run all lanes; `step` in s must divide the sample time (ValueError otherwise)."""
    rows = _Joint(lanes, scene, steps_per_sample(scene, step)).samples(stride)
    return prescribed(rows, scene, step=step, stride=stride)


class _Joint:
    def __init__(self, lanes: Lanes, scene: Scene, num_steps: int) -> None:
        self.lanes, self.scene, self.num_steps, self.step = lanes, scene, num_steps, scene.sample_time / num_steps
        self.links, self.cables = Links(lanes), Cables(lanes, self.step)
        self.bushings, self.friction = Bushings(lanes, self.step), _friction(lanes)
        self.sensors = Sensors(lanes, scene, num_steps)
        self.radius, self.load = lanes.get("anchor_distance"), lanes.get("load_offset")
        self.ripple = lanes.get("gear_ripple_sine"), lanes.get("gear_ripple_cosine")
        self.has_ripple = bool(np.any(self.ripple))
        self.held = self.cables.balance(-self.links.weight(np.zeros(lanes.size)) / self.radius)
        self.preloaded = lanes.get("pretension") / lanes.get("cable_stiffness")  # m
        self.cables.rest(np.stack([self.held, -self.held]) + self.preloaded)
        self.nut, self.now = np.zeros(lanes.size), np.zeros(lanes.size)  # m, m/s
        self.angle = self.old_angle = np.zeros(lanes.size)
        self.velocity = self.old_velocity = np.zeros(lanes.size)
        self.readings = self._read(self._pull(self.angle, self.velocity, self.now))

    def samples(self, stride: int) -> Iterator[tuple[Array, Array]]:
        """Yield readings (outputs, n) and angle and speed of the joint (2, n) at every logged sample."""
        reference, last = self.scene.reference, len(self.scene.reference) - 1
        for k in range(last + 1):
            measured = self.sensors.read(k, self.readings)
            if k >= self.scene.num_settle and (k - self.scene.num_settle) % stride == 0:
                yield measured, np.stack([self.angle, self.velocity])
            if k < last:
                self._advance(k, reference[k], reference[k + 1])

    def _advance(self, k: int, start: Array, end: Array) -> None:
        slope = (end - start) / self.num_steps
        for j in range(self.num_steps):
            driven = start + j * slope
            self._drive(driven, driven + slope)
            self.cables.age(self._stretch(self.angle, self.cables.path(self.angle)[0]) + self.preloaded, self._at(k))
            self._move()
            self.bushings.follow(self.velocity, self.now)
            before, self.readings = self.readings, self._read(self._pull(self.angle, self.velocity, self.now))
            if self.sensors.are_late:
                self.sensors.note(j, 0.5 * (before + self.readings), self.readings - before)

    def _at(self, k: int) -> float:
        """Time since the start of the log, s."""
        return (k - self.scene.num_settle) * self.scene.sample_time

    def _drive(self, before: Array, after: Array) -> None:
        """Move the nuts over a step whose velocity goes from `before` to `after`, m/s."""
        half = self.nut + 0.5 * self.step * before * self._gain(self.nut)
        self.nut = self.nut + 0.5 * self.step * (before + after) * self._gain(half)
        self.now = after * self._gain(self.nut)

    def _gain(self, nut: Array) -> Array | float:
        """Velocity of the nuts over that which is logged; the gear runs ahead and behind once a turn of the screw."""
        if not self.has_ripple:
            return 1.0
        turned = 2.0 * np.pi * nut / self.lanes.get("screw_pitch")
        sine, cosine = np.sin(turned), np.cos(turned)
        over = np.where(self.lanes.form != 0, OVERTONE, 0.0)
        wave = self.ripple[0] * (sine + 2.0 * over * sine * cosine)
        return np.asarray(1.0 + wave + self.ripple[1] * (cosine + over * (cosine**2 - sine**2)))

    def _stretch(self, angle: Array, path: Array) -> Array:
        pulled = self.nut - self.radius * np.sin(angle) + self.held
        return np.stack([pulled + path, path - pulled])

    def _pull(self, angle: Array, velocity: Array, nut: Array) -> Pull:
        path, slope = self.cables.path(angle)
        pulled = nut - self.radius * np.cos(angle) * velocity
        rate = np.stack([slope * velocity + pulled, slope * velocity - pulled])
        return self.cables.pull(self._stretch(angle, path), rate)

    def _move(self) -> None:
        """One step of backward differences."""
        share = 2.0 * self.step / 3.0
        base = (4.0 * self.angle - self.old_angle) / 3.0
        past = (4.0 * self.velocity - self.old_velocity) / 3.0
        velocity = 2.0 * self.velocity - self.old_velocity
        for _ in range(NUM_NEWTON):
            angle = base + share * velocity
            inertia, pull = self.links.inertia(angle), self._pull(angle, velocity, self.now)
            torque, level, levers = self._torque(angle, velocity, pull)
            yielding = (levers**2 * (pull.damping + share * pull.stiffness)).sum(axis=0)
            slope = inertia + share * yielding
            free = velocity - (inertia * (velocity - past) - share * torque) / slope
            velocity = np.copysign(np.maximum(np.abs(free) - share * level / slope, 0.0), free)
        self.old_angle, self.old_velocity = self.angle, self.velocity
        self.angle, self.velocity = base + share * velocity, velocity

    def _torque(self, angle: Array, velocity: Array, pull: Pull) -> tuple[Array, Array, Array]:
        """Torque on the joint but for dry friction, level of that, N*m, and levers of the cables, m."""
        arm, (_, slope) = self.radius * np.cos(angle), self.cables.path(angle)
        levers = np.stack([arm - slope, -arm - slope])
        pulled, weight = (levers * pull.tension).sum(axis=0), self.links.weight(angle)
        carried = 0.5 * (arm * (pull.tension[0] - pull.tension[1]) - weight - self.load)[None]
        laws, row = self.friction, velocity[None]
        level = laws.level(row, load=carried, direction=np.sign(row))[0]
        torque = pulled + weight + self.load + self.links.whirl(angle) * velocity**2 - laws.smooth(row)[0]
        stiffness = self.lanes.get("stop_stiffness")
        if stiffness.any():
            torque = torque + stop(angle, stiffness=stiffness, at=self.lanes.get("stop_angle"))
        return torque, level, levers

    def _read(self, pull: Pull) -> Array:
        """What perfect sensors read, (4, n)."""
        guided = self.radius * np.cos(self.angle) * self.velocity
        forces = pull.tension + self.bushings.force(self.angle, guided, self.cables.preload)
        return np.stack([self.angle, self.velocity, *forces])


def _friction(lanes: Lanes) -> Friction:
    """Of the joint, the first slot."""
    laws = Friction(lanes.parameters, slots=lanes.system.slots[:1], scale=lanes.scale[:1], form=lanes.form)
    for effect in ("coulomb", "viscous"):
        chosen = np.array([of == f"joint:{effect}" for of in lanes.effect] or np.zeros(lanes.size), dtype=bool)
        laws.choose_other_form(0, chosen & (lanes.form != 0), effect=effect)
    return laws
