"""How strong a signal goes with the angle of a shaft: a disturbance that turns with the screw is one line, at any
speed."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from tendonlab.arguments import samples, whole, within
from tendonlab.errors import ParameterError


def order_spectrum(turns: ArrayLike, values: ArrayLike, *, highest: float = 4.0, num_orders: int = 400) -> pd.Series:
    """Amplitude of `values`, in their unit, by order, cycles per turn, from 0 to `highest`.

    `turns` of the shaft at the samples, shape (n,), any spacing, either way. A signal a sin(2 pi k turns) shows a at
    order k; lines are as narrow as one cycle in all turns covered. Source: S2 Fig. 12c.
    Raises ParameterError where the shaft turns less than once, for samples that are missing or not finite, and where
    `highest` is below 1."""
    angle, signal = samples("turns", turns), samples("values", values)
    if len(signal) != len(angle):
        raise ParameterError(f"values has {len(signal)} samples: expected {len(angle)}, as many as turns")
    within("highest", highest, 1.0, np.inf)
    whole("num_orders", num_orders, 1)
    if np.ptp(angle) < 1.0:
        raise ParameterError(f"turns: {np.ptp(angle):.3g} covered; expected one or more")
    orders = np.linspace(0.0, highest, num_orders + 1)
    waves = np.exp(-2j * np.pi * np.outer(orders, angle))
    amplitudes = 2.0 * np.abs(waves @ (signal - signal.mean())) / len(signal)
    return pd.Series(amplitudes, index=pd.Index(orders, name="order"))
