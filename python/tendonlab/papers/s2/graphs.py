"""The bond graphs of S2: motor (Fig. 3), cable (Fig. 4), joint (Fig. 6) and the whole (Fig. 2).

States carry the paper's names: x_1 flux linkage, x_2 motor momentum, x_4 elongations, x_5 = J_1 theta'.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from tendonlab.mechanics.bondgraph import GY, MTF, TF, BondGraph, C, Element, I, One, R, Se, Sf, Zero
from tendonlab.papers.s2.values import Constants

Parts = tuple[list[Element], list[tuple[str, ...]]]
Friction = Callable[[Any, Any], Any]  # force, N, from the velocity of cable 1 in its bushing, m/s, and theta, rad
Place = tuple[float, float]


def motor_graph(of: Constants) -> BondGraph:
    """Fig. 3: winding, rotor, gear and screw. Inputs: `V`, V, and the forces at the nuts `F_act_1`, `F_act_2`, N."""
    elements, chains = _motor(of)
    ends: list[Element] = [
        Se(name="F_act_1", label=r"$F_{act,1}$"),
        TF(name="reverse", ratio=-1.0, label="−1"),
        Se(name="F_act_2", label=r"$F_{act,2}$"),
    ]
    return BondGraph.of([*elements, *ends], [*chains, ("nut", "F_act_1"), ("nut", "reverse", "F_act_2")])


def cable_graph(of: Constants) -> BondGraph:
    """Fig. 4: a taut cable between nut and joint. Inputs: `v_a`, velocity at the nut, and `v_j`, at the joint, m/s,
    both along the pull. A graph has no unilateral spring: below zero tension it would push."""
    elements, chains = _cable(of, "")
    ends: list[Element] = [Sf(name="v_a", label="$v_a$"), Sf(name="v_j", label="$v_j$")]
    return BondGraph.of([*ends, *elements], [("v_a", "force"), *chains, ("force", "v_j")])


def joint_graph(of: Constants) -> BondGraph:
    """Fig. 6: both links. Inputs: the cable forces on the joint `F_r_1`, `F_r_2`, N. Every inertia but J_1 follows
    theta' and so is in derivative causality."""
    elements, chains = _joint(of)
    ends: list[Element] = [Se(name="F_r_1", label="$F_{r,1}$"), Se(name="F_r_2", label="$F_{r,2}$")]
    return BondGraph.of([*elements, *ends], [*chains, ("F_r_1", "arm_1"), ("F_r_2", "arm_2")], {"theta": "theta_rate"})


def whole_graph(of: Constants, frictions: Sequence[Friction] = ()) -> BondGraph:
    """Fig. 2: motor, cables, bushings and joint. Input: `V`. `frictions`: of the bushings of cable 1 and 2, N, from the
    velocity of cable 1, m/s, and theta, rad; left out where none is given."""
    motor, motor_chains = _motor(of)
    first, first_chains = _cable(of, "_1")
    second, second_chains = _cable(of, "_2")
    joint, joint_chains = _joint(of)
    elements = [*motor, TF(name="reverse", ratio=-1.0, label="−1"), One(name="nut_2"), *first, *second, *joint]
    chains = [*motor_chains, *first_chains, *second_chains, *joint_chains, ("nut", "force_1", "arm_1")]
    chains += [("nut", "reverse", "nut_2", "force_2", "arm_2")]
    if frictions:
        one, two = frictions
        elements.append(R(name="F_a_1", label="$F_{a,1}$", effort=one, of="theta"))
        elements.append(R(name="F_a_2", label="$F_{a,2}$", effort=lambda v, theta: two(-v, theta), of="theta"))
        chains += [("nut", "F_a_1"), ("nut_2", "F_a_2")]
    return BondGraph.of(elements, chains, {"theta": "theta_rate"})


def _motor(of: Constants) -> Parts:
    def gear_friction(omega: Any) -> Any:
        return of.alpha * np.arctan(of.beta * omega)

    elements: list[Element] = [
        Se(name="V"),
        One(name="current", label="$i$"),
        I(name="x_1", label="$L_m$", inertia=of.L_m),
        R(name="R_m", label="$R_m$", effort=of.R_m),
        GY(name="k_m", label="$k_m$", ratio=of.k_m),
        One(name="motor", label=r"$\omega$"),
        I(name="x_2", label="$J_m$", inertia=of.J_m),
        R(name="c_m", label="$c_m$", effort=of.c_m),
        R(name="tau_f", label=r"$\tau_f$", effort=gear_friction),
        TF(name="N_g", label="$N_g$", ratio=of.N_g),
        TF(name="N_s", label="$N_s$", ratio=of.N_s),
        One(name="nut", label=r"$\dot u$"),
    ]
    chains: list[tuple[str, ...]] = [("V", "current", "k_m", "motor", "N_g", "N_s", "nut")]
    chains += [("current", "x_1"), ("current", "R_m"), ("motor", "x_2"), ("motor", "c_m"), ("motor", "tau_f")]
    return elements, chains


def _cable(of: Constants, mark: str) -> Parts:
    elements: list[Element] = [
        Zero(name=f"force{mark}", label="$F_r$" if not mark else f"$F_{{r,{mark[1:]}}}$"),
        One(name=f"stretch{mark}", label=rf"$\dot x_{{4{mark.replace('_', ',')}}}$"),
        C(name=f"x_4{mark}", label="1/K", effort=lambda x: of.T + of.K * x),
        R(name=f"c{mark}", label="c", effort=of.c),
    ]
    ends = [(f"stretch{mark}", f"x_4{mark}"), (f"stretch{mark}", f"c{mark}")]
    return elements, [(f"force{mark}", f"stretch{mark}"), *ends]


def _joint(of: Constants) -> Parts:
    d_1, l_1, d_2, phi = of.d_11, of.l_1, of.d_21, of.phi
    slopes = {  # of the centres of mass by theta, m
        "x1": lambda q: -d_1 * np.sin(q + phi),
        "y1": lambda q: d_1 * np.cos(q + phi),
        "x2": lambda q: -l_1 * np.sin(q + phi) - 2.0 * d_2 * np.sin(2.0 * q + phi),
        "y2": lambda q: l_1 * np.cos(q + phi) + 2.0 * d_2 * np.cos(2.0 * q + phi),
    }
    elements: list[Element] = [
        One(name="theta_rate", label=r"$\dot\theta$"),
        I(name="x_5", label="$J_1$", inertia=of.J_1),
        MTF(name="arm_1", label=r"$1/(r\cos\theta)$", ratio=lambda q: 1.0 / (of.r * np.cos(q)), of="theta"),
        MTF(name="arm_2", label=r"$-1/(r\cos\theta)$", ratio=lambda q: -1.0 / (of.r * np.cos(q)), of="theta"),
        TF(name="twice", label="2", ratio=2.0),
        I(name="J_2", label="$J_2$", inertia=of.J_2),
    ]
    chains: list[tuple[str, ...]] = [("theta_rate", "x_5"), ("theta_rate", "twice", "J_2")]
    chains += [("arm_1", "theta_rate"), ("arm_2", "theta_rate")]
    for name, slope in slopes.items():
        axis, link = name[0], name[1]
        mass = of.m_1 if link == "1" else of.m_2
        elements += [
            MTF(name=f"T_{name}", label=rf"$\partial {axis}_{link}/\partial\theta$", ratio=slope, of="theta"),
            One(name=f"v_{name}", label=rf"$\dot {axis}_{link}$"),
            I(name=f"m_{name}", label=f"$m_{link}$", inertia=mass),
        ]
        chains += [("theta_rate", f"T_{name}", f"v_{name}", f"m_{name}")]
        if axis == "y":
            elements.append(Se(name=f"weight_{link}", label=f"$-m_{link}g$", value=-mass * of.g))
            chains += [(f"weight_{link}", f"v_{name}")]
    return elements, chains


MOTOR_PLACES: dict[str, Place] = {
    "V": (0, 0), "current": (1, 0), "x_1": (1, 1), "R_m": (1, -1), "k_m": (2, 0), "motor": (3, 0), "x_2": (3, 1),
    "c_m": (2.55, -1), "tau_f": (3.45, -1), "N_g": (4, 0), "N_s": (5, 0), "nut": (6, 0),
}  # fmt: skip
CABLE_PLACES: dict[str, Place] = {
    "v_a": (0, 0), "force": (1.2, 0), "v_j": (2.4, 0), "stretch": (1.2, 1), "x_4": (0.4, 1.8), "c": (2.0, 1.8),
}  # fmt: skip
JOINT_PLACES: dict[str, Place] = {
    "theta_rate": (3, 0), "x_5": (3, 1.1), "arm_1": (1.5, 0.8), "arm_2": (1.5, -0.8), "twice": (3, -1.1),
    "J_2": (3, -2.1),
    **{f"{part}_{name}": (x, y) for name, y in (("x1", 2.1), ("y1", 0.75), ("x2", -0.75), ("y2", -2.1))
       for part, x in (("T", 4.7), ("v", 6.2), ("m", 7.4))},
    "weight_1": (6.2, 1.45), "weight_2": (6.2, -1.4),
}  # fmt: skip
WHOLE_PLACES: dict[str, Place] = {
    **MOTOR_PLACES, "reverse": (6, -1.3), "nut_2": (6, -2.4), "F_a_1": (6, 1.1), "F_a_2": (4.9, -2.4),
    "force_1": (7.8, 0), "stretch_1": (7.8, 1), "x_4_1": (7.1, 1.8), "c_1": (8.5, 1.8),
    "force_2": (7.8, -2.4), "stretch_2": (7.8, -3.4), "x_4_2": (7.1, -4.2), "c_2": (8.5, -4.2),
    **{name: (x + 8.2, y - 1.2) for name, (x, y) in JOINT_PLACES.items()}, "arm_1": (9.5, 0), "arm_2": (9.5, -2.4),
}  # fmt: skip
MOTOR_ENDS: dict[str, Place] = {"F_act_1": (7.2, 0), "reverse": (6, -1), "F_act_2": (7.2, -1)}
JOINT_ENDS: dict[str, Place] = {"F_r_1": (0, 0.8), "F_r_2": (0, -0.8)}
