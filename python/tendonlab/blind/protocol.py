"""The committed protocol of the blind check: what is drawn, when a rig is drawn again, and which seeds serve what."""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
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
        """What `draw` and `follow` draw by this protocol, except for the options `changed`. Raises ValueError where the
        seed does not serve the purpose."""
        if purpose:
            self.require_purpose(seed, purpose)
        changed = {name: value for name, value in (changed or {}).items() if value != self.options.get(name)}
        return {**self.options, **changed, "origin": self.origin(purpose=purpose, changed=list(changed))}

    def origin(self, *, purpose: str, changed: list[str]) -> dict[str, object]:
        """What a truth says of the protocol: version, hash of its file, purpose, and the options that were changed."""
        return {"version": self.version, "sha256": self.sha256, "purpose": purpose, "changed": sorted(changed)}

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
    shipped = files("tendonlab.blind") / FILE
    content = shipped.read_bytes() if str(where) == STANDARD else Path(where).read_bytes()
    given = tomllib.loads(content.decode("utf-8"))
    if given.get("format") != FORMAT:
        raise ValueError(f"{where}: format = {given.get('format')!r}: expected {FORMAT!r}")
    _refuse_others(f"{where}: draw", given.get("draw", {}), [field.name for field in fields(Options)])
    if not isinstance(given.get("version"), int):
        raise ValueError(f"{where}: version = {given.get('version')!r}: expected a whole number")
    options: dict[str, Any] = {
        name: tuple(x) if isinstance(x, list) else x for name, x in given.get("draw", {}).items()
    }
    Options(**options)
    seeds = {purpose: (int(first), int(last)) for purpose, (first, last) in given.get("seeds", {}).items()}
    _refuse_shared(str(where), seeds)
    for kind, listed in given.get("rigs", {}).items():
        if listed != listed_of(kind):
            raise ValueError(f"{where}: rigs.{kind}: expected what this generator draws, {listed_of(kind)}")
    return Protocol(version=given["version"], sha256=hashlib.sha256(content).hexdigest(), options=options, seeds=seeds)


def listed_of(kind: str) -> dict[str, object]:
    """What a protocol lists of a kind of rig: its sample times, s, its unknown causes, and the forms of each effect."""
    system = SYSTEMS[kind]
    forms = {effect: list(forms_of(system, effect)) for effect in system.effects}
    return {"sample_times": list(system.sample_times), "causes": list(system.causes), "forms": forms}


def _refuse_others(what: str, given: Mapping[str, Any], known: list[str]) -> None:
    for name in given:
        if name not in known:
            raise ValueError(f"{what}.{name}: expected one of {', '.join(known)}")


def _refuse_shared(where: str, seeds: Mapping[str, tuple[int, int]]) -> None:
    """Raise ValueError where a purpose has no seeds, or shares some with another one."""
    if sorted(seeds) != sorted(PURPOSES):
        raise ValueError(f"{where}: seeds = {sorted(seeds)}: expected those of {', '.join(PURPOSES)}")
    for purpose, (first, last) in seeds.items():
        if not 0 <= first <= last:
            raise ValueError(f"{where}: seeds.{purpose} = {first}, {last}: expected 0 <= first <= last")
    ordered = sorted(seeds.items(), key=lambda entry: entry[1])
    for (one, (_, last)), (other, (first, _)) in pairwise(ordered):
        if first <= last:
            raise ValueError(f"{where}: seeds {first} to {last} serve {one} and {other}: expected one purpose each")
