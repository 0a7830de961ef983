"""Tensions, gains and lengthening of the pretensioned pair (S3 eq. 6-18); the formulas are the compiled core's."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from tendonlab import _core
from tendonlab.arguments import within
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.papers.s3.shapes import BumpShape
from tendonlab.procedures.sheath_shape import Shape

PROFILES = ("decaying", "uniform")


@dataclass(frozen=True, kw_only=True)
class TransmissionCoefficients:
    """Tension ratios and gains of the pair at one friction coefficient (`of` computes them).

    `alpha`, `beta`: exp(-mu theta), exp(mu theta) (S3 eq. 8, 9). `Psi_alpha`, `Psi_beta`: integrals of exp(-mu phi) and
    exp(mu phi) along the sheath, m (eq. 11, 14). `K_in`: output per input torque, 1; r_out/r_in for every shape that is
    the same from both ends (eq. 18). `K_TO`: output torque per C_TO while it slides forwards, 1 (eq. 18). `C_TO`:
    integral of the pretension along the sheath, N·m (eq. 12). `offset`: K_TO C_TO, N·m, what friction takes from the
    output while it slides forwards. `slack_torque`: input torque, N·m, above which the returning tendon would have to
    push, so that eq. 18 no longer holds."""

    alpha: float
    beta: float
    Psi_alpha: float
    Psi_beta: float
    K_in: float
    K_TO: float
    C_TO: float
    offset: float
    slack_torque: float
    pair: _core.TendonPair = field(repr=False, compare=False)

    @classmethod
    def of(
        cls,
        shape: Shape | BumpShape,
        *,
        mu: float,
        T_s: float,
        r_in: float,
        r_out: float,
        pretension_profile: str = "decaying",
    ) -> TransmissionCoefficients:
        """Those of sheaths of `shape` at friction coefficient `mu` and pretension `T_s`, N per cable; radii in m.

        `pretension_profile`: "decaying", the paper's C_TO = T_s Psi_alpha (eq. 12), or "uniform", C_TO = T_s L.
        Raises ParameterError for a negative or infinite number or an unknown profile."""
        pair = sheaths(shape, T_s, r_in, r_out, pretension_profile).at(mu)
        return cls(
            alpha=pair.alpha, beta=pair.beta, Psi_alpha=pair.psi_alpha, Psi_beta=pair.psi_beta, K_in=pair.torque_gain,
            K_TO=pair.pretension_gain, C_TO=pair.pretension_moment, offset=pair.offset, slack_torque=2.0 * r_in * T_s,
            pair=pair,
        )  # fmt: skip

    def output_torque(self, tau_in: np.ndarray | float, *, direction: int = 1) -> np.ndarray:
        """tau_out, N·m, of eq. 18 while it slides in `direction`, +1 or -1 (C_TO is kept, as the paper does)."""
        return np.asarray(self.K_in * np.asarray(tau_in, dtype=float) + _sign(direction) * self.offset)

    def tensions(self, tau_in: float, *, direction: int = 1) -> tuple[float, float, float, float]:
        """T_1 … T_4, N; see eq. 8, 9, 15-17. A negative tension means that the tendon is slack (`slack_torque`)."""
        one, two, three, four = self.pair.tensions(tau_in, _sign(direction) < 0)
        return one, two, three, four

    def elongations(self, tau_in: float, *, EA: float, direction: int = 1) -> tuple[float, float]:
        """Lengthening of the pulling and of the returning cable, m, of axial stiffness `EA`, N: they add up to 0.

        The first over r_in is the motion that is lost. Source: S3 eq. 10, 13, 17."""
        if not EA > 0:
            raise ParameterError(f"EA = {EA}: expected a positive stiffness, N")
        upper, lower = self.pair.elongations(tau_in, _sign(direction) < 0, EA)
        return upper, lower


def sheaths(
    shape: Shape | BumpShape, T_s: float, r_in: float, r_out: float, pretension_profile: str = "decaying"
) -> _core.Sheaths:
    """The compiled pair in sheaths of `shape`; see TransmissionCoefficients.of."""
    if pretension_profile not in PROFILES:
        raise ParameterError(
            f"pretension_profile = {pretension_profile!r}: {expected_one_of(pretension_profile, PROFILES)}"
        )
    along = shape.shape() if isinstance(shape, BumpShape) else shape
    return _core.Sheaths(
        arc_length=along.arc_length.tolist(), turning=along.turning.tolist(), pretension=T_s, input_radius=r_in,
        output_radius=r_out, uniform_pretension=pretension_profile == "uniform",
    )  # fmt: skip


def capstan_tension(tension_in: np.ndarray | float, mu: float, theta: float, *, direction: int = -1) -> np.ndarray:
    """T_out, N, behind a wrap angle theta, rad: T_in exp(direction mu theta). Source: S3 eq. 6, its lambda = ±1."""
    mu = within("mu", mu, 0.0, math.inf)
    return np.asarray(np.asarray(tension_in, dtype=float) * np.exp(_sign(direction) * mu * theta))


def _sign(direction: int) -> int:
    if direction not in (-1, 1):
        raise ParameterError(f"direction = {direction}: expected +1 or -1")
    return direction
