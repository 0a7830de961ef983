"""What makes a rehearsal this rehearsal: its folder keeps it and takes no case of another one."""

from __future__ import annotations

from collections.abc import Sequence

from tendonlab.rehearsal.rig import SimulatedRig
from tendonlab.sweeping.fingerprint import digest, function_text, parts_of
from tendonlab.version import version


def settings_of(rigs: SimulatedRig, sizes: Sequence[float], seed: int, diagnose: object) -> dict[str, str]:
    """A digest or the text of each part of a rehearsal, by the name that a message gives it. Which effects, how many
    repeats and how much time are no part of it: a folder may be extended."""
    rig = rigs.rig
    simulator = (rig.kind, rig.axis, rig.nominal_effects, sorted(rig.parameters.items()), rig.controller)
    return {
        "package version": version(),
        "system, parameters or controller": digest([repr(simulator)]),
        "signals": digest([repr(sorted(rig.signals.items()))]),
        "experiments": digest(part for e in rigs.runs for part in (repr((e.split, e.repeat)), *parts_of(e))),
        "sizes": ", ".join(f"{size:g}" for size in sizes),
        "seed": str(seed),
        "function that diagnoses": "tendonlab.diagnose" if diagnose is None else function_text(diagnose),
    }
