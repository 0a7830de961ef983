"""What S4 identifies from tensions, fitted at once by the library (Ceres): both angles were measured, so no motion has
to be simulated, and stiffness, pretension and friction all follow from the tensions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from tendonlab.arguments import positive
from tendonlab.data import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.identification.identify import identify
from tendonlab.identification.result import Identification
from tendonlab.papers.s4.rig import NOISE
from tendonlab.papers.s4.twin import TENSIONS
from tendonlab.simulation.system import System

ANGLES = {"theta2": "driver_angle", "theta1": "joint_angle"}


def fit_tensions(
    read: pd.DataFrame,
    start: System,
    *,
    free: Sequence[str],
    tensions: Sequence[str] = TENSIONS,
    noise: float = NOISE,
    smooth: bool = True,
) -> Identification:
    """Fit the parameters `free` of `start` (`tension_simulator`) to measured `tensions` by least squares, from its
    values and without priors; everything else is held.

    `read`: as `measured` gives it, by time, s; bristles begin relaxed, and where a tension is NaN nothing is compared,
    as while they run in. `noise`: sd of a tension, N. `smooth`: splines near the samples of both angles, whose rates
    the contacts need; False: every sample as it was read, without a rate, which is all that the middle tensions T12 and
    T22 need. So with T22 alone, k and T_p are those of `identify_stiffness` (S4 eq. 37). Angles count as exact, in the
    intervals too: what 17-bit encoders round moves sigma_2 by 6 %, the asymmetry by 2 %. Raises ParameterError for an
    unknown parameter, tension or column."""
    if start.kind != "ccsrm_tensions":
        raise ParameterError(f"start.kind = {start.kind!r}: expected 'ccsrm_tensions', see tension_simulator")
    for of, names, known in (
        ("free", free, list(start.parameters)),
        ("tensions", tensions, list(TENSIONS)),
        ("read", [*ANGLES, *tensions], [str(name) for name in read.columns]),
    ):
        for name in names:
            if name not in known:
                raise ParameterError(f"{of}: {name!r}; {expected_one_of(name, known)}")
    outputs = {name: f"tension_{name[1:]}" for name in tensions}
    return identify(_dataset(read, start, free, outputs, positive("noise", noise, "N"), smooth=smooth), progress=False)


def _dataset(
    read: pd.DataFrame, start: System, free: Sequence[str], outputs: dict[str, str], noise: float, *, smooth: bool
) -> Dataset:
    columns = {**ANGLES, **outputs}
    data = read.rename(columns=columns)[list(columns.values())].rename_axis("t")
    kinds = ((ANGLES, "rad", "input", None), (outputs, "N", "output", noise))
    signals = {
        name: SignalSpec(name=name, column=name, unit=unit, si_unit=unit, role=role, hold=False, noise_sd=sd)
        for names, unit, role, sd in kinds
        for name in names.values()
    }
    return Dataset(
        name="tensions",
        description="Angles and tensions of the rig of S4",
        kind=start.kind,
        axis=start.axis,
        nominal_effects=start.effects,
        parameters={n: NominalParameter(v, sd=math.inf if n in free else 0.0) for n, v in start.parameters.items()},
        controller=None,
        signals=signals,
        experiments=(Experiment(name="read", data=data, holds=dict.fromkeys(ANGLES.values(), not smooth)),),
        path=Path(),
    )
