"""The two models of S0 in its own symbols: the static LuGre curve (eq. 3) and the load-and-ratio model (eq. 11).

Formulas are the library's laws; this file adds names, parameter sets and warnings."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from tendonlab import _core
from tendonlab.errors import ParameterError
from tendonlab.papers.tables import table

if TYPE_CHECKING:
    from tendonlab._core import Law

PROPOSED_SETS = ("table8_set", "identified_on_twin")


@dataclass(frozen=True, kw_only=True)
class Lugre:
    """Static LuGre curve (S0 eq. 3): F_c, F_s N·m, theta_s rad/s, F_v N·m·s/rad, alpha 1."""

    F_c: float
    F_s: float
    theta_s: float
    F_v: float
    alpha: float = 2.0

    @property
    def curve(self) -> Law:
        """Its dry part, as a law of the library."""
        return _core.friction.StaticLugre(
            coulomb=self.F_c,
            static_friction=self.F_s,
            stribeck_velocity=self.theta_s,
            stribeck_exponent=self.alpha,
        )

    def torque(self, speed: np.ndarray | float) -> np.ndarray:
        """Friction torque, N·m, shape of `speed`, rad/s of the input."""
        viscous = _core.friction.Viscous(viscous=self.F_v)
        return np.asarray(self.curve.force(velocity=speed) + viscous.force(velocity=speed))

    @property
    def warning(self) -> str:
        """A warning about these values, or ""."""
        if self.F_s >= self.F_c:
            return ""
        return f"F_s = {self.F_s:.4g} < F_c = {self.F_c:.4g} N·m: shape parameters of a rising curve, no stiction"


@dataclass(frozen=True, kw_only=True)
class Proposed:
    """The load-and-ratio model (S0 eq. 11): F_c, F_s N·m, theta_s rad/s, F_v N·m·s/rad, delta, beta, alpha, gamma 1."""

    F_c: float
    F_s: float
    theta_s: float
    F_v: float
    delta: float
    beta: float
    alpha: float
    gamma: float

    def law(self, ratio: float, *, exponent: str = "alpha") -> Law:
        """The law of the library at transmission ratio N. `exponent` "printed": the exponential carries delta, as S0
        prints it; "alpha": what is meant. Raises ParameterError for another word."""
        if exponent not in ("alpha", "printed"):
            raise ParameterError(f"exponent = {exponent!r}: expected alpha or printed")
        return _core.friction.LoadAndRatio(
            coulomb=self.F_c,
            static_friction=self.F_s,
            stribeck_velocity=self.theta_s,
            viscous=self.F_v,
            load_exponent=self.delta,
            peak_exponent=self.beta,
            stribeck_exponent=self.alpha if exponent == "alpha" else self.delta,
            viscous_exponent=self.gamma,
            transmission_ratio=ratio,
        )

    def torque(
        self, speed: np.ndarray | float, *, load: np.ndarray | float, ratio: float, exponent: str = "alpha"
    ) -> np.ndarray:
        """Friction torque, N·m, at input `speed`, rad/s, and relative load `load` > 0 (they broadcast)."""
        return np.asarray(self.law(ratio, exponent=exponent).force(velocity=speed, load=load))

    def viscous_torque(self, speed: np.ndarray | float, *, load: np.ndarray | float, ratio: float) -> np.ndarray:
        """Its viscous part alone, N·m."""
        viscous = {**asdict(self), "F_c": 0.0, "F_s": 0.0}
        return Proposed(**viscous).torque(speed, load=load, ratio=ratio)

    def values(self) -> np.ndarray:
        """The eight parameters in the order of their fields."""
        return np.array(list(asdict(self).values()))


@dataclass(frozen=True, kw_only=True)
class Decaying:
    """The load-and-ratio model whose viscous part fades, times 1/(1 + (w/omega_d)^q): S0's decay above 80 rad/s, which
    eq. 11 cannot give (grease that thins as it heats; an addition of ours). omega_d rad/s, q 1."""

    model: Proposed
    omega_d: float
    q: float

    def torque(self, speed: np.ndarray | float, *, load: np.ndarray | float, ratio: float) -> np.ndarray:
        """Friction torque, N·m, at input `speed`, rad/s, and relative load `load`."""
        lost = 1 - 1 / (1 + (np.abs(speed) / self.omega_d) ** self.q)
        whole = self.model.torque(speed, load=load, ratio=ratio)
        return np.asarray(whole - lost * self.model.viscous_torque(speed, load=load, ratio=ratio))


def printed_lugre(transmission: str) -> Lugre:
    """S0 Table 6 (C35P75GX) or 7 (C25P104GX), as printed. Raises ParameterError for another transmission."""
    row = _rows("S0_table6_7_lugre_static", transmission).iloc[0]
    return Lugre(
        F_c=float(row["F_c_Nm"]),
        F_s=float(row["F_s_Nm"]),
        theta_s=float(row["theta_dot_s_rad_s"]),
        F_v=float(row["F_v_Nms_rad"]),
        alpha=float(row["alpha"]),
    )


def reconstructed(transmission: str, which: str = "table8_set") -> Proposed:
    """Parameters of eq. 11, which S0 does not print, reconstructed: "table8_set", from the proposed column of Table 8,
    or "identified_on_twin". Raises ParameterError for another set or transmission."""
    if which not in PROPOSED_SETS:
        raise ParameterError(f"set = {which!r}: expected one of {', '.join(PROPOSED_SETS)}")
    rows = _rows("S0_reconstructed_parameters", transmission)
    value = rows[rows["set"] == which].set_index("symbol")["value"]
    return Proposed(**{f.name: float(value[f.name]) for f in fields(Proposed)})


def _rows(name: str, transmission: str) -> pd.DataFrame:
    rows = table(name)
    if transmission not in set(rows["transmission"]):
        known = ", ".join(sorted(set(rows["transmission"])))
        raise ParameterError(f"transmission = {transmission!r}: expected one of {known}")
    return rows[rows["transmission"] == transmission]
