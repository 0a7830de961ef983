"""Independent time-stepping simulation of the two-inertia cable rig, many lanes (rig x experiment) at once.

    J_m qm'' = tau - friction_m - f/N              tau = u(t - delay) (1 + gain_error) + offset
    J_l ql'' = f - friction_l - friction_contact - g sin ql + known          (load_offset is a constant part of `known`)
    f = k deadzone(qm/N - ql, backlash/2) + c d/dt(qm/N - ql), c only while a flank touches

Moreau-Jean midpoint stepping: half a drift, a kick, half a drift. The kick is the free motion followed by a dry
friction impulse clipped at step * level, so a slot that can stick does so exactly. A discrete PD controller on the
measured motor angle closes the loop.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from .friction import Friction

Array = NDArray[np.float64]
OUTPUTS = ("motor_angle", "joint_angle", "cable_torque")


@dataclass(frozen=True, kw_only=True)
class Controller:
    """u_k = kp e_k + kd (e_k - e_(k-1))/T, e = reference - measured motor angle, clipped to +-limit; arrays (n,),
    SI.
    """

    kp: Array
    kd: Array
    limit: Array


@dataclass(frozen=True, kw_only=True)
class Scene:
    """Inputs of n lanes. `reference`: motor angle, rad, (num_samples, n), or the command itself, N*m, where there is
    no controller.

    `num_settle` first samples are not logged. `noise`: added to the readings, (3, num_samples, n); `resolution`: (3,
    n), 0 for none. `initial`: (4, n) motor and joint position, then velocity; absent: the static equilibrium.
    `known`: joint torque, N*m, (num_samples, n).
    """

    reference: Array
    controller: Controller | None = None
    sample_time: float = 0.002
    num_settle: int = 0
    noise: Array | None = None
    resolution: Array | None = None
    known: Array | None = None
    initial: Array | None = None


@dataclass(frozen=True, kw_only=True)
class Run:
    """Logged samples: `time` s (m,), `command` N*m (m, n), `outputs` (3, m, n) in the order of OUTPUTS, `state` (4,
    m, n).
    """

    time: Array
    command: Array
    outputs: Array
    state: Array


@dataclass(frozen=True, kw_only=True)
class Lanes:
    """n rigs: parameters by contract name, (n,) each (absent means 0), run-to-run friction factors (2, n),
    functional form (n,).

    `form` 0 is the documented one. `effect` names each lane's effect ("joint:coulomb"), for effects whose other form
    is of a nominal law.
    """

    parameters: Mapping[str, Array]
    scale: Array
    form: NDArray[np.int64]
    effect: tuple[str, ...] = field(default=())

    @property
    def size(self) -> int:
        return int(self.form.size)

    def get(self, name: str) -> Array:
        value: Array = self.parameters.get(name, np.zeros(self.size))
        return value

    def friction(self) -> Friction:
        laws = Friction(self.parameters, scale=self.scale, form=self.form)
        for slot, name in enumerate(("motor", "joint")):
            for effect in ("coulomb", "viscous"):
                chosen = np.array([e == f"{name}:{effect}" for e in self.effect] or np.zeros(self.size), dtype=bool)
                laws.choose_other_form(slot, chosen & (self.form != 0), effect=effect)
        return laws


def simulate(lanes: Lanes, scene: Scene, *, step: float = 2e-5, stride: int = 1) -> Run:
    """Run all lanes, logging every `stride`-th sample; `step` in s must divide the sample time (ValueError
    otherwise).
    """
    num_steps = round(scene.sample_time / step)
    if num_steps < 1 or abs(num_steps * step - scene.sample_time) > 1e-9:
        raise ValueError(f"step = {step} s: expected a whole fraction of the sample time {scene.sample_time} s")
    rows = list(_Plant(lanes, scene, num_steps).samples(stride))
    if not rows:
        raise ValueError(
            f"reference has {len(scene.reference)} samples: expected more than num_settle = {scene.num_settle}"
        )
    command, outputs, state = (np.stack([row[i] for row in rows]) for i in range(3))
    if not np.all(np.isfinite(state)):
        raise ArithmeticError(f"state is not finite: step {step} s is too long for these parameters")
    time: Array = np.arange(len(rows), dtype=float) * scene.sample_time * stride
    return Run(time=time, command=command, outputs=np.moveaxis(outputs, 1, 0), state=np.moveaxis(state, 1, 0))


def static_state(lanes: Lanes, scene: Scene) -> Array:
    """Static equilibrium under the controller's first reference, frictionless; zeros without a controller. (4, n),
    rad and rad/s.
    """
    state = np.zeros((4, lanes.size))
    if scene.controller is None:
        return state
    ratio, stiffness, gravity = lanes.get("gear_ratio"), lanes.get("cable_stiffness"), lanes.get("gravity_torque")
    torque = np.zeros(lanes.size)
    for _ in range(30):  # contracts by about g/(kp N^2) + g/k, some 5 % a turn
        wanted = (torque / ratio - lanes.get("actuation_offset")) / (1.0 + lanes.get("actuation_gain_error"))
        state[0] = scene.reference[0] - lanes.get("sensor.motor_angle_bias") - wanted / scene.controller.kp
        state[1] = state[0] / ratio - torque / stiffness - np.sign(torque) * lanes.get("cable_backlash") / 2.0
        torque = 0.7 * (gravity * np.sin(state[1]) - lanes.get("load_offset")) + 0.3 * torque
    return state


class _Reading:
    """One delayed and biased sensor: captures the value at (sample - delay), first within a sample, then whole
    samples later.
    """

    def __init__(self, delay: Array, *, sample_time: float, num_steps: int) -> None:
        late = np.floor(delay / sample_time + 1e-9).astype(int)
        rest = np.maximum(delay - late * sample_time, 0.0)
        self.late, self.lanes = late, np.arange(delay.size)
        at = num_steps - rest * num_steps / sample_time  # in steps since the last sample
        within = rest > 1e-9
        self.capture = {int(j): np.flatnonzero(within & (np.floor(at) == j)) for j in np.unique(np.floor(at[within]))}
        self.offset = at - np.floor(at) - 0.5  # from the middle of that step, in steps
        self.held: dict[int, Array] = {}
        self.past: Array | None = None

    def note(self, index: int, value: Array, rate: Array) -> None:
        lanes = self.capture.get(index)
        if lanes is not None:
            self.held[index] = value[lanes] + self.offset[lanes] * rate[lanes]

    def read(self, value: Array) -> Array:
        fresh = value.copy()
        for index, held in self.held.items():
            fresh[self.capture[index]] = held
        if self.past is None:
            self.past = np.repeat(value[None, :], int(self.late.max()) + 1, axis=0)
        self.past = np.concatenate([fresh[None, :], self.past[:-1]])
        return np.asarray(self.past[self.late, self.lanes])


class _Plant:
    def __init__(self, lanes: Lanes, scene: Scene, num_steps: int) -> None:
        self.scene, self.num_steps, self.step = scene, num_steps, scene.sample_time / num_steps
        self.per_ratio = 1.0 / lanes.get("gear_ratio")
        self.stiffness, self.damping = lanes.get("cable_stiffness"), lanes.get("cable_damping")
        self.gravity, self.half_gap = lanes.get("gravity_torque"), lanes.get("cable_backlash") / 2.0
        self.pull = lanes.get("load_offset")
        self.gain, self.offset = 1.0 + lanes.get("actuation_gain_error"), lanes.get("actuation_offset")
        self.kick = self.step / np.stack([lanes.get("motor_inertia"), lanes.get("joint_inertia")])
        self.friction = lanes.friction()
        self.rounded = lanes.form != 0
        self.bristle = self.friction.bristle()
        self.plain_limit = self.kick * self.friction.coulomb * self.friction.scale
        self.plain_drag = self.friction.viscous * self.friction.scale
        self.bias = np.stack([lanes.get(f"sensor.{name}_bias") for name in OUTPUTS])
        delays = [lanes.get(f"sensor.{name}_delay") for name in OUTPUTS]
        self.readings = [_Reading(d, sample_time=scene.sample_time, num_steps=num_steps) for d in delays]
        self.has_sensor_delay = any(reading.capture for reading in self.readings)
        self._prepare_actuation(lanes.get("actuation_delay"))
        start = static_state(lanes, scene) if scene.initial is None else scene.initial
        self.q, self.v = start[:2].copy(), start[2:].copy()

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
            measured = self._measure(k)
            command, error = self._command(k, measured[0], error)
            if k >= self.scene.num_settle and (k - self.scene.num_settle) % stride == 0:
                yield command, measured, np.concatenate([self.q, self.v])
            self._advance(k, command)

    def _measure(self, k: int) -> Array:
        torque = self._cable(self.q, self.v)[0]
        values = [self.q[0], self.q[1], torque]
        measured = np.stack([r.read(y) for r, y in zip(self.readings, values, strict=True)]) + self.bias
        if self.scene.noise is not None:
            measured += self.scene.noise[:, k]
        if self.scene.resolution is not None:
            grid = np.where(self.scene.resolution > 0, self.scene.resolution, 1.0)
            measured = np.where(self.scene.resolution > 0, np.round(measured / grid) * grid, measured)
        return measured

    def _command(self, k: int, measured: Array, before: Array) -> tuple[Array, Array]:
        controller = self.scene.controller
        if controller is None:
            return self.scene.reference[k], before
        error = self.scene.reference[k] - measured
        rate = (error - before) / self.scene.sample_time if k else np.zeros_like(error)
        return np.clip(controller.kp * error + controller.kd * rate, -controller.limit, controller.limit), error

    def _cable(self, q: Array, v: Array) -> tuple[Array, Array]:
        """Cable torque at the joint, N*m, and the rate of its stretch, rad/s."""
        stretch, rate = q[0] * self.per_ratio - q[1], v[0] * self.per_ratio - v[1]
        if not self.half_gap.any():
            return self.stiffness * stretch + self.damping * rate, rate
        gap = np.where(self.half_gap > 0, self.half_gap, 1.0)
        sharp = stretch - np.clip(stretch, -self.half_gap, self.half_gap)
        touches = np.where(self.half_gap > 0, sharp != 0.0, True).astype(float)
        bend = np.where(self.half_gap > 0, np.tanh(stretch / gap), 0.0)
        soft, slope = stretch - self.half_gap * bend, np.where(self.half_gap > 0, bend * bend, 1.0)
        sharp, touches = np.where(self.rounded, soft, sharp), np.where(self.rounded, slope, touches)
        return self.stiffness * sharp + self.damping * touches * rate, rate

    def _advance(self, k: int, command: Array) -> None:
        known = None if self.scene.known is None else self.scene.known[k]
        if self.commands is None:
            self.commands = np.repeat(command[None, :], int(self.late.max()) + 2, axis=0)
        self.commands = np.concatenate([command[None, :], self.commands[:-1]])
        lanes = np.arange(command.size)
        new, old = self.commands[self.late, lanes], self.commands[self.late + 1, lanes]
        torque = new * self.gain + self.offset
        before = old * self.gain + self.offset
        self.q += 0.5 * self.step * self.v
        for j in range(self.num_steps):
            drive = before + (torque - before) * np.clip(j + 1.0 - self.switch, 0.0, 1.0) if self.has_delay else torque
            self._kick(drive, known, j)
            self.q += self.step * self.v
        self.q -= 0.5 * self.step * self.v

    def _kick(self, drive: Array, known: Array | None, index: int) -> None:
        v, laws = self.v, self.friction
        cable, rate = self._cable(self.q, v)
        weight = self.gravity * np.sin(self.q[1]) - self.pull
        if known is not None:
            weight = weight - known
        force = np.empty_like(v)
        np.multiply(cable, self.per_ratio, out=force[0])
        np.subtract(drive, force[0], out=force[0])
        np.subtract(cable, weight, out=force[1])
        if laws.is_plain:
            force -= self.plain_drag * v
            force *= self.kick
            force += v
            limit = self.plain_limit
        else:
            force -= laws.smooth(v)
            load = np.stack([drive, 0.5 * (cable + weight)])
            level = laws.level(v, load=load, direction=np.sign(v + self.kick * force))
            if laws.has_bristle:
                force -= laws.bristle_force(self.bristle, v, level=level, step=self.step)
                level = np.where(laws.bristled, 0.0, level)
            if laws.has_contact:
                level[1] += laws.contact_level(cable)
            force *= self.kick
            force += v
            limit = self.kick * level
        size = np.abs(force)
        size -= limit
        np.maximum(size, 0.0, out=size)
        self.v = np.copysign(size, force, out=size)
        if self.has_sensor_delay:
            slope = self.stiffness * rate
            for reading, value, change in zip(
                self.readings, (self.q[0], self.q[1], cable), (v[0], v[1], slope), strict=True
            ):
                reading.note(index, value, self.step * change)
