"""The ten shapes of S3: an assumed family, of which the paper prints one number each.

The paper gives only the distance between the ends of its shapes. Their geometry here is reconstructed: one bump,
tangent angle psi(s) = phi sin(2 pi s/L), ends aligned, so that d/L = J0(phi) and theta = 4 phi."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.optimize import brentq
from scipy.special import j0, jn_zeros

from tendonlab.errors import ParameterError
from tendonlab.papers.tables import table
from tendonlab.procedures.sheath_shape import Shape


@dataclass(frozen=True)
class BumpShape:
    """A sheath of the assumed family: `length` L, m, and the amplitude `phi`, rad, of its tangent angle."""

    length: float
    phi: float

    @classmethod
    def with_end_distance(cls, distance: float, *, length: float = 0.8) -> BumpShape:
        """The member whose ends are `distance` apart, m: J0(phi) = d/L. Raises ParameterError unless 0 < d < L."""
        if not 0.0 < distance < length:
            raise ParameterError(f"distance = {distance}: expected a value between 0 and the length {length} m")
        phi = brentq(lambda a: j0(a) - distance / length, 0.0, jn_zeros(0, 1)[0], xtol=1e-14, rtol=1e-14)
        return cls(length, float(phi))

    @property
    def wrap_angle(self) -> float:
        """theta = 4 phi, rad."""
        return 4.0 * self.phi

    @property
    def skew(self) -> float:
        """0: the shape is the same from both ends."""
        return 0.0

    def turning(self, arc_length: np.ndarray) -> np.ndarray:
        """phi(s), rad: the variation of psi up to s, m."""
        quarter = 4.0 * np.asarray(arc_length, dtype=float) / self.length
        swing = np.sin(0.5 * np.pi * quarter)
        return self.phi * np.select([quarter < 1.0, quarter < 3.0], [swing, 2.0 - swing], 4.0 + swing)

    def shape(self, *, num_samples: int = 501) -> Shape:
        """Arc length and angle turned, as the model takes them."""
        s = np.linspace(0.0, self.length, num_samples)
        return Shape(s, np.maximum.accumulate(self.turning(s)))

    def curve(self, *, num_samples: int = 2001) -> np.ndarray:
        """Points x, y of the sheath, m, (n, 2), at even arc lengths; it starts at the origin, along x."""
        s = np.linspace(0.0, self.length, num_samples)
        psi = self.phi * np.sin(2.0 * np.pi * s / self.length)
        return np.column_stack([cumulative_simpson(f(psi), x=s, initial=0.0) for f in (np.cos, np.sin)])

    def markers(
        self, num_markers: int = 15, *, noise_sd: float = 0.0, seed: int | np.random.Generator = 0
    ) -> np.ndarray:
        """Markers at even arc lengths, m, (n, 2), with measurement noise of `noise_sd`, m."""
        fine = 400 * (num_markers - 1)
        exact = self.curve(num_samples=fine + 1)[:: fine // (num_markers - 1)]
        return exact + np.random.default_rng(seed).normal(0.0, noise_sd, exact.shape)


@cache
def paper_shapes() -> tuple[BumpShape, ...]:
    """theta_1 … theta_10 of Fig. 4: the printed end distances with the assumed geometry."""
    rows = 0.01 * table("S3_shapes")[["end_distance_cm", "assumed_L_cm"]]
    return tuple(
        BumpShape.with_end_distance(float(distance), length=float(length)) for distance, length in rows.to_numpy()
    )


def paper_shape(number: int) -> BumpShape:
    """theta_i, i = 1 … 10. Raises ParameterError for any other number."""
    shapes = paper_shapes()
    if not 1 <= number <= len(shapes):
        raise ParameterError(f"shape = {number}: expected 1 ... {len(shapes)}")
    return shapes[number - 1]
