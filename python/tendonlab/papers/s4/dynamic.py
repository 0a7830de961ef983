"""The values that the paper keeps from Table III (sigma_0, sigma_1, sigma_2, v_s, mu_s), fitted to whole runs of the
rig."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tendonlab.data import Dataset
from tendonlab.identification.identify import identify
from tendonlab.identification.result import Identification

DYNAMIC = (
    "bristle_stiffness",
    "bristle_damping",
    "contact_viscous",
    "stribeck_velocity",
    "static_friction_coefficient",
)


def identify_dynamic(
    rig: Dataset, *, free: Sequence[str] = DYNAMIC, experiments: Sequence[str] | None = None, progress: bool = False
) -> Identification:
    """Fit the `free` parameters of the simulator "ccsrm" of `rig`, with the library's priors, everything else held at
    its value there: first fit k and mu_c (`identify_stiffness`, `identify_friction`), then these.

    They act at reversals only, so these decide. Look at `sd`: at the paper's speeds slip breaks away far above v_s, and
    mu_s and v_s are not seen; a slow run shows them. Raises DatasetError as `tendonlab.identify` does."""
    held = {name: replace(stated, sd=None if name in free else 0.0) for name, stated in rig.parameters.items()}
    return identify(replace(rig, parameters=held), experiments=experiments, progress=progress)
