"""What is easily mistaken for what, and the motion or measurement that tells them apart."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from tendonlab.simulation.catalog import SystemInfo


@dataclass(frozen=True)
class Confusion:
    """Causes that may explain the same data equally well, and what `separates` them. `effects` holds names such as
    "joint:stribeck", or words (without a colon) for what is no effect."""

    effects: tuple[str, ...]
    separates: str


_MOTOR_OR_JOINT = "motion that loads the cable differently: an added load, a torque chirp, one side held"
CONFUSIONS = (
    Confusion(("motor:stribeck", "joint:stribeck"), _MOTOR_OR_JOINT),
    Confusion(("motor:presliding", "joint:presliding"), _MOTOR_OR_JOINT),
    Confusion(("motor:load_dependence", "joint:load_dependence", "contact:load_dependence"), _MOTOR_OR_JOINT),
    Confusion(
        ("actuation:offset", "motor:asymmetry", "joint:asymmetry"),
        "cable stretch under load; slow micro motion and standstill for the asymmetry",
    ),
    Confusion(
        ("actuation:delay", "sensor.joint_angle:delay"),
        "measuring both motor and joint; the motor's signal alone cannot tell",
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
    ),
    Confusion(
        ("actuation:gain_error", "all torque parameters together"), "nothing, unless one mass or torque is known"
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
    known = {e.name for e in info.effects}
    found = []
    for confusion in CONFUSIONS:
        others = tuple(name for name in confusion.effects if (name in known or ":" not in name) and name != effect)
        if effect in confusion.effects and others:
            found.append(Confusion(others, confusion.separates))
    return found


def among(effects: Collection[str]) -> list[Confusion]:
    """The confusions that two or more of `effects` share, each with those of its own that are among them."""
    shared = [(tuple(name for name in c.effects if name in effects), c.separates) for c in CONFUSIONS]
    return [Confusion(names, separates) for names, separates in shared if len(names) > 1]
