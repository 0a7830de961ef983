"""Made-up diagnoses, one for each verdict: a swinging joint whose simulator lacks friction at low speed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from tendonlab.report.diagnosis import Diagnosis, EffectFinding, Overlay, SideTable, WhereMap

WHERE = {
    "signals": [{"signal": "joint_angle", "share": 0.8}, {"signal": "motor_angle", "share": 0.2}],
    "elements": [
        {"element": "joint", "probability": 0.93},
        {"element": "contact", "probability": 0.05},
        {"element": "sensor.joint_angle", "probability": 0.02},
    ],
    "regimes": [
        {"coordinate": "joint_velocity", "range": [-0.05, 0.05], "share": 0.7, "p_value": 1e-6},
        {"coordinate": "time", "range": [8.0, 12.0], "share": 0.31, "p_value": np.float64(0.4)},
    ],
}


def overlay(signals: dict[str, float]) -> Overlay:
    random = np.random.default_rng(3)
    time = np.arange(0.0, 12.0, 0.01)
    measured, nominal, refitted, with_effect = {}, {}, {}, {}
    for number, (name, floor) in enumerate(signals.items()):
        scale = 30.0 * floor
        truth = 30 * scale * np.sin(1.3 * time + 0.4 * np.sin(0.7 * time) + number)
        stuck = np.exp(-((np.cos(1.3 * time + number) / 0.25) ** 2)) * np.sign(np.sin(1.3 * time + number))
        measured[name] = truth + floor * random.normal(size=time.size)
        measured[name][200:215] = np.nan
        nominal[name] = truth - 2.0 * scale * stuck + 0.05 * truth
        refitted[name] = truth - 1.1 * scale * stuck
        with_effect[name] = truth - 0.04 * scale * stuck
    return Overlay(
        name="swing-7",
        time=time,
        measured=measured,
        nominal=nominal,
        refitted=refitted,
        with_effect=with_effect,
        floor=signals,
    )


def where_map() -> WhereMap:
    x, y = np.linspace(-1.2, 1.2, 25), np.linspace(-1.6, 1.6, 13)
    speed, angle = np.meshgrid((x[1:] + x[:-1]) / 2, (y[1:] + y[:-1]) / 2)
    refitted = 1.0 + 14.0 * np.exp(-((speed / 0.18) ** 2)) * (1 + 0.3 * np.sin(3 * angle))
    empty = (speed / 1.1) ** 2 + (angle / 1.5) ** 2 > 1
    with_effect = 1.0 + 0.08 * refitted
    refitted[empty] = with_effect[empty] = np.nan
    return WhereMap(
        element="joint",
        place="joint",
        x="joint velocity",
        x_unit="rad/s",
        x_edges=x,
        y="joint position",
        y_unit="rad",
        y_edges=y,
        refitted=refitted,
        with_effect=with_effect,
    )


def findings() -> tuple[EffectFinding, ...]:
    stribeck = {
        "joint_static_excess": {"value": 0.1234, "ci95": [0.113, 0.134], "unit": "N*m"},
        "joint_stribeck_velocity": {"value": 0.0502, "ci95": [0.041, 0.061], "unit": "rad/s"},
    }
    bristle = {"joint_bristle_stiffness": {"value": 310.0, "ci95": [190.0, 520.0], "unit": "N*m/rad"}}
    gain = {"mean": 812.0, "se": 90.0}
    return (
        EffectFinding(
            effect="stribeck",
            element="joint",
            probability=0.93,
            parameters=stribeck,
            held_out_gain=gain,
            shrinkage={"value": 0.91, "ci95": [0.88, 0.94]},
            extra={"evidence": 795.2},
        ),
        EffectFinding(
            effect="presliding",
            element="joint",
            probability=0.21,
            parameters=bristle,
            held_out_gain={"mean": 640.0, "se": 85.0},
            shrinkage={"value": 0.78, "ci95": [0.7, 0.83]},
        ),
        EffectFinding(
            effect="load_dependence",
            element="joint",
            probability=0.04,
            held_out_gain={"mean": 31.0, "se": 22.0},
            parameters={"joint_load_dependence": {"value": 0.02, "ci95": [-0.01, 0.05], "unit": "1"}},
            shrinkage={"value": 0.06, "ci95": [-0.02, 0.11]},
        ),
        EffectFinding(
            effect="delay",
            element="sensor.joint_angle",
            probability=0.002,
            held_out_gain={"mean": -2.0, "se": 3.0},
            parameters={"sensor.joint_angle_delay": {"value": 1.2e-4, "ci95": None, "unit": "s"}},
        ),
    )


def probabilities(*values: float) -> dict[str, float]:
    verdicts = ("data_fault", "no_gap", "parameters_only", "effect", "unknown_effect")
    return dict(zip(verdicts, values, strict=True))


def effect() -> Diagnosis:
    return Diagnosis(
        dataset="rig-42",
        system="two_inertia",
        seed=0,
        seconds=12.34,
        verdict="effect",
        verdict_probability={
            "data_fault": 0.0,
            "no_gap": 0.0,
            "parameters_only": 0.01,
            "effect": 0.95,
            "unknown_effect": 0.04,
        },
        replay={"kind": "injection", "kp": 0.8, "kd": 0.01},
        gap={
            "motor_angle": {"noise_floor": 4e-4, "nominal": 0.021, "refitted": 0.0092, "with_effect": 4.9e-4},
            "joint_angle": {"noise_floor": 1e-3, "nominal": 0.031, "refitted": 0.022, "with_effect": 0.0013},
        },
        where=WHERE,
        effects=findings(),
        sets=(
            {"effects": ["joint:stribeck"], "probability": 0.93},
            {"effects": ["joint:presliding", "joint:stribeck"], "probability": 0.04},
        ),
        selected=("joint:stribeck",),
        explained=0.97,
        indistinguishable=(("joint:stribeck", "joint:presliding"),),
        invisible=("sensor.joint_angle:delay", "cable:slack"),
        shrinkage={
            "from_nominal": {"value": 0.96, "ci95": [0.94, 0.975]},
            "from_refitted": {"value": 0.91, "ci95": [0.88, 0.94]},
        },
        next_experiments=(
            {
                "description": "slow joint reversals at 0.01–0.2 rad/s",
                "separates": ["joint:stribeck", "joint:presliding"],
                "expected_gain": 35.0,
            },
        ),
        warnings=("no repeats: the floor is estimated from the high-frequency part of the residuals",),
        units={"joint_angle": "rad", "motor_angle": "rad", "motor_torque": "N*m"},
        overlays=(overlay({"motor_angle": 4e-4, "joint_angle": 1e-3}),),
        where_map=(where_map(),),
        held_out=pd.DataFrame(
            {"nominal": [31.0, 26.4], "refitted": [19.2, 22.7], "with_effect": [1.6, 2.1]},
            index=pd.Index(["swing-7", "sweep-2"], name="experiment"),
        ),
        table=SideTable(
            title="Inverse dynamics at 60 Hz",
            note="Torque predicted from measured motion.",
            frame=pd.DataFrame({"model": ["nominal", "with effect"], "RMS torque (N·m)": [0.41, float("nan")]}),
        ),
        split={"train": ("sweep-1", "swing-1", "swing-2"), "test": ("swing-7", "sweep-2")},
        details={"run_to_run_scale": 0.008, "ar_order": 6, "bootstrap": {"resamples": 400, "over": "experiments"}},
    )


def no_gap() -> Diagnosis:
    nothing = {"from_nominal": None, "from_refitted": None}
    return replace(
        effect(),
        verdict="no_gap",
        effects=(),
        sets=(),
        selected=(),
        explained=None,
        shrinkage=nothing,
        verdict_probability={
            "data_fault": 0.0,
            "no_gap": 0.97,
            "parameters_only": 0.02,
            "effect": 0.005,
            "unknown_effect": 0.005,
        },
        gap={"joint_angle": {"noise_floor": 1e-3, "nominal": 1.02e-3, "refitted": 1.01e-3, "with_effect": 1.01e-3}},
        where={"signals": [], "elements": [], "regimes": []},
        where_map=(),
        overlays=(),
        held_out=pd.DataFrame(),
        indistinguishable=(),
        invisible=(),
        next_experiments=(),
        warnings=(),
        table=None,
        split={},
        details={},
        replay={"kind": "controller"},
        calibrated=True,
    )


def parameters_only() -> Diagnosis:
    shrinkage = {"from_nominal": {"value": 0.94, "ci95": [0.91, 0.96]}, "from_refitted": None}
    return replace(
        effect(),
        verdict="parameters_only",
        selected=(),
        explained=0.0,
        shrinkage=shrinkage,
        indistinguishable=(),
        verdict_probability={
            "data_fault": 0.0,
            "no_gap": 0.0,
            "parameters_only": 0.9,
            "effect": 0.06,
            "unknown_effect": 0.04,
        },
        overlays=(overlay({"joint_angle": 1e-3}),),
    )


def unknown_effect() -> Diagnosis:
    selected = ("joint:presliding", "joint:load_dependence")
    found = effect().effects
    return replace(
        effect(),
        verdict="unknown_effect",
        selected=selected,
        effects=tuple(replace(finding, probability=0.9) if finding.name in selected else finding for finding in found),
        explained=0.71,
        verdict_probability={
            "data_fault": 0.0,
            "no_gap": 0.0,
            "parameters_only": 0.0,
            "effect": 0.12,
            "unknown_effect": 0.88,
        },
        shrinkage={
            "from_nominal": {"value": 0.6, "ci95": [-0.05, 0.7]},
            "from_refitted": {"value": 0.46, "ci95": [0.4, 0.5]},
        },
    )


def data_fault() -> Diagnosis:
    sign = {
        "problem": "sign",
        "signal": "motor_torque",
        "experiment": None,
        "detail": "all inertial and gravity torques come out negative: −1.03 of what is stated",
        "blocks": True,
    }
    return replace(
        no_gap(),
        verdict="data_fault",
        data=(sign,),
        verdict_probability=probabilities(1.0, 0.0, 0.0, 0.0, 0.0),
        warnings=("check the wiring",),
        calibrated=False,
    )


MADE_UP = {made.__name__: made for made in (effect, no_gap, parameters_only, unknown_effect, data_fault)}


@pytest.fixture(params=list(MADE_UP))
def diagnosis(request: pytest.FixtureRequest) -> Diagnosis:
    """One diagnosis of each verdict."""
    return MADE_UP[request.param]()


@pytest.fixture
def with_effect() -> Diagnosis:
    """The diagnosis that names an effect."""
    return effect()


@pytest.fixture
def undrawn() -> Diagnosis:
    """The diagnosis that names an effect, without the figures that take long to draw: for tests that read words."""
    return replace(effect(), overlays=(), where_map=())
