"""Friction of a cable on a pulley without dynamics: the play of Fig. 5, and the paper's saturation for comparison."""

from __future__ import annotations

import math

import numpy as np

from tendonlab.arguments import positive, samples, within
from tendonlab.errors import ParameterError


def capstan_play(T_in: np.ndarray, *, T_0: float, mu: float, wrap: float) -> np.ndarray:
    """Tension behind a pulley, N, shape of `T_in`: it keeps its value until the ratio leaves exp(±mu theta_w), then
    follows (the play of S4 Fig. 5, as an operator of its own). `T_0`: T_out at the start, N; `wrap`, rad.

    Raises ParameterError for a tension, `mu` or `wrap` below zero or not finite."""
    T_in, last = samples("T_in", T_in), within("T_0", T_0, 0.0, math.inf, "N")
    mu, wrap = within("mu", mu, 0.0, math.inf), within("wrap", wrap, 0.0, math.inf, "rad")
    if np.min(T_in) < 0:
        raise ParameterError(f"T_in = {float(np.min(T_in)):g}: expected at least 0 N; a cable does not push")
    low, high = np.exp(-mu * wrap), np.exp(mu * wrap)
    T_out = np.empty(len(T_in))
    for i, T in enumerate(T_in):
        last = T_out[i] = min(max(last, T * low), T * high)
    return T_out


def saturation(v: np.ndarray, *, v_threshold: float) -> np.ndarray:
    """sat(v), the sign with a linear ramp below `v_threshold`, m/s (S4 eq. 26): the law that LuGre is compared with.
    It gives no friction at rest."""
    return np.clip(np.asarray(v, dtype=float) / positive("v_threshold", v_threshold, "m/s"), -1.0, 1.0)
