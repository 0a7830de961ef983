"""A drive, two pretensioned cables in sheaths and a load, advanced from sample to sample.

    u = (1 + gain_error) tau + offset - J dv/dt                      the torque that reaches the cables
    w = v - a L/(2 EA r^2) du/dt                                     what slides in the sheaths, rad/s at the drive
    y' = (slid - y) rate,  rate = ln(1 + exp(2 s (w^2 - w_t^2)))/1 ms    output: what is held slips away with speed

In the other form the rate is a power of speed that is as fast and as steep at w_t; parameters that are fitted again
hide the difference up to a quarter of the noise. `bowden_sheath` tells `slid`, the torque on the load of cables that
slide, and what may take the place of the gate. A rig without effect obeys S3 eq. 18-21, except that its sheaths have
finite elements. Nothing here is shared with the library under test.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from tendonlab.blind.description import Array, Lanes, Run, Scene
from tendonlab.blind.sensing import as_logged
from tendonlab.blind.unknown import bump, contact_age, dwell, fade, heating

from .bowden_sheath import Bristles, Sheath

GATE_TIME = 1e-3  # s, of the control loop for which S3 states the gate
WIDE_OPEN = 10.0  # log of a rate over that at the threshold velocity beyond which nothing is held
SOFTENING = 0.3  # of the other form of compliance: cables that stretch less per torque the more they carry


def simulate(lanes: Lanes, scene: Scene, step: float, stride: int) -> Run:
    """Run all lanes, logging every `stride`-th sample. The rig is one of samples: `step` is not used."""
    rig = _Rig(lanes, scene)
    output = np.stack(list(rig.samples()))
    kept = slice(scene.num_settle, None, stride)
    read, travel = _sensed(lanes, scene, output)[kept], rig.travel[kept]
    time: Array = np.arange(len(read), dtype=float) * scene.sample_time * stride
    state = np.stack([travel, output[kept]])
    return Run(time=time, command=scene.reference[kept], outputs=read[None], state=state)


def _sensed(lanes: Lanes, scene: Scene, output: Array) -> Array:
    """The torque sensor: late, biased, noisy, in steps."""
    late = lanes.get("sensor.output_torque_delay") / scene.sample_time
    at = np.maximum(np.arange(len(output))[:, None] - late, 0.0)
    before, lane = np.floor(at).astype(int), np.arange(lanes.size)
    after = np.minimum(before + 1, len(output) - 1)
    read = output[before, lane] + (at - before) * (output[after, lane] - output[before, lane])
    noise, resolution = (None if of is None else of[0] for of in (scene.noise, scene.resolution))
    return as_logged(read + lanes.get("sensor.output_torque_bias"), noise, resolution)


class _Rig:
    def __init__(self, lanes: Lanes, scene: Scene) -> None:
        self.lanes, self.period = lanes, scene.sample_time
        drive = scene.others["input_velocity"]
        command = scene.reference * (1.0 + lanes.get("actuation_gain_error")) + lanes.get("actuation_offset")
        self.torque = command - lanes.get("actuation_drive_inertia") * self._rate(drive)
        self.velocity = drive - self._stretching()
        self.travel = self.period * np.cumsum(self.velocity, axis=0)
        self.sheath, self.bristles = Sheath(lanes), Bristles(lanes, self.period)
        self.heat, self.age = np.zeros(lanes.size), np.zeros(lanes.size)

    def _rate(self, signal: Array) -> Array:
        return np.asarray(np.gradient(signal, self.period, axis=0))

    def _stretching(self) -> Array:
        """Part of the drive's velocity that only stretches the cables, rad/s; those of the other form stiffen."""
        get = self.lanes.get
        share = get("cable_compliance")
        if not share.any():
            return np.zeros_like(self.torque)
        compliance = share * get("sheath_length") / (2.0 * get("cable_stiffness") * get("input_radius") ** 2)
        size = np.abs(self.torque)
        loaded = size / (size + 2.0 * get("input_radius") * get("pretension"))
        softer = np.where(self.lanes.form != 0, 1.0 + SOFTENING * (1.0 - 2.0 * loaded), 1.0)
        return compliance * softer * self._rate(self.torque)

    def samples(self) -> Iterator[Array]:
        """Yield the torque on the load of every sample, N*m, (n,), with those before the log."""
        held = None
        for k, velocity in enumerate(self.velocity):
            torque = self._weakened(self.torque[k])
            at = self.sheath.slide(torque, velocity, pretension=self._pretension(k), dry=self._dry_factor(k))
            slid = at.smooth - at.sense * at.level
            held = slid + self._keeps(velocity) * ((at.middle if held is None else held) - slid)
            yield self.bristles.output(held, at, velocity)

    def _keeps(self, velocity: Array) -> Array:
        """Share of the held torque that is left after a sample."""
        steepness, threshold = self.lanes.get("threshold_slope"), self.lanes.get("threshold_velocity")
        rate = np.logaddexp(0.0, 2.0 * steepness * (velocity**2 - threshold**2))
        power = 2.0 * steepness * threshold**2 / np.log(2.0)  # as steep where half of the gate is open
        faster = np.log(np.abs(velocity) / self._positive("threshold_velocity") + 1e-9)
        rate = np.where(self.lanes.form != 0, np.log(2.0) * np.exp(np.minimum(power * faster, WIDE_OPEN)), rate)
        return np.asarray(np.exp(-rate * self.period / GATE_TIME))

    def _pretension(self, sample: int) -> Array:
        """Pretension of a cable, N; the lining settles over a run where that is the unknown cause."""
        settled = 1.0 - np.exp(-sample * self.period / self._positive("settling_time"))
        return np.asarray(self.lanes.get("pretension") * (1.0 - self.lanes.get("settling") * settled))

    def _weakened(self, torque: Array) -> Array:
        """Torque of a drive that fades under load."""
        share = self.lanes.get("fade")
        if not share.any():
            return torque
        weak = fade(torque, self.heat, share=share)
        usual, time = self._positive("fade_torque"), self._positive("fade_time")
        self.heat = heating(self.heat, torque, usual=usual, time=time, step=self.period)
        return weak

    def _dry_factor(self, sample: int) -> Array:
        """Factor of the unknown causes on dry friction: a worn spot along the travel, friction that ages at rest."""
        get, factor = self.lanes.get, np.ones(self.lanes.size)
        if get("bump").any():
            at, width = get("bump_angle"), self._positive("bump_width")
            factor = factor * bump(self.travel[sample], height=get("bump"), at=at, width=width)
        if get("dwell").any():
            speed, distance = np.abs(self.velocity[sample]), self._positive("dwell_distance")
            self.age = contact_age(self.age, speed, distance=distance, step=self.period)
            factor = factor * dwell(self.age, share=get("dwell"), time=self._positive("dwell_time"))
        return factor

    def _positive(self, name: str) -> Array:
        """A parameter; 1 where a lane lacks the cause."""
        value = self.lanes.get(name)
        return np.where(value > 0, value, 1.0)
