"""S2: bond-graph model of a cable-driven joint, and friction of a cable in a bushing.

`constants` gives the paper's numbers, `system` the library's simulator with them, `simulate` the independent twin."""

from tendonlab.papers.s2 import diagrams, equations, figures, graphs
from tendonlab.papers.s2.energy import energy_drift, free_swing
from tendonlab.papers.s2.estimate import Estimate
from tendonlab.papers.s2.experiments import bushing_bench, bushing_loop, cable_ramps, gear_points
from tendonlab.papers.s2.forces import covariance_of, feedforward, force_band, force_shift, shifted
from tendonlab.papers.s2.identify import (
    bushing_law,
    effective_coefficients,
    fit_bushing,
    fit_cable,
    fit_gear_friction,
    split_common_friction,
)
from tendonlab.papers.s2.orders import order_spectrum
from tendonlab.papers.s2.printed import differences, fits
from tendonlab.papers.s2.rig import log_of_twin, nut_input, parameters, system, write_dataset
from tendonlab.papers.s2.trapezoids import Reference, reference
from tendonlab.papers.s2.twin import PID, last_sense, measured, simulate
from tendonlab.papers.s2.values import Constants, constants, identified
from tendonlab.papers.s2.voltage import VoltagePID, feedforward_voltage, track

__all__ = [
    "PID",
    "Constants",
    "Estimate",
    "Reference",
    "VoltagePID",
    "bushing_bench",
    "bushing_law",
    "bushing_loop",
    "cable_ramps",
    "constants",
    "covariance_of",
    "diagrams",
    "differences",
    "effective_coefficients",
    "energy_drift",
    "equations",
    "feedforward",
    "feedforward_voltage",
    "figures",
    "fit_bushing",
    "fit_cable",
    "fit_gear_friction",
    "fits",
    "force_band",
    "force_shift",
    "free_swing",
    "gear_points",
    "graphs",
    "identified",
    "last_sense",
    "log_of_twin",
    "measured",
    "nut_input",
    "order_spectrum",
    "parameters",
    "reference",
    "shifted",
    "simulate",
    "split_common_friction",
    "system",
    "track",
    "write_dataset",
]
