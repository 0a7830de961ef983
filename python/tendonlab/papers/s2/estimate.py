"""Result of an identification of S2: values with 95 % intervals by Student t, as in Table II."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import t as student

from tendonlab.papers.s2.equations import Array

CONFIDENCE = 0.95


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """`values` and `half_widths` of their 95 % intervals by name, SI; `covariance` in the same order; `residual_sd` in
    the unit of what was fitted. `condition`: of the scaled regressors; `validation_error`: RMS error on samples that
    were not fitted, as a share of their range (NRMSE); `warnings`: reasons to doubt the numbers."""

    values: Mapping[str, float]
    half_widths: Mapping[str, float]
    covariance: Array = field(repr=False)
    residual_sd: float
    num_samples: int
    condition: float | None = None
    validation_error: float | None = None
    warnings: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> float:
        return self.values[name]

    def covers(self, truth: Mapping[str, float]) -> dict[str, bool]:
        """Whether each interval holds the true value."""
        return {name: abs(value - truth[name]) <= self.half_widths[name] for name, value in self.values.items()}

    def table(self) -> pd.DataFrame:
        """Rows by name: value and half width of the 95 % interval."""
        return pd.DataFrame({"value": pd.Series(self.values), "half_width_95": pd.Series(self.half_widths)})

    def _repr_html_(self) -> str:
        notes = "".join(f"<li>{note}</li>" for note in self.warnings)
        return f"{self.table().to_html(float_format=lambda x: f'{x:.6g}')}<ul>{notes}</ul>"

    def to_dict(self) -> dict[str, Any]:
        """Values and half widths as plain types."""
        return {"values": dict(self.values), "half_widths": dict(self.half_widths), "warnings": list(self.warnings)}


def from_jacobian(values: Mapping[str, float], jacobian: Array, residual: Array, **more: Any) -> Estimate:
    """Intervals from the Jacobian of the residuals at the least squares: s^2 (J'J)^-1, n - p degrees of freedom."""
    n, p = jacobian.shape
    variance = float(residual @ residual) / (n - p)
    scale = np.linalg.norm(jacobian, axis=0)  # columns of one size: units must not decide the rank
    _, strength, directions = np.linalg.svd(jacobian / scale, full_matrices=False)
    strength = np.maximum(strength, 1e-12 * strength[0])  # what is not seen gets an interval that says so
    inverse = (directions.T / strength**2) @ directions / np.outer(scale, scale)
    covariance = variance * inverse
    quantile = float(student.ppf(0.5 + CONFIDENCE / 2.0, n - p))
    widths = quantile * np.sqrt(np.diag(covariance))
    return Estimate(
        values=dict(values),
        half_widths=dict(zip(values, widths.tolist(), strict=True)),
        covariance=covariance,
        residual_sd=float(np.sqrt(variance)),
        num_samples=n,
        **more,
    )
