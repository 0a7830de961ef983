"""What a rig is described by: experiments, signals, nominal parameters and the controller, as plain values."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.simulation.equality import EqualByFields

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class NominalParameter:
    """A simulator's value, SI; `sd` None: the library's default prior, 0: known exactly and never fitted, inf: nothing
    is known beforehand."""

    value: float
    sd: float | None = None
    lower: float = -math.inf
    upper: float = math.inf


@dataclass(frozen=True)
class Controller:
    """How the rig closed its loop: "pd", u = kp (reference - y) + kd d/dt (reference - y), or "cascade",
    u = kd (kp (reference - y) - dy/dt); y is the signal `measured`. |u| <= `limit`; `disturbance` is added after it."""

    kind: str
    kp: float
    kd: float
    measured: str
    reference: str
    limit: float = math.inf
    derivative_on: str = "error"
    sample_time: float = 0.0
    disturbance: str | None = None


@dataclass(frozen=True)
class SignalSpec:
    """A signal as declared: read from `column`, written there in `unit`, kept here in `si_unit`. `noise_sd` and
    `resolution` are in `si_unit`. `role`: "input", "output", "reference", "disturbance" or "covariate". `hold`: whether
    each value stays until the next sample; `hold_stated`: the user says so, it is no default."""

    name: str
    column: str
    unit: str
    role: str
    hold: bool
    noise_sd: float | None = None
    resolution: float | None = None
    si_unit: str = "1"
    hold_stated: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class Experiment(EqualByFields):
    """One record. `data` is indexed by time "t", s, with one float column per signal, SI; outputs may hold NaN.

    `conditions`: parameters fixed there, other names are covariates; `add`: known additions to parameters; `initial`:
    known initial values; `start`: when it began in the session, s; `repeat`: the label it shares with its repeats;
    `holds`: whether a signal is held between its samples; `averaged`: whether each sample of an input is its mean until
    the next one; `num_repeated`: samples of the log that were left out because they repeat the time stamp before."""

    name: str
    data: pd.DataFrame = field(repr=False)
    split: str = "train"
    repeat: str | None = None
    start: float | None = None
    conditions: dict[str, float] = field(default_factory=dict)
    add: dict[str, float] = field(default_factory=dict)
    initial: dict[str, float] = field(default_factory=dict)
    holds: dict[str, bool] = field(default_factory=dict, repr=False)
    averaged: bool = field(default=False, repr=False)
    num_repeated: int = field(default=0, repr=False)

    @property
    def time(self) -> np.ndarray:
        """Time of each sample, s, shape (n,)."""
        return self.data.index.to_numpy(dtype=float)

    @property
    def duration(self) -> float:
        """From the first sample to the last, s."""
        return float(self.time[-1] - self.time[0]) if len(self.data) else 0.0

    def __repr__(self) -> str:
        signals = ", ".join(map(str, self.data.columns))
        size = f"{len(self.data)} samples, {self.duration:g} s"
        return f"Experiment({self.name!r}, {self.split}: {signals}; {size})"
