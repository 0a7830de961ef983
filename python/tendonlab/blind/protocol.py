"""The committed protocol of the blind check: what is drawn, when a rig is drawn again, and which seeds serve what."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any

from .planning import Options
from .rig import forms_of
from .systems import SYSTEMS

STANDARD, FILE = "standard", "protocol.toml"
FORMAT = "tendonlab-protocol/1"
PURPOSES = ("development", "calibration", "test")


@dataclass(frozen=True, kw_only=True)
class Protocol:
    """`version` of the protocol, and hash of its file. `options`: fields of `Options`. `seeds`: the first and the last
    seed that serve a purpose."""

    version: int
    sha256: str
    options: dict[str, Any]
    seeds: dict[str, tuple[int, int]]

    def drawn(self, seed: int, *, purpose: str = "", changed: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """What `draw` and `follow` draw by this protocol, except for the options `changed`, see `others`. `purpose`:
        that which the seed serves, where none is given. Raises ValueError where the seed does not serve it, or none."""
        purpose = purpose or self.purpose_of(seed)
        self.require_purpose(seed, purpose)
        others = self.others(changed or {})
        return {**self.options, **others, "origin": self.origin(purpose=purpose, changed=list(others))}

    def others(self, changed: Mapping[str, Any]) -> dict[str, Any]:
        """The options among `changed` that the protocol has otherwise. Other strengths are those of all pairs: none
        hides a weak effect behind a strong one, unless `changed` says so."""
        others = {name: value for name, value in changed.items() if value != self._option(name)}
        if others.keys() & {"strengths", "second"} and "dominant" not in changed and self._option("dominant"):
            others["dominant"] = 0.0
        return others

    def _option(self, name: str) -> object:
        return self.options.get(name, getattr(Options, name, None))

    def origin(self, *, purpose: str, changed: list[str]) -> dict[str, object]:
        """What a truth says of the protocol: version, hash of its file, purpose, and the options that were changed."""
        return {"version": self.version, "sha256": self.sha256, "purpose": purpose, "changed": sorted(changed)}

    def purpose_of(self, seed: int) -> str:
        """What a seed serves. Raises ValueError where it serves nothing."""
        for purpose, (first, last) in self.seeds.items():
            if first <= seed <= last:
                return purpose
        ranges = ", ".join(f"{first} to {last} ({purpose})" for purpose, (first, last) in self.seeds.items())
        raise ValueError(f"seed = {seed}: expected one from {ranges}")

    def require_purpose(self, seed: int, purpose: str) -> None:
        """Raise ValueError where the seed does not serve the purpose, so that no case serves two."""
        if purpose not in self.seeds:
            raise ValueError(f"purpose = {purpose!r}: expected one of {', '.join(self.seeds)}")
        first, last = self.seeds[purpose]
        if not first <= seed <= last:
            raise ValueError(f"seed = {seed}: expected one from {first} to {last}, which serve {purpose}")


def read(where: str | Path = STANDARD) -> Protocol:
    """The protocol that is shipped, "standard", or that of a file. Raises ValueError for another format, for what
    `Options` refuses, for seeds that serve two purposes, and where the file lists other forms than the generator has.
    """
    content = ((files("tendonlab.blind") / FILE) if str(where) == STANDARD else Path(where)).read_bytes()
    try:
        given = tomllib.loads(content.decode("utf-8"))
        _require(given.get("format") == FORMAT, "format", given.get("format"), repr(FORMAT))
        _refuse_others("", given, ("format", "version", *TABLES, "changes"))
        _require(_is_whole(given.get("version")), "version", given.get("version"), "a whole number")
        for name in TABLES:
            _require(isinstance(given.setdefault(name, {}), dict), name, given[name], "a table")
        options, seeds = _options(given["draw"]), _seeds(given["seeds"])
        _refuse_other_rigs(given["rigs"])
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from error
    return Protocol(version=given["version"], sha256=hashlib.sha256(content).hexdigest(), options=options, seeds=seeds)


def listed_of(kind: str) -> dict[str, object]:
    """What a protocol lists of a kind of rig: its sample times, s, its unknown causes, and the forms of each effect."""
    system = SYSTEMS[kind]
    forms = {effect: list(forms_of(system, effect)) for effect in system.effects}
    return {"sample_times": list(system.sample_times), "causes": list(system.causes), "forms": forms}


def _options(given: Mapping[str, Any]) -> dict[str, Any]:
    types = {field.name: str(field.type).removesuffix(" | None") for field in fields(Options)}
    _refuse_others("draw.", given, tuple(types))
    for name, value in given.items():
        expected, is_right = TYPES[types[name]]
        _require(is_right(value), f"draw.{name}", value, expected)
    options: dict[str, Any] = {
        name: tuple(value) if isinstance(value, list) else value for name, value in given.items()
    }
    try:
        Options(**options)
    except ValueError as error:
        raise ValueError(f"draw.{error}") from error
    return options


def _seeds(given: Mapping[str, Any]) -> dict[str, tuple[int, int]]:
    for purpose, ends in given.items():
        _require(_are_two(ends) and all(map(_is_whole, ends)), f"seeds.{purpose}", ends, "two whole numbers")
    seeds = {purpose: (first, last) for purpose, (first, last) in given.items()}
    _refuse_shared(seeds)
    return seeds


def _refuse_other_rigs(given: Mapping[str, Any]) -> None:
    _refuse_others("rigs.", given, tuple(SYSTEMS))
    for kind, listed in given.items():
        _require(isinstance(listed, dict), f"rigs.{kind}", listed, "a table")
        own = listed_of(kind)
        _refuse_others(f"rigs.{kind}.", listed, tuple(own))
        for name, value in own.items():
            found = listed.get(name)
            _require(found == value, f"rigs.{kind}.{name}", found, f"what this generator draws, {value}")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


def _are_two(value: object) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))


TABLES = ("draw", "seeds", "rigs")
TYPES: dict[str, tuple[str, Callable[[Any], bool]]] = {  # of the fields of `Options`
    "str": ("a text", lambda x: isinstance(x, str)),
    "int": ("a whole number", _is_whole),
    "float": ("a number", _is_number),
    "tuple[str, ...]": ("a list of texts", lambda x: isinstance(x, list) and all(isinstance(one, str) for one in x)),
    "tuple[float, float]": ("two numbers", _are_two),
}


def _require(is_right: bool, name: str, value: object, expected: str) -> None:
    if not is_right:
        raise ValueError(f"{name} = {value!r}: expected {expected}")


def _refuse_others(table: str, given: Mapping[str, Any], known: Sequence[str]) -> None:
    for name, value in given.items():
        _require(name in known, f"{table}{name}", value, f"one of {', '.join(known)}")


def _refuse_shared(seeds: Mapping[str, tuple[int, int]]) -> None:
    """Raise ValueError where a purpose has no seeds, or shares some with another one."""
    if sorted(seeds) != sorted(PURPOSES):
        raise ValueError(f"seeds = {sorted(seeds)}: expected those of {', '.join(PURPOSES)}")
    for purpose, (first, last) in seeds.items():
        if not 0 <= first <= last:
            raise ValueError(f"seeds.{purpose} = {first}, {last}: expected 0 <= first <= last")
    ordered = sorted(seeds.items(), key=lambda entry: entry[1])
    for (one, (_, last)), (other, (first, _)) in pairwise(ordered):
        if first <= last:
            raise ValueError(f"seeds {first} to {last} serve {one} and {other}: expected one purpose each")
