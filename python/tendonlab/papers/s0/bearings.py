"""Load of the bearings: reactions of pulley and capstan shaft, and the relative load (S0 eq. 9).

S0 does not print the cable's preload, nor the direction of its pull: by default it is 0 N and along the line of
centres, horizontal (reconstructed)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab.arguments import positive
from tendonlab.errors import ParameterError
from tendonlab.papers.s0.bench import CENTRES, Configuration, Shaft

SCOPES = ("pulley", "transmission")
AXES = ("z", "y")
DISCS = ("E", "end")


@dataclass(frozen=True, kw_only=True)
class Reactions:
    """Forces of the bearings A and B on their shaft, N: y upwards, z along the line of centres."""

    A_y: float
    B_y: float
    A_z: float
    B_z: float

    @property
    def R_A(self) -> float:  # noqa: N802
        """Magnitude at A, N."""
        return float(np.hypot(self.A_y, self.A_z))

    @property
    def R_B(self) -> float:  # noqa: N802
        """Magnitude at B, N."""
        return float(np.hypot(self.B_y, self.B_z))

    @property
    def total(self) -> float:
        """Sum of magnitudes, N. A is pulled down while B is pushed up: a signed sum would erase the lever."""
        return self.R_A + self.R_B


def cable_pull(
    of: Configuration, pretension: float, *, cable_diameter: bool = False, centres: float = CENTRES
) -> float:
    """Force of both cable sides on a shaft, N, along the line of centres: 2 T_pr cos(psi) with sin(psi) = (r_1 + r_2)/C
    for a crossed cable and (r_2 - r_1)/C for a parallel one (S0 Fig. 8).

    `pretension` N of each side, `centres` m. Raises ParameterError for a negative pretension or pulleys that touch."""
    r_1, r_2 = of.radii(cable_diameter=cable_diameter)
    if not (np.isfinite(pretension) and pretension >= 0):
        raise ParameterError(f"pretension = {pretension}: expected a value in [0, inf] N")
    positive("centres", centres, "m")
    sine = (r_1 + r_2 if of.crossed else r_2 - r_1) / centres
    if not 0 <= sine < 1:
        raise ParameterError(f"centres = {centres}: expected more than {r_1 + r_2} m, the sum of the radii")
    return float(2 * pretension * np.sqrt(1 - sine**2))


def reactions(shaft: Shaft, *, external: float = 0.0, pull: float = 0.0, axis: str = "z", disc: str = "E") -> Reactions:
    """Bearing reactions of a shaft that overhangs both its bearings (S0 Figs 8, 9).

    `external` N hangs at E, or at the pulley's end (`disc` = "end"); `pull` N is the cable's, along "z" (line of
    centres) or "y" (downwards: then it adds to the weights linearly). Raises ParameterError for another word."""
    _require("cable_axis", axis, AXES)
    _require("disc", disc, DISCS)
    at = shaft.end if disc == "end" or shaft.disc is None else shaft.disc
    down, along = (pull, 0.0) if axis == "y" else (0.0, pull)
    b_y = (shaft.gravity * shaft.weight + at * external + shaft.cable * down) / shaft.bearing
    b_z = shaft.cable * along / shaft.bearing
    return Reactions(A_y=shaft.weight + external + down - b_y, B_y=b_y, A_z=along - b_z, B_z=b_z)


def pulley_reactions(
    of: Configuration, *, pretension: float = 0.0, axis: str = "z", disc: str = "E", cable_diameter: bool = False
) -> Reactions:
    """Reactions of the pulley's bearings under its weight, the external load and the cable (S0 Fig. 8)."""
    pull = cable_pull(of, pretension, cable_diameter=cable_diameter)
    return reactions(of.pulley, external=of.external.weight, pull=pull, axis=axis, disc=disc)


def capstan_reactions(
    of: Configuration, *, pretension: float = 0.0, axis: str = "z", cable_diameter: bool = False
) -> Reactions:
    """Reactions of the capstan's bearings under its weight and the cable (S0 Fig. 9)."""
    return reactions(of.capstan, pull=cable_pull(of, pretension, cable_diameter=cable_diameter), axis=axis)


def relative_load(
    of: Configuration,
    *,
    pretension: float = 0.0,
    scope: str = "pulley",
    cable_axis: str = "z",
    disc: str = "E",
    cable_diameter: bool = False,
) -> float:
    """Relative load L_r, 1: bearing reactions of the pulley over those by its own weight alone (S0 eq. 9).

    `pretension` N of each cable side. `scope`: own weight of the "pulley" shaft only, or of both shafts of the
    "transmission", which S0 may also mean. `cable_axis`: "z" horizontal, "y" vertical. `disc`: the load at "E" or at
    the pulley's "end". `cable_diameter`: radii to the middle of the cable. Raises ParameterError for another word."""
    _require("scope", scope, SCOPES)
    carried = pulley_reactions(of, pretension=pretension, axis=cable_axis, disc=disc, cable_diameter=cable_diameter)
    own = reactions(of.pulley).total + (reactions(of.capstan).total if scope == "transmission" else 0.0)
    return carried.total / own


def _require(name: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise ParameterError(f"{name} = {value!r}: expected one of {', '.join(known)}")
