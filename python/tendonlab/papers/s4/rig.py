"""The rig of section V as a twin: the paper's identified numbers, its sensors, and one effect at a time (reconstructed:
pretension and input of the hand test are not in the paper)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.papers.s4.constants import RESOLUTION, Joint, Mechanism, contact, design, identified, joint
from tendonlab.papers.s4.drive import Drive, printed_drive
from tendonlab.papers.s4.twin import TENSIONS, CcsrmModel

NOISE = 0.2  # N, sd of a tension sensor [assumed]
SAMPLE_RATE, DURATION, WINDOW = 1000.0, 12.0, 4.0  # Hz, s, s: what comes before the window is start-up


@dataclass(frozen=True, kw_only=True)
class Case:
    """A twin of the rig: pretension, N; friction coefficients by direction; viscous friction kept or not; stiffness of
    the end sections as a multiple of k (None: rigid); friction of joint 1."""

    meaning: str
    mu_plus: float
    mu_minus: float
    T_p: float = 50.0
    k: float = 0.0  # N/m; 0: as identified
    viscous: bool = True
    ends: float | None = None
    joint: Joint | None = None

    def mechanism(self) -> Mechanism:
        """Table II with the identified stiffness and this case's pretension."""
        return replace(design(), k=self.k or identified().k, T_p=self.T_p)

    def model(self) -> CcsrmModel:
        """The twin; mu_s = 1.2 mu_c as in Table III."""
        c = contact()
        ratio = c.mu_s / c.mu_c
        line = replace(
            c, mu_c=self.mu_plus, mu_s=ratio * self.mu_plus, mu_back=self.mu_minus,
            sigma_2=c.sigma_2 if self.viscous else 0.0,
        )  # fmt: skip
        m = self.mechanism()
        return CcsrmModel(
            mechanism=m, contact=line, joint=self.joint, end_stiffness=None if self.ends is None else self.ends * m.k
        )


def cases() -> Mapping[str, Case]:
    """The twins E0 … E4 and what each of them has in addition (S4 section V, reconstructed)."""
    found = identified()
    one = Case(meaning="none", mu_plus=found.mu_plus, mu_minus=found.mu_plus)
    two = Case(meaning="direction-dependent friction coefficient", mu_plus=found.mu_plus, mu_minus=found.mu_minus)
    return {
        "E0": one,
        "E0s": replace(one, meaning="no viscous friction", viscous=False),
        "E1": two,
        "E1s": replace(two, meaning=f"{two.meaning}; no viscous friction", viscous=False),
        "E2": replace(two, meaning="elastic end sections, 5 k", ends=5.0),
        "E2b": replace(two, meaning="elastic end sections, 20 k", ends=20.0),
        "E3": replace(two, meaning="joint friction", joint=joint(f_c=0.05, f_s=0.06)),
        "E4": replace(two, meaning="pretension 56 N", T_p=56.0),
    }


def case(name: str) -> Case:
    """One of `cases`. Raises ParameterError for an unknown name."""
    known = cases()
    if name not in known:
        raise ParameterError(f"case = {name!r}: {expected_one_of(name, known)}")
    return known[name]


def run_rig(of: Case, *, drive: Drive | None = None, duration: float = DURATION, rtol: float = 1e-8) -> pd.DataFrame:
    """What the twin does, without sensors; columns as `CcsrmModel.simulate`, at 1 kHz."""
    time = np.arange(round(duration * SAMPLE_RATE) + 1) / SAMPLE_RATE
    return of.model().simulate(printed_drive() if drive is None else drive, time, rtol=rtol)


def measured(
    run: pd.DataFrame, *, seed: int | np.random.Generator = 0, noise: float = NOISE, jitter: float = 0.0
) -> pd.DataFrame:
    """What the rig's sensors read of a run: both encoders with 17 bit, theta1 and theta2, rad; six tensions, N.

    `noise`, N: sd of a tension sensor; `jitter`, rad: sd of what shakes the encoders before they round."""
    rng = np.random.default_rng(seed)
    read = pd.DataFrame(index=run.index)
    for name in ("theta1", "theta2"):
        shaken = run[name] + (jitter * rng.standard_normal(len(run)) if jitter > 0 else 0.0)
        read[name] = RESOLUTION * np.round(shaken / RESOLUTION)
    for name in TENSIONS:
        read[name] = run[name] + noise * rng.standard_normal(len(run))
    return read
