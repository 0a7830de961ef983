"""S4: a joint that cables couple to its neighbour, with friction at every contact of cable and pulley.

Constants and tables, closed forms, the line contact, the twin, the rig's experiments and their identification, in the
paper's notation; the simulator is the library's system "ccsrm"."""

from tendonlab.papers.s4.constants import (
    ENCODER_BITS,
    ERROR_ON_THE_RIG,
    RESOLUTION,
    Contact,
    Identified,
    Joint,
    Mechanism,
    contact,
    design,
    identified,
    joint,
)
from tendonlab.papers.s4.dataset import JITTER, Nominal, nominal, softer, write_rig
from tendonlab.papers.s4.drive import Drive, printed_drive
from tendonlab.papers.s4.dynamic import identify_dynamic
from tendonlab.papers.s4.identification import (
    friction_coefficient,
    identify_friction,
    identify_friction_and_viscosity,
    identify_stiffness,
    pointwise_stiffness,
)
from tendonlab.papers.s4.library import simulate, simulator, tension_simulator
from tendonlab.papers.s4.line_contact import LineContactLuGre
from tendonlab.papers.s4.metrics import dwell, error_levels, loop_width, nrmse, spread, synchronous_error
from tendonlab.papers.s4.play import capstan_play, saturation
from tendonlab.papers.s4.rig import Case, case, cases, measured, run_rig
from tendonlab.papers.s4.rounding import fit_rounded
from tendonlab.papers.s4.statics import (
    Tensions,
    WrapAngles,
    backlash,
    cable_stiffness,
    capstan_ratio,
    equilibrium_error,
    frictionless_stiffness,
    joint_torque,
    series_stiffness,
    static_tensions,
    stiffness,
    stretch,
    wrap_angles,
)
from tendonlab.papers.s4.tensions import fit_tensions
from tendonlab.papers.s4.twin import TENSIONS, CcsrmModel

__all__ = [
    "ENCODER_BITS",
    "ERROR_ON_THE_RIG",
    "JITTER",
    "RESOLUTION",
    "TENSIONS",
    "Case",
    "CcsrmModel",
    "Contact",
    "Drive",
    "Identified",
    "Joint",
    "LineContactLuGre",
    "Mechanism",
    "Nominal",
    "Tensions",
    "WrapAngles",
    "backlash",
    "cable_stiffness",
    "capstan_play",
    "capstan_ratio",
    "case",
    "cases",
    "contact",
    "design",
    "dwell",
    "equilibrium_error",
    "error_levels",
    "fit_rounded",
    "fit_tensions",
    "friction_coefficient",
    "frictionless_stiffness",
    "identified",
    "identify_dynamic",
    "identify_friction",
    "identify_friction_and_viscosity",
    "identify_stiffness",
    "joint",
    "joint_torque",
    "loop_width",
    "measured",
    "nominal",
    "nrmse",
    "pointwise_stiffness",
    "printed_drive",
    "run_rig",
    "saturation",
    "series_stiffness",
    "simulate",
    "simulator",
    "softer",
    "spread",
    "static_tensions",
    "stiffness",
    "stretch",
    "synchronous_error",
    "tension_simulator",
    "wrap_angles",
    "write_rig",
]
