"""Constants of the cable-driven joint: Tables I and II of S2, and reconstructed values that the tables lack."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tendonlab.arguments import choice
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.papers.tables import table

GRAVITY = 9.80665  # m/s^2
PRELOAD = 200.0  # N, of the cables in all runs; reconstructed: printed for the cable test only
BRANCHES = ("a1", "a2", "b11", "b12", "b21", "b22", "c1", "c2")
VISCOUS_READINGS = {  # c_m is printed as 10.319 "mNm/s", which is no viscous unit; N*m*s/rad
    "A": 10.319e-3,  # mN*m*s/rad
    "B": 10.319e-3 * 60.0 / (1000.0 * 2.0 * np.pi),  # mN*m per 1000 turns per minute
    "C": 10.319e-6,  # uN*m*s/rad
}


@dataclass(frozen=True, kw_only=True)
class Constants:
    """The rig in the paper's symbols, SI (S2 Tables I and II). `N_g`: gear, `N_s`: screw, m/rad. `phi`: mounting angle
    of the base from the horizontal, rad, and `T`: preload, N, are reconstructed; `g` = 0 lays the joint flat."""

    L_m: float
    R_m: float
    c_m: float
    J_m: float
    k_m: float
    N_g: float
    N_s: float
    m_1: float
    J_1: float
    m_2: float
    J_2: float
    d_11: float
    d_12: float
    d_21: float
    d_22: float
    r: float
    alpha: float
    beta: float
    K: float
    c: float
    bushings: tuple[Mapping[str, float], Mapping[str, float]]
    T: float = PRELOAD
    phi: float = 0.0
    g: float = GRAVITY

    @property
    def N(self) -> float:  # noqa: N802 - the paper's symbol
        """Travel of the nuts per motor angle, N_g N_s, m/rad."""
        return self.N_g * self.N_s

    @property
    def p(self) -> float:
        """Pitch of the screw, m per turn."""
        return 2.0 * np.pi * self.N_s

    @property
    def l_1(self) -> float:
        """Length of the first link, m."""
        return self.d_11 + self.d_12

    @property
    def l_2(self) -> float:
        """Length of the second link, m."""
        return self.d_21 + self.d_22

    def with_(self, **changes: float) -> Constants:
        """The same rig with some constants changed."""
        return replace(self, **changes)  # type: ignore[arg-type]

    def time_constants(self) -> dict[str, float]:
        """Of winding, motor (short circuit) and cable, s: L/R, J/(c_m + k^2/R), c/K."""
        motor = self.J_m / (self.c_m + self.k_m**2 / self.R_m)
        return {"L_over_R": self.L_m / self.R_m, "J_over_c_plus_k2_R": motor, "c_over_K": self.c / self.K}


def constants(*, viscous_reading: str = "A") -> Constants:
    """The printed constants. `viscous_reading`: what the misprinted unit of c_m means, "A" mN*m*s/rad, "B" mN*m per
    1000 turns per minute, "C" uN*m*s/rad; A is doubtful, since it asks 4.8 N*m at full speed (S2 Table I).

    Raises ParameterError for another reading."""
    if viscous_reading not in VISCOUS_READINGS:
        known = expected_one_of(viscous_reading, VISCOUS_READINGS)
        raise ParameterError(f"viscous_reading = {viscous_reading!r}: {known}")
    one = table("S2_table1_parameters").set_index("symbol")["value_SI"]
    names = ["L_m", "R_m", "J_m", "k_m", "m_1", "J_1", "m_2", "J_2", "d_11", "d_12", "d_21", "d_22", "r"]
    two = identified()
    own = {name: float(one[name]) for name in names}
    gear, cable = two["harmonic gear"], two["cable"]
    return Constants(
        **own,
        c_m=VISCOUS_READINGS[viscous_reading],
        N_g=1.0 / 80.0,
        N_s=0.005 / (2.0 * np.pi),
        alpha=gear["alpha"],
        beta=gear["beta"],
        K=cable["K"],
        c=cable["c"],
        bushings=(two["cable 1 friction"], two["cable 2 friction"]),
    )


def identified(column: str = "value_SI") -> dict[str, dict[str, float]]:
    """Table II as {"cable": {"K": …}, "cable 1 friction": {"a1": …}}; `column`: "value_SI" or "uncertainty_95_SI".

    Raises ParameterError for another column."""
    choice("column", column, ("value_SI", "uncertainty_95_SI"))
    found: dict[str, dict[str, float]] = {}
    for row in table("S2_table2_identified").to_dict("records"):
        symbol = str(row["symbol"])
        name = symbol.replace("_", "") if "friction" in str(row["group"]) else symbol
        found.setdefault(str(row["group"]), {})[name] = float(row[column])
    return found
