"""Tables of S2 and expected results of its models: printed values next to values recomputed on the twins."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from tendonlab.papers.compared import DERIVED, PAPER, RECONSTRUCTED, TWIN, Number, compared
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
from tendonlab.papers.tables import table


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
    force jumps, one row each, as `compared` gives them.

    `found`: what `fits` gives, made here unless given. Tolerances: 6 % of alpha, 15 % of
    beta, 0.5 % of K, 5 % of c; for the bushings 2.5 half widths of the fit's own 95 % interval."""
    found = fits(of) if found is None else found
    return compared([*_table_1(of), *_derived(of), *_identified(of, found), *_splits(of), *_dynamics(of)])


def _table_1(of: Constants) -> Iterator[Number]:
    """As printed, in the printed units, against the constants that everything here is computed with, SI."""
    in_printed_unit = {
        "L_m": 1e3, "R_m": 1.0, "c_m": 1e3, "J_m": 1e7, "k_m": 1e3, "m_1": 1.0, "J_1": 1.0, "m_2": 1.0, "J_2": 1.0,
        "d_11": 1e3, "d_12": 1e3, "d_21": 1e3, "d_22": 1e3, "r": 1e3,
    }  # fmt: skip
    own = {**vars(of), "d_12": of.l_1 - of.d_11, "d_22": of.l_2 - of.d_21}
    own = {name: scale * own[name] for name, scale in in_printed_unit.items()}
    own |= {"N_gear": 1.0 / of.N_g, "N_screw": 1e3 * of.p}
    rows = table("S2_table1_parameters").dropna(subset="value_as_printed")
    for symbol, text, unit in rows[["symbol", "value_as_printed", "unit_as_printed"]].itertuples(index=False):
        printed = float(str(text).removeprefix("1:"))
        yield Number(f"Table I: {symbol}", str(unit), PAPER, printed, own[symbol], 1e-9 * printed)


def _derived(of: Constants) -> Iterator[Number]:
    """What follows from Table I, to the digits that were expected."""
    times = of.time_constants()
    turn = of.with_(phi=0.0)
    inertias = float(equations.inertia(turn, 0.0)) / of.J_1
    yield Number("l_1", "m", DERIVED, 0.150, of.l_1, 1e-9)
    yield Number("l_2", "m", DERIVED, 0.350, of.l_2, 1e-9)
    yield Number("N_g N_s", "m/rad", DERIVED, 9.947183943243461e-06, of.N, 1e-14)
    yield Number("L/R", "ms", DERIVED, 1.0608, 1e3 * times["L_over_R"], 5e-5)
    yield Number("J/(c + k^2/R)", "ms", DERIVED, 1.031, 1e3 * times["J_over_c_plus_k2_R"], 5e-4)
    yield Number("c/K", "s", DERIVED, 0.1161, times["c_over_K"], 5e-5)
    yield Number("I(0)/J_1", "1", DERIVED, 37.46, inertias, 5e-3)
    yield Number("alpha pi/2", "N·m", DERIVED, 0.12205, 0.5 * np.pi * of.alpha, 5e-6)
    yield Number("alpha beta", "N·m·s/rad", DERIVED, 1.554e-3, of.alpha * of.beta, 5e-7)
    holding = float(equations.holding_difference(turn, 0.0))
    yield Number("F_r1 - F_r2 at theta = 0, level base", "N", RECONSTRUCTED, 22.70, holding, 5e-3)


def _identified(of: Constants, found: dict[str, Estimate]) -> Iterator[Number]:
    """Table II from synthetic logs of a rig that has its values."""
    shares = {"alpha": 0.06, "beta": 0.15, "K": 0.005, "c": 0.05}
    rows = table("S2_table2_identified")
    units = dict(zip(rows["symbol"].str.replace("_", ""), rows["unit_SI"], strict=True))
    values = identified()
    for group, fit in (("harmonic gear", found["gear"]), ("cable", found["cable"])):
        for name, printed in values[group].items():
            yield Number(f"Table II: {name} ({group})", units[name], TWIN, printed, fit[name], shares[name] * printed)
    for cable in (1, 2):
        fit = found[f"bushing {cable}"]
        for name in BRANCHES:
            printed, reach = values[f"cable {cable} friction"][name], 2.5 * fit.half_widths[name]
            yield Number(f"Table II: {name} (cable {cable})", units[name], TWIN, printed, fit[name], reach)
    error = found["cable"].validation_error
    assert error is not None
    yield Number("NRMSE of the cable's fit on validation samples", "1", TWIN, 0.0, error, 0.02)


def _splits(of: Constants) -> Iterator[Number]:
    """The friction in eq. 11, at T = 200 N, which is reconstructed."""
    at = np.array([-0.8, -0.1, 0.1, 0.4, 0.8])
    expected = ((21.9, 29.0, 30.0, 42.1, 57.8), (-69.4, -33.0, -31.6, -36.7, -43.2))
    for cable, values in enumerate(expected, start=1):
        friction = split_common_friction(of.bushings[cable - 1], at, of.T)["friction"]
        for theta, value, computed in zip(at, values, friction.tolist(), strict=True):
            name = f"friction of cable {cable} at {theta:+.1f} rad"
            yield Number(name, "N", RECONSTRUCTED, value, computed, 0.05)
    one, two = (effective_coefficients(branches) for branches in of.bushings)
    yield Number("effective coefficient, cable 1, beyond", "1", DERIVED, 0.203, one["beyond"], 5e-4)
    yield Number("effective coefficient, cable 2, below", "1", DERIVED, 0.268, abs(two["below"]), 5.1e-4)


def _dynamics(of: Constants) -> Iterator[Number]:
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
    yield Number("energy drift, eq. 5 corrected", "J", RECONSTRUCTED, 0.0, right, 1e-8)
    yield Number("energy drift, eq. 5 as printed", "J", RECONSTRUCTED, 1.17, wrong, 0.01)
    for which, shift in zip(("first", "second"), shifts, strict=False):
        yield Number(f"{which} T_shift of cable 1", "s", TWIN, 2.0, float(shift), 0.02)
    yield Number("RMS force error outside the windows of T_shift", "N", TWIN, 0.0, outer, 2.0)
    yield Number("RMS force error inside them", "N", TWIN, 20.0, inner, 0.0, bound=True)
    yield Number("ripple of the velocity at cruise", "%", TWIN, 7.0, 100.0 * rippled, 1.0)
    yield Number("velocity error at cruise without ripple", "%", TWIN, 0.0, 100.0 * plain, 0.5)
