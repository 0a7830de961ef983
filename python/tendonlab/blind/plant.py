"""Independent time-stepping simulation of rigs, many lanes (rig x experiment) at once; the equations of motion are in
`systems`.

Moreau-Jean midpoint stepping: half a drift, a kick, half a drift. The kick is the free motion followed by a dry
friction impulse clipped at step * level, so a slot that can stick does so exactly. A discrete PD controller on the
first measured output closes the loop.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
from numpy.typing import NDArray

from .description import Lanes, Run, Scene
from .friction import Friction
from .sensing import Sensors
from .unknown import Causes

Array = NDArray[np.float64]


def simulate(lanes: Lanes, scene: Scene, *, step: float = 2e-5, stride: int = 1) -> Run:
    """Run all lanes, logging every `stride`-th sample; `step` in s must divide the sample time (ValueError
    otherwise).
    """
    if lanes.system.simulate is not None:
        return lanes.system.simulate(lanes, scene, step, stride)
    rows = list(_Plant(lanes, scene, steps_per_sample(scene, step)).samples(stride))
    if not rows:
        raise ValueError(
            f"reference has {len(scene.reference)} samples: expected more than num_settle = {scene.num_settle}"
        )
    command, outputs, state = (np.stack([row[i] for row in rows]) for i in range(3))
    if not np.all(np.isfinite(state)):
        raise ArithmeticError(f"state is not finite: step {step} s is too long for these parameters")
    time: Array = np.arange(len(rows), dtype=float) * scene.sample_time * stride
    return Run(time=time, command=command, outputs=np.moveaxis(outputs, 1, 0), state=np.moveaxis(state, 1, 0))


def prescribed(rows: Iterable[tuple[Array, Array]], scene: Scene, *, step: float, stride: int) -> Run:
    """The run whose `rows` are readings and state at every logged sample, under prescribed inputs. Raises
    ArithmeticError where a state is not finite.
    """
    outputs, state = (np.stack(part, axis=1) for part in zip(*rows, strict=True))
    if not np.all(np.isfinite(state)):
        raise ArithmeticError(f"state is not finite: step {step} s is too long for these parameters")
    time: Array = np.arange(outputs.shape[1], dtype=float) * scene.sample_time * stride
    return Run(time=time, command=scene.reference[scene.num_settle :: stride], outputs=outputs, state=state)


def steps_per_sample(scene: Scene, step: float) -> int:
    """Number of steps of `step` s in a sample. Raises ValueError where that is no whole number."""
    count = round(scene.sample_time / step)
    if count < 1 or abs(count * step - scene.sample_time) > 1e-9:
        raise ValueError(f"step = {step} s: expected a whole fraction of the sample time {scene.sample_time} s")
    return count


def beyond_deadband(torque: Array, deadband: Array, *, rounded: NDArray[np.bool_]) -> Array:
    """What a deadband leaves of a torque, N*m, with a corner or rounded."""
    smooth = deadband * np.tanh(torque / np.where(deadband > 0, deadband, 1.0))
    return np.asarray(torque - np.where(rounded, smooth, np.clip(torque, -deadband, deadband)))


def _friction(lanes: Lanes) -> Friction:
    slots = lanes.system.slots
    laws = Friction(lanes.parameters, slots=slots, scale=lanes.scale, form=lanes.form)
    for slot, body in enumerate(slots):
        for effect in ("coulomb", "viscous"):
            chosen = np.array([e == f"{body.name}:{effect}" for e in lanes.effect] or np.zeros(lanes.size), dtype=bool)
            laws.choose_other_form(slot, chosen & (lanes.form != 0), effect=effect)
    return laws


class _Plant:
    def __init__(self, lanes: Lanes, scene: Scene, num_steps: int) -> None:
        self.lanes, self.scene, self.num_steps, self.step = lanes, scene, num_steps, scene.sample_time / num_steps
        drives = lanes.system.commands_torque
        self.gain, self.offset = (
            1.0 + drives * lanes.get("actuation_gain_error"),
            drives * lanes.get("actuation_offset"),
        )
        assert lanes.system.mechanics is not None  # `simulate` passes the others on
        self.mechanics = lanes.system.mechanics(lanes, self.step)
        self.kick = self.step / self.mechanics.inertia
        self.friction = _friction(lanes)
        self.bristle = self.friction.bristle()
        self.plain_limit = self.kick * self.friction.coulomb * self.friction.scale
        self.plain_drag = self.friction.viscous * self.friction.scale
        self.sensors = Sensors(lanes, scene, num_steps)
        self.causes = Causes(lanes, step=self.step, sample_time=scene.sample_time)
        self.is_plain = self.friction.is_plain and not self.causes.acts_on_joint
        self.deadband, self.rounded = drives * lanes.get("actuation_deadband"), lanes.form != 0
        self._prepare_actuation(lanes.get("actuation_delay"))
        start = self.mechanics.rest(scene) if scene.initial is None else scene.initial
        bodies = len(start) // 2
        self.q, self.v = start[:bodies].copy(), start[bodies:].copy()

    def _prepare_actuation(self, delay: Array) -> None:
        late = np.floor(delay / self.scene.sample_time + 1e-9).astype(int)
        self.late, self.switch = late, np.maximum(delay - late * self.scene.sample_time, 0.0) / self.step
        self.has_delay = bool(np.any(delay > 0))
        self.commands: Array | None = None

    def samples(self, stride: int) -> Iterator[tuple[Array, Array, Array]]:
        """Yield command, readings (3, n) and state (4, n) at every logged sample; the command is held until the
        next.
        """
        error = np.zeros(self.q.shape[1])
        for k in range(len(self.scene.reference)):
            measured = self.sensors.read(k, self.mechanics.measure(self.q, self.v))
            command, error = self._command(k, measured[0], error)
            if k >= self.scene.num_settle and (k - self.scene.num_settle) % stride == 0:
                yield command, measured, np.concatenate([self.q, self.v])
            self._advance(k, command)

    def _command(self, k: int, measured: Array, before: Array) -> tuple[Array, Array]:
        controller = self.scene.controller
        if controller is None:
            return self.scene.reference[k], before
        error = self.scene.reference[k] - measured
        rate = (error - before) / self.scene.sample_time if k else np.zeros_like(error)
        return np.clip(controller.kp * error + controller.kd * rate, -controller.limit, controller.limit), error

    def _advance(self, k: int, command: Array) -> None:
        known = None if self.scene.known is None else self.scene.known[k]
        if self.scene.others:
            self.mechanics.take({name: values[k] for name, values in self.scene.others.items()})
        if self.commands is None:
            self.commands = np.repeat(command[None, :], int(self.late.max()) + 2, axis=0)
        self.commands = np.concatenate([command[None, :], self.commands[:-1]])
        lanes = np.arange(command.size)
        new, old = self.commands[self.late, lanes], self.commands[self.late + 1, lanes]
        if self.deadband.any():
            new, old = (beyond_deadband(x, self.deadband, rounded=self.rounded) for x in (new, old))
        torque = new * self.gain + self.offset
        if self.lanes.system.commands_torque:
            torque = self.causes.drive(torque)
        before = old * self.gain + self.offset
        self.q += 0.5 * self.step * self.v
        for j in range(self.num_steps):
            drive = before + (torque - before) * np.clip(j + 1.0 - self.switch, 0.0, 1.0) if self.has_delay else torque
            self._kick(drive, known, j)
            self.q += self.step * self.v
        self.q -= 0.5 * self.step * self.v

    def _kick(self, drive: Array, known: Array | None, index: int) -> None:
        old, laws = self.v, self.friction
        push = self.mechanics.push(self.q, old, drive, known)
        force = push.force
        if self.is_plain:
            force -= self.plain_drag * old
            force *= self.kick
            force += old
            limit = self.plain_limit
        else:
            force -= laws.smooth(old)
            if self.causes.has_stop:
                force[-1] += self.causes.torque(self.q[-1])
            level = laws.level(old, load=self.mechanics.load(push), direction=np.sign(old + self.kick * force))
            if self.causes.acts_on_joint:
                level[-1] *= self.causes.level(self.q[-1], old[-1])
            if laws.has_bristle:
                force -= laws.bristle_force(self.bristle, old, level=level, step=self.step)
                level = np.where(laws.bristled, 0.0, level)
            if laws.has_contact:
                level[-1] += laws.contact_level(push.cable)
            force *= self.kick
            force += old
            limit = self.kick * level
        size = np.abs(force)
        size -= limit
        np.maximum(size, 0.0, out=size)
        self.v = np.copysign(size, force, out=size)
        if self.sensors.are_late:
            self.sensors.note(index, *self.mechanics.within(self.q, old, self.v, push))
