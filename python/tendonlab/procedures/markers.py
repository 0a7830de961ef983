"""From optical markers on a sheath to its arc length, curvature and wrap angle (S3 eq. 4, 5), in plane and space.

An interpolating spline follows every error of its markers, and curvature is a second derivative: more markers make it
worse, not better. `smoothing` corrects this, and `wrap_angle_uncertainty` estimates what marker noise does to the
angle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, splev, splprep

from tendonlab.arguments import positive, reals, samples, whole, within
from tendonlab.errors import DatasetError, ParameterError, expected_one_of
from tendonlab.procedures.sheath_shape import Shape
from tendonlab.seed import generator

NUM_SAMPLES = 500  # of the paper
RULES = ("left", "trapezoid", "turning")
PARAMETERS = ("index", "chord")
KINDS = ("not-a-knot", "natural")


def sort_markers(points: np.ndarray, *, proximal: np.ndarray | None = None) -> np.ndarray:
    """Markers, m, shape (n, 2) or (n, 3), in their order along the sheath: first the one nearest to `proximal` (the
    drive's end; the first row unless given), then always the nearest of those left.

    Raises DatasetError for fewer than four markers, or two at one place; ParameterError for a `proximal` that
    is no such place."""
    points = _checked(points)
    start = points[0] if proximal is None else samples("proximal", proximal)
    if start.shape != points[0].shape:
        raise ParameterError(f"proximal = {start.tolist()}: expected {len(points[0])} coordinates as of a marker, m")
    left = list(range(len(points)))
    order = [left.pop(int(np.argmin(np.linalg.norm(points - start, axis=1))))]
    while left:
        distances = np.linalg.norm(points[left] - points[order[-1]], axis=1)
        order.append(left.pop(int(np.argmin(distances))))
    return points[order]


@dataclass(frozen=True)
class MarkerSpline:
    """The curve through ordered markers, m, (n, 2) or (n, 3), sampled at `num_samples` even values of its parameter.

    `kind`: end condition of the interpolating cubic, "not-a-knot" (the paper's) or "natural". `parameter`: "index" of
    the marker (the paper's) or "chord" length. `smoothing`: sd of a marker's coordinate, m; the curve then passes the
    markers at about that distance instead of through them (0 interpolates).
    Raises ParameterError for an unknown word, DatasetError for fewer than four markers, or two at one place."""

    points: np.ndarray = field(repr=False)
    kind: str = "not-a-knot"
    parameter: str = "index"
    smoothing: float = 0.0
    num_samples: int = NUM_SAMPLES

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", _checked(self.points))
        for name, value, known in (("kind", self.kind, KINDS), ("parameter", self.parameter, PARAMETERS)):
            if value not in known:
                raise ParameterError(f"{name} = {value!r}: {expected_one_of(value, known)}")
        within("smoothing", self.smoothing, 0.0, np.inf, "m, a marker's sd")
        whole("num_samples", self.num_samples, 3)

    def knots(self) -> np.ndarray:
        """Parameter of each marker, (n,)."""
        if self.parameter == "index":
            return np.arange(len(self.points), dtype=float)
        chords = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate(([0.0], np.cumsum(chords)))

    def derivatives(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Parameter (N,) and the curve r, its first and its second derivative, each (N, 2) or (N, 3)."""
        u = self.knots()
        t = np.linspace(u[0], u[-1], self.num_samples)
        if self.smoothing == 0.0:
            spline = CubicSpline(u, self.points, bc_type=self.kind)
            return t, spline(t), spline(t, 1), spline(t, 2)
        target = self.points.size * self.smoothing**2  # sum of squares that noise of that sd leaves
        knots, _ = splprep(self.points.T, u=u, s=target)
        r, first, second = (np.asarray(splev(t, knots, der=order)).T for order in range(3))
        return t, r, first, second

    def arc_length(self, *, rule: str = "trapezoid") -> np.ndarray:
        """s from the first sample on, m, (N,); the last is the sheath's length. Source: S3 eq. 4."""
        t, _, first, _ = self.derivatives()
        return _running(np.linalg.norm(first, axis=1), t, _known_rule(rule, without="turning"))

    def curvature(self) -> np.ndarray:
        """kappa at each sample, 1/m, (N,). Source: S3 eq. 5."""
        _, _, first, second = self.derivatives()
        return np.asarray(_cross_norm(first, second) / np.linalg.norm(first, axis=1) ** 3)

    def turning(self, *, rule: str = "trapezoid") -> np.ndarray:
        """phi, the angle turned from the first sample on, rad, (N,).

        "left" sums kappa_k ds_k as the paper does, "trapezoid" integrates, "turning" adds the angles between successive
        tangents and so needs no second derivative. Source: S3 eq. 5b."""
        t, _, first, _ = self.derivatives()
        if _known_rule(rule) == "turning":
            angles = np.arctan2(_cross_norm(first[:-1], first[1:]), np.einsum("ij,ij->i", first[:-1], first[1:]))
            return np.concatenate(([0.0], np.cumsum(angles)))
        return _running(self.curvature() * np.linalg.norm(first, axis=1), t, rule)

    def wrap_angle(self, *, rule: str = "trapezoid") -> float:
        """theta, rad: the whole angle turned. Source: S3 eq. 5b."""
        return float(self.turning(rule=rule)[-1])

    def shape(self, *, rule: str = "trapezoid") -> Shape:
        """Arc length, curvature and angle turned, as the model takes them."""
        along = self.arc_length(rule="trapezoid" if rule == "turning" else rule)
        return Shape(arc_length=along, turning=self.turning(rule=rule))


@dataclass(frozen=True)
class WrapAngle:
    """`value`: theta, rad, of the markers as given. `bias`, `sd`: its mean change and spread by marker noise, rad."""

    value: float
    bias: float
    sd: float


def wrap_angle_uncertainty(
    spline: MarkerSpline,
    *,
    marker_sd: float,
    rule: str = "trapezoid",
    num_resamples: int = 100,
    seed: int | np.random.Generator = 0,
) -> WrapAngle:
    """Uncertainty of the wrap angle, by resampling: noise of `marker_sd`, m, moves the markers many times.

    `value` contains the noise of the given markers already; `bias` is the effect of the same amount of noise again."""
    if not isinstance(spline, MarkerSpline):
        raise ParameterError(f"spline = {spline!r}: expected a MarkerSpline")
    positive("marker_sd", marker_sd, "m")
    whole("num_resamples", num_resamples, 2)
    rng = generator(seed)
    value = spline.wrap_angle(rule=rule)
    options: dict[str, Any] = {
        name: getattr(spline, name) for name in ("kind", "parameter", "smoothing", "num_samples")
    }
    angles = [
        MarkerSpline(spline.points + rng.normal(0.0, marker_sd, spline.points.shape), **options).wrap_angle(rule=rule)
        for _ in range(num_resamples)
    ]
    return WrapAngle(value, float(np.mean(angles)) - value, float(np.std(angles, ddof=1)))


def _checked(points: np.ndarray) -> np.ndarray:
    points = reals("points", points)
    if points.ndim != 2 or points.shape[1] not in (2, 3) or len(points) < 4 or not np.all(np.isfinite(points)):
        raise DatasetError(f"markers of shape {points.shape}: expected at least 4 finite rows of x, y or x, y, z, m")
    gaps = np.linalg.norm(points[:, None] - points[None], axis=2) + np.diag(np.full(len(points), np.inf))
    if gaps.min() == 0.0:
        i, j = np.argwhere(gaps == 0.0)[0]
        raise DatasetError(
            f"markers {i} and {j} lie at one place, where the curve has no direction; expected one of them"
        )
    return points


def _known_rule(rule: str, *, without: str = "") -> str:
    known = tuple(name for name in RULES if name != without)
    if rule not in known:
        raise ParameterError(f"rule = {rule!r}: {expected_one_of(rule, known)}")
    return rule


def _running(density: np.ndarray, t: np.ndarray, rule: str) -> np.ndarray:
    """Integral of `density` over the even parameter t from its start on."""
    step = t[1] - t[0]
    pieces = density[:-1] if rule == "left" else 0.5 * (density[:-1] + density[1:])
    return np.concatenate(([0.0], np.cumsum(pieces * step)))


def _cross_norm(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """|a × b| row by row, in the plane too."""
    if a.shape[1] == 2:
        return np.asarray(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]))
    return np.asarray(np.linalg.norm(np.cross(a, b), axis=1))
