"""Tensions, gains and lengthening of the pretensioned pair (S3 eq. 6-18); the formulas are the compiled core's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tendonlab import _core
from tendonlab.catalog import nearest
from tendonlab.errors import ParameterError
from tendonlab.papers.s3.shapes import BumpShape, Shape

PROFILES = ("decaying", "uniform")


@dataclass(frozen=True, eq=False)
class TransmissionCoefficients:
    """The pair in sheaths of `shape` at friction coefficient `mu` and pretension `T_s`, N a cable; radii in m.

    `pretension_profile`: "decaying", the paper's C_TO = T_s Psi_alpha (eq. 12), or "uniform", C_TO = T_s L.
    Raises ParameterError for a negative or infinite number or an unknown profile."""

    shape: Shape | BumpShape
    mu: float
    T_s: float
    r_in: float
    r_out: float
    pretension_profile: str = "decaying"

    def __post_init__(self) -> None:
        object.__setattr__(self, "_pair", self.sheaths().at(self.mu))

    def sheaths(self) -> _core.Sheaths:
        """The compiled pair, at any friction coefficient."""
        return sheaths(self.shape, self.T_s, self.r_in, self.r_out, self.pretension_profile)

    @property
    def alpha(self) -> float:
        """exp(-mu theta). Source: S3 eq. 8."""
        return self._compiled.alpha

    @property
    def beta(self) -> float:
        """exp(mu theta). Source: S3 eq. 9."""
        return self._compiled.beta

    @property
    def Psi_alpha(self) -> float:
        """Integral of exp(-mu phi) along the sheath, m. Source: S3 eq. 11."""
        return self._compiled.psi_alpha

    @property
    def Psi_beta(self) -> float:
        """Integral of exp(mu phi) along the sheath, m. Source: S3 eq. 14."""
        return self._compiled.psi_beta

    @property
    def K_in(self) -> float:
        """Output per input torque, 1; r_out/r_in for every shape that is the same from both ends. Source: S3 eq. 18."""
        return self._compiled.torque_gain

    @property
    def K_TO(self) -> float:
        """Output torque per C_TO while it slides forwards, 1. Source: S3 eq. 18."""
        return self._compiled.pretension_gain

    @property
    def C_TO(self) -> float:
        """Integral of the pretension along the sheath, N·m. Source: S3 eq. 12."""
        return self._compiled.pretension_moment

    @property
    def offset(self) -> float:
        """K_TO C_TO, N·m: what friction takes from the output while it slides forwards. Source: S3 eq. 18."""
        return self._compiled.offset

    @property
    def slack_torque(self) -> float:
        """Input torque, N·m, above which the returning tendon would have to push: eq. 18 no longer holds there."""
        return 2.0 * self.r_in * self.T_s

    def output_torque(self, tau_in: np.ndarray | float, *, direction: int = 1) -> np.ndarray:
        """tau_out, N·m, of eq. 18 while it slides in `direction`, +1 or -1 (C_TO is kept, as the paper does)."""
        return np.asarray(self.K_in * np.asarray(tau_in, dtype=float) + _sign(direction) * self.offset)

    def tensions(self, tau_in: float, *, direction: int = 1) -> tuple[float, float, float, float]:
        """T_1 … T_4, N; see eq. 8, 9, 15-17. A negative one says that the tendon is slack (`slack_torque`)."""
        one, two, three, four = self._compiled.tensions(tau_in, _sign(direction) < 0)
        return one, two, three, four

    def elongations(self, tau_in: float, *, EA: float, direction: int = 1) -> tuple[float, float]:
        """Lengthening of the pulling and of the returning cable, m, of axial stiffness `EA`, N: they add up to 0.

        The first over r_in is the motion that is lost. Source: S3 eq. 10, 13, 17."""
        if not EA > 0:
            raise ParameterError(f"EA = {EA}: expected a positive stiffness, N")
        upper, lower = self._compiled.elongations(tau_in, _sign(direction) < 0, EA)
        return upper, lower

    @property
    def _compiled(self) -> _core.TendonPair:
        pair: _core.TendonPair = self.__dict__["_pair"]
        return pair


def sheaths(
    shape: Shape | BumpShape, T_s: float, r_in: float, r_out: float, pretension_profile: str = "decaying"
) -> _core.Sheaths:
    """The compiled pair in sheaths of `shape`; see TransmissionCoefficients."""
    if pretension_profile not in PROFILES:
        raise ParameterError(f"pretension_profile = {pretension_profile!r}: {nearest(pretension_profile, PROFILES)}")
    along = shape.shape() if isinstance(shape, BumpShape) else shape
    return _core.Sheaths(
        arc_length=along.arc_length.tolist(), turning=along.turning.tolist(), pretension=T_s, input_radius=r_in,
        output_radius=r_out, uniform_pretension=pretension_profile == "uniform",
    )  # fmt: skip


def capstan_tension(tension_in: np.ndarray | float, mu: float, theta: float, *, direction: int = -1) -> np.ndarray:
    """T_out, N, behind a wrap angle theta, rad: T_in exp(direction mu theta). Source: S3 eq. 6, its lambda = ±1."""
    return np.asarray(np.asarray(tension_in, dtype=float) * np.exp(_sign(direction) * mu * theta))


def _sign(direction: int) -> int:
    if direction not in (-1, 1):
        raise ParameterError(f"direction = {direction}: expected +1 or -1")
    return direction
