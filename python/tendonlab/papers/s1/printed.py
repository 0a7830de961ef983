"""Facts that S1 states and results of a separate computation of its equations, next to results of this library."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tendonlab.mechanics.tendons import back_driven_efficiency
from tendonlab.papers.compared import PAPER, RECONSTRUCTED, Number, compared
from tendonlab.papers.s1.bearing import RPM, BallBearing
from tendonlab.papers.s1.device import example_device
from tendonlab.papers.s1.experiments import compensated, effect_sizes, strategies
from tendonlab.papers.s1.identification import Form, residual_error
from tendonlab.papers.tables import table

EXAMPLE_BEARING = BallBearing(f0=2.0, viscosity=220.0, mean_diameter=33.5)  # [reconstructed]
EXAMPLE_TORQUE = np.array([4.0, -3.0, 1.5, 2.0])  # N·m [reconstructed]
EXAMPLE_VELOCITY = np.array([0.4, 0.3, -0.5, 0.6])  # rad/s [reconstructed]


def differences() -> pd.DataFrame:
    """One row per number, as `compared` gives them. The first rows are stated in the paper, the last of them as a bound
    ("more than"); the others come from a separate computation on the reconstructed device, since the paper prints no
    data of its own."""
    computed = {**_stated(), **_statics(), **_identified(), **_compensated()}
    rows: list[Row] = [
        ("degrees of freedom", "1", float(_fact("degrees of freedom of the L-EXOS")), 0.0, PAPER),
        ("joints with a reducer", "1", len(_fact("joints with an epicycloidal reducer").split(";")), 0.0, PAPER),
        ("exponent of the bearing's speed law", "1", float(_fact("exponent of the bearing speed law")), 1e-9, PAPER),
        (BOUND, "1", float(_fact("reduction of friction effects by compensation")) / 100, 0.0, PAPER),
    ]
    reference = table("S1_reference_values")
    rows += [
        (str(name), str(unit).replace("*", "·"), float(value), float(tolerance), RECONSTRUCTED)
        for name, value, unit, tolerance in reference[["quantity", "value", "unit", "tolerance"]].itertuples(
            index=False
        )
    ]
    return compared(
        Number(name, unit, status, expected, computed[name], tolerance, bound=name == BOUND)
        for name, unit, expected, tolerance, status in rows
    )


def _fact(quantity: str) -> str:
    facts = table("S1_text_facts")
    return str(facts.loc[facts["quantity"] == quantity, "value"].iloc[0])


Row = tuple[str, str, float, float, str]  # quantity, unit, expected, tolerance, status
BOUND = "reduction by compensation, more than"


def _stated() -> dict[str, float]:
    speeds = np.array([100.0, 800.0]) * RPM
    slow, fast = EXAMPLE_BEARING.speed_torque(speeds)
    return {
        "degrees of freedom": example_device().num_joints,
        "joints with a reducer": sum(reducer is not None for reducer in example_device().reducers),
        "exponent of the bearing's speed law": float(np.log(fast / slow) / np.log(8.0)),
        "efficiency driven back at 0.9": float(back_driven_efficiency(0.9)),
        "bearing torque at 50 rpm": float(EXAMPLE_BEARING.speed_torque(50.0 * RPM)),
    }


def _statics() -> dict[str, float]:
    device = example_device()
    found = device.statics.inverse(EXAMPLE_TORQUE, EXAMPLE_VELOCITY)
    motor_velocity = device.kinematics.joint_to_motor(EXAMPLE_VELOCITY)
    lost = float(found.torque @ motor_velocity - EXAMPLE_TORQUE @ EXAMPLE_VELOCITY)
    sizes = effect_sizes((5.0,))["gravity x 5"]
    return {
        **{f"motor torque {i + 1}, all losses and reducers": float(c) for i, c in enumerate(found.torque)},
        "power lost, all losses and reducers": lost,
        "tension loss at motor 1, gravity x 5": float(sizes["tension"]),
        "reducers at motor 1, gravity x 5": float(sizes["reducer"]),
    }


def _identified() -> dict[str, float]:
    device, found = example_device(reducers=False), strategies()["constant"]
    named: dict[str, Form] = {"exact": "exact", "first order": "first_order", "as printed": "printed"}
    return {
        **{f"strategy {s}, constant friction at joint 1": float(found[s, 1]) for s in ("S1", "S2")},
        **{
            f"residual of S1 at joint 1, {words}": residual_error(device, 1, strategy="S1", speed=6.0, form=form)
            for words, form in named.items()
        },
    }


def _compensated() -> dict[str, float]:
    less, more = compensated(0.75), compensated(1.2)
    reduction = less.table["reduction"]
    return {
        BOUND: float(reduction[1]),
        **{f"reduction at joint {joint}": float(value) for joint, value in reduction.items()},
        "least power of the user, 75 % of the losses": float(less.power.min()),
        "least power of the user, 120 % of the losses": float(more.power.min()),
        "share of the time that the device drives, 120 %": more.active_share,
        "RMS at joint 1, 120 % of the losses": float(more.table["compensated"][1]),
    }
