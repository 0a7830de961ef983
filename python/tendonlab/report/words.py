"""Names of the library in the words of a report; what an effect is called stands beside its law, in the catalog."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from tendonlab.report.numbers import number
from tendonlab.simulation.catalog import kinds, system_info

VERDICTS = {
    "data_fault": "Data fault",
    "no_gap": "No gap",
    "parameters_only": "Parameters only",
    "effect": "Effect identified",
    "unknown_effect": "Unknown effect",
}
STAGES = {"nominal": "nominal", "refitted": "refitted", "with_effect": "with effect"}
REPLAYS = {
    "injection": "logged inputs, with the measured motion fed back to the simulator through the motor port",
    "controller": "rig and controller simulated together in free run, with any noise that the logged command shows",
    "free": "free run on the logged inputs",
    "inverse": "torque predicted from the measured motion",
}
_PROPER = {"coulomb": "Coulomb", "stribeck": "Stribeck", "bowden": "Bowden", "ar": "AR", "rms": "RMS"}
_RATES = {"velocity": 1, "speed": 1, "acceleration": 2}
_DECISIVE = 100.0  # nats: whatever lies beyond decides as surely
_IN_CODE = frozenset("_.:")
_COORDINATES = {"time": "s", "t": "s", "frequency": "Hz", "temperature": "degC"}


def words(name: str) -> str:
    """A name of the library with its underscores as spaces: "stribeck_velocity" is "Stribeck velocity"."""
    return " ".join(_PROPER.get(part, part) for part in name.replace(".", " ").replace("_", " ").split())


def element_words(element: str, kind: str, *, article: bool = False) -> str:
    """The noun of an element of the system `kind`: "contact" of a two_inertia is "pulley contact", with its article
    "the pulley contact"."""
    places = {row.name: row.place for row in system_info(kind).elements} if kind in kinds() else {}
    place = places.get(element, f"in the {words(element)}")
    noun = place.partition(" ")[2]
    return noun if article else noun.removeprefix("the ")


def coordinate_words(name: str, kind: str) -> str:
    """A coordinate of a port of the system `kind`: "stiction_2_velocity" of a cable_joint is "guide 2 velocity"."""
    port, _, quantity = name.rpartition("_")
    is_port = kind in kinds() and port in (row.name for row in system_info(kind).ports)
    return f"{port_words(port, kind)} {quantity}" if is_port else words(name)


def port_words(port: str, kind: str) -> str:
    """The noun of a port of the system `kind`: "stiction_2" of a cable_joint is "guide 2"."""
    element = next(row.element for row in system_info(kind).ports if row.name == port)
    number = [part for part in port.split("_") if part.isdigit()] if port != element else []
    noun = element_words(element, kind)
    return " ".join([noun.removesuffix("s") if number else noun, *number])


def phrase(name: str, kind: str) -> str:
    """An effect of the system `kind` in a sentence: "joint:stribeck" is "Stribeck friction at the joint". A name that
    the catalog does not have is spelt out."""
    known = {effect.name: effect.phrase for effect in system_info(kind).effects} if kind in kinds() else {}
    element, _, effect = name.rpartition(":")
    return known.get(name, f"{words(effect)} in the {words(element)}" if element else words(name))


def phrases(names: Iterable[str], kind: str, *, last: str = "and") -> str:
    """Effects of the system `kind` as a list in a sentence."""
    return listing((phrase(name, kind) for name in names), last=last)


def changed_friction(element: str, change: float, kind: str) -> str:
    """By how much, relative, the friction of an element of the system `kind` changed: "the friction of the joint fell
    by 7 %"."""
    where = element_words(element, kind, article=True)
    return f"the friction of {where} {'fell' if change < 0 else 'rose'} by {100 * abs(change):.0f} %"


def parameter_words(name: str, *, element: str = "") -> str:
    """A parameter's words, without the element where the text around already names it."""
    own = name.removeprefix(f"{element}_") if element else name
    return words(own)


def capital(text: str) -> str:
    """`text` with its first letter as at the start of a sentence; a name in code ("joint:stribeck", "dataset.toml")
    stays as it is."""
    first = text.partition(" ")[0].rstrip(".:,;")
    return text if _IN_CODE.intersection(first) else text[:1].upper() + text[1:]


def listing(items: Iterable[str], *, last: str = "and") -> str:
    """ "a", "a and b", "a, b and c"."""
    *head, tail = list(items) or [""]
    return f"{', '.join(head)} {last} {tail}" if head else tail


def separation(names: Sequence[str]) -> str:
    """What an experiment would decide between: causes, or a cause and none."""
    if len(names) == 1:
        return f"shows whether there is {names[0]}"
    return f"separates {listing(names, last='from' if len(names) == 2 else 'and')}"


def gain_words(nats: float | None, *, of: str = "evidence") -> str:
    """The evidence, or the gain `of` something else, that an experiment is expected to bring, with no digit that would
    not matter; empty where it is not known."""
    if nats is None or not math.isfinite(nats):
        return ""
    return f"expected {of} {'over 100' if nats > _DECISIVE else number(nats, 2)} nats"


def unit_of(coordinate: str, units: Mapping[str, str]) -> str:
    """The unit of a signal or of the rate of one ("joint_velocity" from "joint_angle"); empty if not known."""
    if coordinate in units or coordinate in _COORDINATES:
        return units.get(coordinate, _COORDINATES.get(coordinate, ""))
    stem, _, rate = coordinate.rpartition("_")
    base = units.get(f"{stem}_angle") or units.get(f"{stem}_position")
    if base is None or rate not in _RATES:
        return ""
    return f"{base}/s" if _RATES[rate] == 1 else f"{base}/s^2"
