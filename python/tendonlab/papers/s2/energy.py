"""Energy balance of the free joint, with the corrected and with the printed sign and factor of eq. 5."""

from __future__ import annotations

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp

from tendonlab.arguments import positive, whole
from tendonlab.papers.s2 import equations
from tendonlab.papers.s2.values import Constants


def free_swing(
    of: Constants,
    *,
    theta: float = 0.3,
    theta_rate: float = 0.0,
    duration: float = 3.0,
    coriolis: str = "corrected",
    num_samples: int = 601,
    tolerance: float = 1e-12,
) -> pd.DataFrame:
    """The joint without cables from `theta`, rad; columns theta, theta_rate, energy, J, by time "t", s (S2 eqs 5, 6).

    `coriolis`: "corrected" or "printed"; `tolerance`: relative error of a step. Integrated with Dormand-Prince 8(5,3).
    Raises ParameterError for a duration that is not positive."""
    positive("duration", duration, "s")
    whole("num_samples", num_samples, 2)

    def rates(_: float, state: np.ndarray) -> list[float]:
        x_5 = of.J_1 * state[1]
        return [state[1], float(equations.joint_rate(of, state[0], x_5, 0.0, coriolis=coriolis)) / of.J_1]

    time = np.linspace(0.0, duration, num_samples)
    run = solve_ivp(
        rates, (0.0, duration), [theta, theta_rate], method="DOP853", t_eval=time, rtol=tolerance, atol=1e-14
    )
    energy = equations.joint_energy(of, run.y[0], run.y[1])
    index = pd.Index(time, name="t")
    return pd.DataFrame({"theta": run.y[0], "theta_rate": run.y[1], "energy": energy}, index=index)


def energy_drift(run: pd.DataFrame) -> float:
    """Largest change of the energy from its start, J."""
    energy = run["energy"].to_numpy()
    return float(np.max(np.abs(energy - energy[0])))
