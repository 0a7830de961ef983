"""The library's system "ccsrm" with S4's numbers, and its runs in the paper's notation."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tendonlab.papers.s4.constants import Contact, Joint, Mechanism, contact, design
from tendonlab.papers.s4.drive import Drive
from tendonlab.papers.s4.twin import CONTACTS, TENSIONS
from tendonlab.simulation.catalog import system_info
from tendonlab.simulation.system import System


def simulator(
    mechanism: Mechanism | None = None,
    line: Contact | None = None,
    *,
    joint: Joint | None = None,
    end_stiffness: float | None = None,
) -> System:
    """The library's simulator of `mechanism` (Table II unless given) with contacts `line` (Table III unless given).

    `line.mu_back` adds "contact:asymmetry", `joint` the joint's dry friction with a bristle, `end_stiffness`, N/m,
    "ends:compliance"."""
    m = mechanism or design()
    made = _made("ccsrm", m, line or contact(), inertia=m.J)
    more: dict[str, dict[str, float]] = {}
    if joint is not None and joint.f_c > 0:
        more["joint:coulomb"] = {"coulomb": joint.f_c}
        more["joint:stribeck"] = {"static_excess": joint.f_s - joint.f_c, "stribeck_velocity": joint.v_s}
        more["joint:presliding"] = {"bristle_stiffness": joint.sigma_0, "bristle_damping": joint.sigma_1}
    if end_stiffness is not None:
        more["ends:compliance"] = {"compliance": 1.0 / end_stiffness}
    return made.with_effects(more)


def tension_simulator(mechanism: Mechanism | None = None, line: Contact | None = None) -> System:
    """The same cables and contacts without the joint's dynamics: six tensions of both measured angles (the library's
    system "ccsrm_tensions"). `line.mu_back` adds "contact:asymmetry"."""
    return _made("ccsrm_tensions", mechanism or design(), line or contact())


def _made(kind: str, m: Mechanism, c: Contact, **own: float) -> System:
    back = c.mu_c if c.mu_back is None else c.mu_back
    mean = 0.5 * (c.mu_c + back)
    made = System(
        kind=kind,
        effects=system_info(kind).default_nominal_effects,
        parameters={
            "cable_stiffness": m.k, "pretension": m.T_p, "pulley_radius": m.r, "initial_wrap_angle": m.theta_w0,
            "friction_coefficient": mean, "smallest_level": c.eps,
            "static_friction_coefficient": c.mu_s * mean / c.mu_c, "stribeck_velocity": c.v_s,
            "bristle_stiffness": c.sigma_0, "bristle_damping": c.sigma_1, "contact_viscous": c.sigma_2, **own,
        },
    )  # fmt: skip
    if c.mu_back is None:
        return made
    return made.with_effects({"contact:asymmetry": {"coefficient_asymmetry": 0.5 * (c.mu_c - back) / mean}})


def simulate(of: System, drive: Drive, time: np.ndarray, *, tolerance: float = 1e-7) -> pd.DataFrame:
    """Run a simulator from rest with the given motion of joint 2; indexed by `time`, s.

    Columns theta2, om2, theta1, om1 (rad, rad/s), the tensions T11 … T23 and contact frictions f11 … f22 (N)."""
    log = pd.DataFrame({"driver_angle": drive.angle(time)}, index=pd.Index(time, name="t"))
    run = of.simulate(log, tolerance=tolerance, ports=True)
    assert run.ports is not None  # they were asked for
    found = pd.DataFrame({"theta2": drive.angle(time), "om2": drive.rate(time)}, index=run.outputs.index)
    found["theta1"] = run["joint_angle"]
    found["om1"] = run.ports["joint", "velocity"]
    for name in TENSIONS:
        found[name] = run[f"tension_{name[1:]}"]
    middle = {"1": "T12", "2": "T22"}
    for name in CONTACTS:
        end = f"T{name[0]}{'1' if name[1] == '1' else '3'}"
        found[f"f{name}"] = found[middle[name[0]]] - found[end]
    return found
