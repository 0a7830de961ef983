"""Causes that the library lacks: each has its formula here, in the function of its name.

Parameters are per lane, (n,), and 0 where a lane lacks the cause.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from .description import Lanes

Array = NDArray[np.float64]

PREFIX = "unknown"
LARGEST = {  # amplitude; see `parameters`
    "bump": 8.0,
    "stop": 10.0,
    "warming": 1.5,
    "dwell": 3.0,
    "fade": 0.8,
    "creep": 0.8,
}
OF_JOINTS = ("bump", "stop", "warming", "dwell", "fade")


def named(causes: Sequence[str]) -> tuple[str, ...]:
    """The unknown causes as `effect` of a case."""
    return tuple(f"{PREFIX}:{name}" for name in causes)


def parameters(cause: str, amplitude: float, *, truth: Mapping[str, float], seed: int) -> dict[str, float]:
    """Parameters of a cause at `amplitude`; `seed` draws those that are no amplitude."""
    draw = np.random.default_rng([seed, 4])
    place, width, time = draw.uniform(-0.3, 0.3), draw.uniform(0.08, 0.2), draw.uniform(0.3, 1.0)
    weight = truth["gravity_torque"]
    found = {
        "bump": {"bump": amplitude, "bump_angle": place, "bump_width": width},
        "stop": {"stop_stiffness": amplitude * 3.0 * weight, "stop_angle": 0.3 + place},
        "warming": {"warming": amplitude, "warming_time": 200.0 * time},
        "dwell": {"dwell": amplitude, "dwell_time": 0.3 * time, "dwell_distance": 0.002},
        "fade": {"fade": amplitude, "fade_time": 3.0 * time, "fade_torque": weight / truth.get("gear_ratio", 1.0)},
        "creep": {"creep": amplitude, "creep_time": time},
    }
    return {name: float(value) for name, value in found[cause].items()}


def bump(angle: Array, *, height: Array, at: Array, width: Array) -> Array:
    """Local friction: the dry level grows by the factor 1 + height exp(-((angle - at)/width)^2)."""
    return np.asarray(1.0 + height * np.exp(-np.square((angle - at) / width)))


def stop(angle: Array, *, stiffness: Array, at: Array) -> Array:
    """One-sided elastic stop: -stiffness (angle - at) beyond `at`, N*m."""
    return np.asarray(-stiffness * np.maximum(angle - at, 0.0))


def warming(session_time: Array, *, share: float, time: float) -> Array:
    """Cold friction at the start of the session: all friction has the factor 1 + share exp(-session_time/time)."""
    return np.asarray(1.0 + share * np.exp(-session_time / time))


def dwell(age: Array, *, share: Array, time: Array) -> Array:
    """Ageing contact: the dry level has the factor 1 + share age/(age + time)."""
    return np.asarray(1.0 + share * age / (age + time))


def contact_age(age: Array, speed: Array, *, distance: Array, step: float) -> Array:
    """age' = 1 - |v| age/distance, s: the time at rest, forgotten after the sliding `distance`; one implicit step."""
    return np.asarray((age + step) / (1.0 + step * np.abs(speed) / distance))


def fade(torque: Array, heat: Array, *, share: Array) -> Array:
    """Torque of a warm motor: torque (1 - share heat), at least a fifth."""
    return np.asarray(torque * np.maximum(1.0 - share * heat, 0.2))


def heating(heat: Array, torque: Array, *, usual: Array, time: Array, step: float) -> Array:
    """heat' = ((torque/usual)^2 - heat)/time; one exact step."""
    target = np.square(torque / usual)
    return np.asarray(target + (heat - target) * np.exp(-step / time))


def creep(length: Array, stretch: Array, *, share: Array, time: Array, step: float) -> Array:
    """Creep of a cable: the elastic stretch is `stretch` - length, length' = (share stretch - length)/time."""
    target = share * stretch
    return np.asarray(target + (length - target) * np.exp(-step / time))


class Causes:
    """The unknown causes of n lanes that act on the joint's friction and the motor; states start at 0."""

    def __init__(self, lanes: Lanes, *, step: float, sample_time: float) -> None:
        self.lanes, self.step, self.sample_time = lanes, step, sample_time
        self.age, self.heat = np.zeros(lanes.size), np.zeros(lanes.size)
        self.has_bump, self.has_stop, self.has_dwell, self.has_fade = (
            bool(np.any(lanes.get(name))) for name in ("bump", "stop_stiffness", "dwell", "fade")
        )
        self.acts_on_joint = self.has_bump or self.has_stop or self.has_dwell

    def _shape(self, name: str) -> Array:
        value = self.lanes.get(name)
        return np.where(value > 0, value, 1.0)  # where a lane lacks the cause, any will do

    def drive(self, torque: Array) -> Array:
        """Torque of the motor, N*m, over the next sample."""
        if not self.has_fade:
            return torque
        weak = fade(torque, self.heat, share=self.lanes.get("fade"))
        usual, time = self._shape("fade_torque"), self._shape("fade_time")
        self.heat = heating(self.heat, torque, usual=usual, time=time, step=self.sample_time)
        return weak

    def torque(self, angle: Array) -> Array:
        """Torque on the joint, N*m."""
        return stop(angle, stiffness=self.lanes.get("stop_stiffness"), at=self.lanes.get("stop_angle"))

    def level(self, angle: Array, speed: Array) -> Array:
        """Factor on the joint's dry friction level over the next step."""
        factor = np.ones_like(angle)
        if self.has_bump:
            at, width = self.lanes.get("bump_angle"), self._shape("bump_width")
            factor = factor * bump(angle, height=self.lanes.get("bump"), at=at, width=width)
        if self.has_dwell:
            self.age = contact_age(self.age, speed, distance=self._shape("dwell_distance"), step=self.step)
            factor = factor * dwell(self.age, share=self.lanes.get("dwell"), time=self._shape("dwell_time"))
        return factor
