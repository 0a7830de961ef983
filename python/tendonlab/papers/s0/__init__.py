"""S0: friction of a capstan–pulley cable transmission under external load, in the paper's notation.

`bench` has the rig, `bearings` the reactions and the relative load (9), `drive` the drive (7, 8), its stiffness and
the dynamic LuGre model (2), `models` the static LuGre curve (3) and the load-and-ratio model (11), `fits` their fits,
`twin` and `runs` the reconstructed bench, `maps` features of friction maps, `experiments` the twin as a dataset,
`evidence` bounds on the preload, `figures` and `drawings` the figures, `comparison` printed next to computed
numbers."""

from tendonlab.papers.s0.bearings import (
    Reactions,
    cable_pull,
    capstan_reactions,
    pulley_reactions,
    reactions,
    relative_load,
)
from tendonlab.papers.s0.bench import LOADS, TRANSMISSIONS, Configuration, configuration, configurations, loaded
from tendonlab.papers.s0.comparison import differences
from tendonlab.papers.s0.drive import dynamic_lugre, motor_torque, torsional_stiffness, viscous_factor
from tendonlab.papers.s0.evidence import bearing_coefficient, largest_preload, peaks_and_loads
from tendonlab.papers.s0.experiments import load_dataset, lugre_system, proposed_system
from tendonlab.papers.s0.fits import Fit, fit_decay, fit_on_twin, fit_proposed, fit_static_lugre
from tendonlab.papers.s0.maps import absolute_error, features, peak_errors, printed_peaks, twin_map
from tendonlab.papers.s0.models import Decaying, Lugre, Proposed, printed_lugre, reconstructed
from tendonlab.papers.s0.runs import bench_map, point_of, schedule, simulate_run, torque_of

__all__ = [
    "LOADS",
    "TRANSMISSIONS",
    "Configuration",
    "Decaying",
    "Fit",
    "Lugre",
    "Proposed",
    "Reactions",
    "absolute_error",
    "bearing_coefficient",
    "bench_map",
    "cable_pull",
    "capstan_reactions",
    "configuration",
    "configurations",
    "differences",
    "dynamic_lugre",
    "features",
    "fit_decay",
    "fit_on_twin",
    "fit_proposed",
    "fit_static_lugre",
    "largest_preload",
    "load_dataset",
    "loaded",
    "lugre_system",
    "motor_torque",
    "peak_errors",
    "peaks_and_loads",
    "point_of",
    "printed_lugre",
    "printed_peaks",
    "proposed_system",
    "pulley_reactions",
    "reactions",
    "reconstructed",
    "relative_load",
    "schedule",
    "simulate_run",
    "torque_of",
    "torsional_stiffness",
    "twin_map",
    "viscous_factor",
]
