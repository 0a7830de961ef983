"""What is easily mistaken for what, and the motion or measurement that tells them apart."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from tendonlab.simulation.catalog import SystemInfo


@dataclass(frozen=True)
class Confusion:
    """Causes that may explain the same data equally well, and what `separates` them. `effects` holds names such as
    "joint:stribeck", or words (without a colon) for what is no effect. `where`, `unless`: an effect that the system
    has, or has not, if this separates them there. `odd`: the one that is told from the others, which stay alike."""

    effects: tuple[str, ...]
    separates: str
    where: str | None = None
    unless: str | None = None
    odd: str | None = None

    def of(self, info: SystemInfo) -> Confusion:
        """With those of its causes that this system may have; with none where it does not hold."""
        known = {None, *(e.name for e in info.effects)}
        holds = self.where in known and (self.unless is None or self.unless not in known)
        there = tuple(name for name in self.effects if name in known or ":" not in name)
        return Confusion(there if holds else (), self.separates)


_MOTOR_OR_JOINT = "motion that loads the cable differently: an added load, a torque chirp, one side held"
_AT_ONE_LEVEL = (
    "motion under which the dry friction changes, slow beside fast or light beside heavy load: an asymmetry is a "
    "share of the friction, an offset stays; at one level of friction they are the same"
)
CONFUSIONS = (
    Confusion(("motor:stribeck", "joint:stribeck"), _MOTOR_OR_JOINT),
    Confusion(("motor:presliding", "joint:presliding"), _MOTOR_OR_JOINT),
    Confusion(("motor:load_dependence", "joint:load_dependence", "contact:load_dependence"), _MOTOR_OR_JOINT),
    Confusion(
        ("actuation:offset", "motor:asymmetry", "joint:asymmetry"),
        "cable stretch under load; slow micro motion and standstill for the asymmetry",
        where="motor:asymmetry",
    ),
    Confusion(("load:offset", "joint:asymmetry"), _AT_ONE_LEVEL, where="motor:asymmetry"),
    Confusion(
        ("actuation:offset", "load:offset", "joint:asymmetry"),
        _AT_ONE_LEVEL,
        unless="motor:asymmetry",
        odd="joint:asymmetry",
    ),
    Confusion(
        ("actuation:offset", "load:offset"),
        "the motor switched off: an offset of the load stays, one of the motor goes",
    ),
    Confusion(
        ("actuation:offset", "load:offset", "sensor.joint_angle:bias"),
        "gravity at other angles and with another payload: a bias shifts the angle at which gravity acts, an offset "
        "adds the same torque everywhere",
        odd="sensor.joint_angle:bias",
    ),
    Confusion(
        ("actuation:offset", "sensor.output_torque:bias"),
        "the load taken off: a bias of the sensor stays in its reading",
    ),
    Confusion(
        ("actuation:delay", "sensor.joint_angle:delay"),
        "measuring both motor and joint; the motor's signal alone cannot tell",
        where="sensor.motor_angle:delay",
    ),
    Confusion(
        ("actuation:delay", "sensor.joint_angle:delay"),
        "a second reading of the motion, such as an accelerometer: in one reading a late command and a late sensor "
        "look alike",
        unless="sensor.motor_angle:delay",
    ),
    Confusion(
        ("cable:load_dependence", "gear:efficiency", "load:scale_error"),
        "several loads, each raised and lowered: a cable loses with the sense of its own motion, a gear with that of "
        "the joint's power, and a wrong load does not turn its sign with the motion",
    ),
    Confusion(
        ("stiction:hold", "joint:coulomb", "joint:viscous"),
        "pushes on the resting joint at several speeds, with their torque: dry friction of the joint resists up to a "
        "level, viscous friction by the speed, stiction of the guides not at all",
        where="stiction:hold",
    ),
    Confusion(
        ("actuation:gain_error", "all torque parameters together"), "nothing, unless one mass or torque is known"
    ),
    Confusion(
        ("actuation:gain_error", "a torque sensor in the cable that reads too much or too little"),
        "a known weight held by the joint: it tells which of the two torques is right",
        where="sensor.cable_torque:bias",
    ),
    Confusion(
        ("sheath:pretension_loss", "a smaller friction coefficient of the sheath"),
        "a friction coefficient from runs whose pretension is sure; wrap angles far apart",
    ),
    Confusion(
        ("sheath:slack", "sheath:load_dependence"), "torques below and above 2 r T_s, at more than one pretension"
    ),
    Confusion(
        ("sheath:presliding", "sheath:distributed_presliding", "cable:compliance", "sensor.output_torque:delay"),
        "partial reversals of the torque beside full ones, slow and fast",
    ),
    Confusion(
        ("sheath:viscous", "sensor.output_torque:delay"),
        "a load that is no spring: before a spring the torque rises with velocity, and what viscous friction takes "
        "from it looks like a torque that comes later",
    ),
)


def confusions(info: SystemInfo, effect: str) -> list[Confusion]:
    """The others of this system that are easily mistaken for `effect`, each with what separates them from it."""
    here = [confusion.of(info) for confusion in CONFUSIONS if effect in confusion.effects]
    rest = [Confusion(tuple(name for name in c.effects if name != effect), c.separates) for c in here]
    return [confusion for confusion in rest if confusion.effects]


def among(info: SystemInfo, effects: Collection[str]) -> list[Confusion]:
    """The confusions that two or more of `effects` share in this system, each with those of its own among them."""
    here = [c.of(info) for c in CONFUSIONS if c.odd is None or c.odd in effects]
    shared = [Confusion(tuple(name for name in c.effects if name in effects), c.separates) for c in here]
    return [confusion for confusion in shared if len(confusion.effects) > 1]
