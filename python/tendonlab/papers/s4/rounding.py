"""What the rounding of the encoders does to a fit to tensions, and intervals that count it.

Where joint 1 dwells, the contacts take every step of its encoder for slip, which wears their bristles down. Wavelets
take most of that away; a parametric bootstrap measures the bias and the spread that are left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy.stats import t as student

from tendonlab.arguments import positive, whole
from tendonlab.identification.result import Identification
from tendonlab.papers.s4.dataset import JITTER
from tendonlab.papers.s4.drive import Drive
from tendonlab.papers.s4.library import simulate
from tendonlab.papers.s4.rig import NOISE, measured
from tendonlab.papers.s4.tensions import ANGLES, fit_tensions
from tendonlab.papers.s4.twin import TENSIONS
from tendonlab.procedures import wavelet_denoise
from tendonlab.seed import generator
from tendonlab.simulation.catalog import system_info
from tendonlab.simulation.system import System

LEVEL = 6  # of the wavelets: details of up to 64 samples, 64 ms on the rig, less than joint 1 dwells at a reversal
RUN_IN = 0.1  # s, in which the bristles find their state
MEAN = 5  # samples: a tenth of the time that joint 1 takes at a reversal until its contacts slip


@dataclass(frozen=True, kw_only=True)
class Treatment:
    """How a reading becomes a fit from `start`, of the parameters `free`: both angles denoised, the record cut at
    `since`, s, every five samples averaged, and the tensions compared after the bristles have run in."""

    start: System
    free: tuple[str, ...]
    since: float

    def fit(self, read: pd.DataFrame) -> Identification:
        """The fit to a reading, columns as `measured` gives them."""
        seen = read.copy()
        for angle in ANGLES:
            seen[angle] = wavelet_denoise(seen[angle].to_numpy(), level=LEVEL)
        seen = _means(seen[seen.index >= self.since])
        seen.loc[seen.index < self.since + RUN_IN, list(TENSIONS)] = np.nan
        return fit_tensions(seen, self.start, free=self.free, noise=NOISE / np.sqrt(MEAN))


def _means(of: pd.DataFrame) -> pd.DataFrame:
    """Instants and columns, averaged over every MEAN samples; fewer at the end are left out."""
    full = len(of) // MEAN * MEAN
    whole_blocks = of.reset_index().to_numpy()[:full].reshape(-1, MEAN, 1 + of.shape[1])
    time, *columns = whole_blocks.mean(axis=1).T
    return pd.DataFrame(dict(zip(of.columns, columns, strict=True)), index=pd.Index(time, name=of.index.name))


def fit_rounded(
    read: pd.DataFrame,
    start: System,
    *,
    free: Sequence[str],
    drive: Drive,
    inertia: float,
    since: float = 4.0,
    jitter: float = JITTER,
    num_replicates: int = 20,
    seed: int | np.random.Generator = 0,
) -> pd.DataFrame:
    """Fit `free` parameters of `start` (`tension_simulator`) to all six tensions of a reading from rest, and say how
    far the readings of both encoders can be trusted.

    The joint, of `inertia`, kg·m², is simulated at the fitted numbers under the same `drive`; `num_replicates` readings
    of that run, each with its own noise, are treated and fitted in the same way. Their mean distance from the fitted
    numbers is the bias, which is taken off; their scatter gives sd and interval (Student t). `jitter`, rad: sd of what
    shakes the encoders before they round, in the reading as in the replicates; without any, the steps of all runs fall
    alike and the bias hangs on where a dwell lies between two steps, which no replicate knows. Rows by parameter:
    fitted, bias, value, sd, ci95_lower, ci95_upper, unit. Raises ParameterError as `fit_tensions` does."""
    whole("num_replicates", num_replicates, 3)
    treatment, rng = Treatment(start=start, free=tuple(free), since=since), generator(seed)
    fitted = treatment.fit(read)
    joint = System(
        kind="ccsrm",
        effects=tuple(e for e in fitted.system.effects if e in {known.name for known in system_info("ccsrm").effects}),
        parameters={**fitted.system.parameters, "inertia": positive("inertia", inertia, "kg*m^2")},
    )
    run = simulate(joint, drive, read.index.to_numpy(dtype=float))
    readings = (measured(run, seed=rng, jitter=jitter) for _ in range(num_replicates))
    replicates = pd.DataFrame([treatment.fit(reading).values for reading in readings])
    own = fitted.parameters["value"]
    found = pd.DataFrame({"fitted": own, "bias": replicates.mean() - own})
    found["value"] = own - found["bias"]
    found["sd"] = replicates.std(ddof=1) * np.sqrt(1.0 + 1.0 / num_replicates)  # of the fit, and of its bias
    reach = float(student.ppf(0.975, num_replicates - 1)) * found["sd"]
    found["ci95_lower"], found["ci95_upper"] = found["value"] - reach, found["value"] + reach
    return found.assign(unit=fitted.parameters["unit"])
