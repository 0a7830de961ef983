"""Tables of S2 and expected results of its models: printed values next to values recomputed on the twins."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tendonlab.papers.s2 import energy, equations, rig
from tendonlab.papers.s2.estimate import Estimate
from tendonlab.papers.s2.experiments import bushing_loop, cable_ramps, gear_points
from tendonlab.papers.s2.forces import force_shift, shifted
from tendonlab.papers.s2.identify import (
    effective_coefficients,
    fit_bushing,
    fit_cable,
    fit_gear_friction,
    split_common_friction,
)
from tendonlab.papers.s2.trapezoids import reference
from tendonlab.papers.s2.twin import simulate
from tendonlab.papers.s2.values import BRANCHES, Constants, identified

COLUMNS = ("printed", "computed", "difference", "tolerance", "within")


def fits(of: Constants, *, seed: int = 0) -> dict[str, Estimate]:
    """All identifications of Table II on synthetic logs: "gear", "cable", "bushing 1", "bushing 2"."""
    points, ramps = gear_points(of, seed=seed), cable_ramps(of, seed=seed)
    found = {
        "gear": fit_gear_friction(points["speed"], points["torque_mean"], points["torque_std"]),
        "cable": fit_cable(ramps["elongation"], ramps["rate"], ramps["force"], contiguous=False, seed=seed),
    }
    for cable in (1, 2):
        loop = bushing_loop(of, cable=cable, seed=seed)
        fit = fit_bushing(loop["theta"], loop["velocity"], loop["force"], tension=of.T)
        found[f"bushing {cable}"] = fit
    return found


def differences(of: Constants, found: dict[str, Estimate] | None = None) -> pd.DataFrame:
    """Every number of Tables I and II, what follows from them, and what is expected of fits, energy, ripple and
    force jumps: printed (or expected), computed, difference, tolerance, within.

    `found`: what `fits` gives, made here unless given. Tolerances: 6 % of alpha, 15 % of
    beta, 0.5 % of K, 5 % of c; for the bushings 2.5 half widths of the fit's own 95 % interval."""
    found = fits(of) if found is None else found
    rows = [*_derived(of), *_identified(of, found), *_splits(of), *_dynamics(of)]
    table = pd.DataFrame(rows, columns=["quantity", "printed", "computed", "tolerance"]).set_index("quantity")
    table["difference"] = table["computed"] - table["printed"]
    table["within"] = np.abs(table["difference"]) <= table["tolerance"]
    return table[list(COLUMNS)]


Row = tuple[str, float, float, float]


def _derived(of: Constants) -> list[Row]:
    """Table I and what follows from it, to the digits that are printed."""
    times = of.time_constants()
    turn = of.with_(phi=0.0)
    return [
        ("Table I: l_1 (m)", 0.150, of.l_1, 1e-9),
        ("Table I: l_2 (m)", 0.350, of.l_2, 1e-9),
        ("Table I: N_screw (m/rad)", 0.0007957747154594768, of.N_s, 1e-12),
        ("N_g N_s (m/rad)", 9.947183943243461e-06, of.N, 1e-14),
        ("L/R (ms)", 1.0608, 1e3 * times["L_over_R"], 5e-5),
        ("J/(c + k^2/R) (ms)", 1.031, 1e3 * times["J_over_c_plus_k2_R"], 5e-4),
        ("c/K (s)", 0.1161, times["c_over_K"], 5e-5),
        ("I(0)/J_1", 37.46, float(equations.inertia(turn, 0.0)) / of.J_1, 5e-3),
        ("alpha pi/2 (N m)", 0.12205, 0.5 * np.pi * of.alpha, 5e-6),
        ("alpha beta (N m s/rad)", 1.554e-3, of.alpha * of.beta, 5e-7),
        ("F_r1 - F_r2 at theta = 0 (N)", 22.70, float(equations.holding_difference(turn, 0.0)), 5e-3),
    ]


def _identified(of: Constants, found: dict[str, Estimate]) -> list[Row]:
    """Table II from synthetic logs of a rig that has its values."""
    table = identified()
    shares = {"alpha": 0.06, "beta": 0.15, "K": 0.005, "c": 0.05}
    rows = []
    for group, fit in (("harmonic gear", found["gear"]), ("cable", found["cable"])):
        for name, printed in table[group].items():
            rows.append((f"Table II: {name} ({group})", printed, fit[name], shares[name] * printed))
    for cable in (1, 2):
        fit = found[f"bushing {cable}"]
        for name in BRANCHES:
            printed = table[f"cable {cable} friction"][name]
            rows.append((f"Table II: {name} (cable {cable})", printed, fit[name], 2.5 * fit.half_widths[name]))
    error = found["cable"].validation_error
    assert error is not None
    return [*rows, ("NRMSE of the cable's fit on validation samples", 0.0, error, 0.02)]


def _splits(of: Constants) -> list[Row]:
    """The friction in eq. 11."""
    at = np.array([-0.8, -0.1, 0.1, 0.4, 0.8])
    printed = ((21.9, 29.0, 30.0, 42.1, 57.8), (-69.4, -33.0, -31.6, -36.7, -43.2))
    rows = []
    for cable, values in enumerate(printed, start=1):
        friction = split_common_friction(of.bushings[cable - 1], at, of.T)["friction"]
        for theta, value, computed in zip(at, values, friction.tolist(), strict=True):
            rows.append((f"friction of cable {cable} at {theta:+.1f} rad (N)", value, computed, 0.05))
    one, two = (effective_coefficients(branches) for branches in of.bushings)
    rows.append(("effective coefficient, cable 1, beyond", 0.203, one["beyond"], 5e-4))
    rows.append(("effective coefficient, cable 2, below", 0.268, abs(two["below"]), 5.1e-4))
    return rows


def _dynamics(of: Constants) -> list[Row]:
    """Energy of the free joint, ripple at cruise, shift of the force jump."""
    right, wrong = (energy.energy_drift(energy.free_swing(of, coriolis=c)) for c in ("corrected", "printed"))
    short = reference(end=15.0)
    cruise = short.cruise()
    speed = float(np.max(np.abs(short.velocity)))
    plain, rippled = (
        float(np.std((simulate(of, short, ripple=a)["theta_rate"].to_numpy() - short.velocity)[cruise]) / speed)
        for a in (0.0, 0.1)
    )
    whole = reference()
    real = simulate(of, whole, sense="hold")["F_act_1"].to_numpy()
    ours = rig.system(of).simulate(rig.nut_input(of, whole))["cable_force_1"].to_numpy()
    shifts = force_shift(whole.time, ours, real)["shift"].to_numpy()
    inside = shifted(whole)
    outer, inner = (float(np.sqrt(np.mean((ours - real)[part] ** 2))) for part in (~inside, inside))
    return [
        ("energy drift, eq. 5 corrected (J)", 0.0, right, 1e-8),
        ("energy drift, eq. 5 as printed (J)", 1.17, wrong, 0.01),
        ("first T_shift of cable 1 (s)", 2.0, float(shifts[0]), 0.02),
        ("second T_shift of cable 1 (s)", 2.0, float(shifts[1]), 0.02),
        ("RMS force error outside the windows of T_shift (N)", 0.0, outer, 2.0),
        ("RMS force error inside them, N short of 20", 0.0, min(inner - 20.0, 0.0), 0.0),
        ("ripple of the velocity at cruise (%)", 7.0, 100.0 * rippled, 1.0),
        ("velocity error at cruise without ripple (%)", 0.0, 100.0 * plain, 0.5),
    ]
