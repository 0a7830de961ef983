"""How a sheath lies: the angle that it has turned by at each arc length (S3 eq. 4, 5)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from tendonlab.arguments import positive, reals, whole, within
from tendonlab.errors import ParameterError


@dataclass(frozen=True, eq=False)
class Shape:
    """A sheath from the drive (s = 0) to the load: `arc_length` s, m, and `turning` phi(s), rad, both (n,), from 0.

    Raises ParameterError unless s increases and phi does not decrease."""

    arc_length: np.ndarray = field(repr=False)
    turning: np.ndarray = field(repr=False)

    def __post_init__(self) -> None:
        s, phi = (np.ascontiguousarray(reals(name, getattr(self, name))) for name in ("arc_length", "turning"))
        object.__setattr__(self, "arc_length", s)
        object.__setattr__(self, "turning", phi)
        if s.shape != phi.shape or s.ndim != 1 or len(s) < 2 or s[0] != 0.0 or phi[0] != 0.0:
            raise ParameterError(f"arc_length {s.shape}, turning {phi.shape}: expected equal lengths >= 2, both from 0")
        if not (np.isfinite(s).all() and np.isfinite(phi).all()):
            raise ParameterError(f"arc_length to {s[-1]}, turning to {phi[-1]}: expected finite numbers")
        if not (np.all(np.diff(s) > 0) and np.all(np.diff(phi) >= 0)):
            raise ParameterError("arc_length must increase and turning must not decrease along the sheath")

    @property
    def length(self) -> float:
        """L, m."""
        return float(self.arc_length[-1])

    @property
    def wrap_angle(self) -> float:
        """theta, rad."""
        return float(self.turning[-1])

    @property
    def skew(self) -> float:
        """How unevenly it is bent, in [-3, 3]: above 0 more towards the load, 0 for a shape that is the same from both
        ends. Of a curvature that changes linearly it is `skew` of `skewed`; any other shape has that of the linear one
        with its mean angle turned, 3 (1 - 2 <phi>/theta), which is all that its transmission shows up to order
        (mu theta)³ (S3 eq. 11, 14, 18)."""
        if self.wrap_angle == 0.0:
            return 0.0
        turned = self.turning / self.wrap_angle
        twice_mean = float((turned[1:] + turned[:-1]) @ np.diff(self.arc_length)) / self.length
        return min(max(3.0 * (1.0 - twice_mean), -3.0), 3.0)

    @classmethod
    def even(cls, wrap_angle: float, *, length: float, num_samples: int = 501) -> Shape:
        """Constant curvature over the whole `length`, m."""
        _check_plan(wrap_angle, length, num_samples)
        u = np.linspace(0.0, 1.0, num_samples)
        return cls(length * u, wrap_angle * u)

    @classmethod
    def skewed(cls, wrap_angle: float, *, length: float, skew: float, num_samples: int = 501) -> Shape:
        """Curvature that changes linearly along the sheath, theta/L (1 + skew (2 s/L - 1)); `skew` in [-1, 1]."""
        _check_plan(wrap_angle, length, num_samples)
        within("skew", skew, -1.0, 1.0)
        u = np.linspace(0.0, 1.0, num_samples)
        return cls(length * u, wrap_angle * ((1.0 - skew) * u + skew * u**2))


def _check_plan(wrap_angle: float, length: float, num_samples: int) -> None:
    within("wrap_angle", wrap_angle, 0.0, np.inf, "rad")
    positive("length", length, "m")
    whole("num_samples", num_samples, 2)
