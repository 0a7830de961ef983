"""Bad input to procedures and to the routing is refused by name."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.mechanics.tendons import BranchLosses, Reducer, TendonTransmission, back_driven_efficiency
from tendonlab.procedures import (
    LoadCell,
    MapPoint,
    MarkerSpline,
    Shape,
    friction_map,
    global_search,
    lowpass,
    map_point,
    reactive_torque,
    sort_markers,
    wrap_angle_uncertainty,
)

U = np.linspace(0.0, 1.5, 8)
MARKERS = np.column_stack([np.sin(U), np.cos(U)])
ROW = np.linspace(0.0, 1.0, 50)
SPLINE = MarkerSpline(MARKERS)


def changing(broken: bool = False) -> Callable[[np.ndarray], np.ndarray]:
    """A residual whose length changes after some calls; `broken`: after it was not finite once."""
    calls = 0

    def residual(values: np.ndarray) -> np.ndarray:
        nonlocal calls
        calls += 1
        row = values - np.array([0.3, 0.7])
        if broken and calls == 3:
            return row * np.nan
        return row if calls < 4 else np.append(row, 1.0)

    return residual


PROCEDURES: dict[str, tuple[str, Callable[[], Any]]] = {
    "one resample": ("num_resamples = 1", lambda: wrap_angle_uncertainty(SPLINE, marker_sd=1e-4, num_resamples=1)),
    "proximal NaN": (r"proximal\[0\] = nan", lambda: sort_markers(MARKERS, proximal=np.array([np.nan, 0.0]))),
    "proximal of space": ("proximal = ", lambda: sort_markers(MARKERS, proximal=np.zeros(3))),
    "proximal of rows": ("proximal has shape", lambda: sort_markers(MARKERS, proximal=MARKERS)),
    "shape without end": ("arc_length to inf", lambda: Shape(np.array([0.0, np.inf]), np.array([0.0, 1.0]))),
    "turning without end": ("turning to inf", lambda: Shape(np.array([0.0, 1.0]), np.array([0.0, np.inf]))),
    "half a sample": ("num_samples = 10.5", lambda: MarkerSpline(MARKERS, num_samples=10.5)),  # type: ignore[arg-type]
    "NaN samples": ("num_samples = nan", lambda: MarkerSpline(MARKERS, num_samples=np.nan)),  # type: ignore[arg-type]
    "low cutoff": ("cutoff = 1e-20", lambda: lowpass(ROW, cutoff=1e-20, sample_rate=1e3)),
    "cutoff by which it divides by 0": ("cutoff = 1e-06", lambda: lowpass(ROW, cutoff=1e-6, sample_rate=1e3)),
    "least cutoff": ("cutoff = 5e-324", lambda: lowpass(ROW, cutoff=5e-324, sample_rate=1e3)),
    "low cutoff, once": ("cutoff = 1e-20", lambda: lowpass(ROW, cutoff=1e-20, sample_rate=1e3, zero_phase=False)),
    "segment": ("segment = 3", lambda: map_point(ROW, ROW, ROW, segment=3)),  # type: ignore[arg-type]
    "numbers for points": ("runs = ", lambda: friction_map([1.0, 2.0])),  # type: ignore[list-item]
    "a point for points": ("runs = ", lambda: friction_map(MapPoint(1.0, 1.0, 0.0, 2))),  # type: ignore[arg-type]
    "no calibration": (
        "calibration = None", lambda: reactive_torque(ROW, ROW, lever=0.1, calibration=None),  # type: ignore[arg-type]
    ),
    "one of a pair": (
        "calibration = ", lambda: reactive_torque(ROW, ROW, lever=0.1, calibration=(LoadCell(),)),  # type: ignore[arg-type]
    ),
    "residual grows": ("residual gives 3", lambda: global_search(changing(), [0, 0], [1, 1], starts=5)),
    "residual breaks and grows": ("residual gives 3", lambda: global_search(changing(True), [0, 0], [1, 1], starts=5)),
    "residual of members grows": (
        "residual gives 3", lambda: global_search(changing(), [0, 0], [1, 1], starts=8, method="evolution"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", PROCEDURES)
def test_procedures_refuse(name: str) -> None:
    said, call = PROCEDURES[name]
    with pytest.raises(ParameterError, match=said):
        call()


PLAIN = TendonTransmission(radius=np.eye(2), motor_radius=np.ones(2))
GEAR = Reducer(efficiency=0.8)
ZERO = np.zeros((2, 2))


def fitted(reducers: Any, **options: Any) -> TendonTransmission:
    return TendonTransmission(radius=np.eye(2), motor_radius=np.ones(2), reducers=reducers, **options)


ROUTING: dict[str, tuple[str, Callable[[], Any]]] = {
    "driven back": (
        r"reducers\[1\].driven_back = 0.5",
        lambda: fitted([None, Reducer(efficiency=0.8, driven_back=0.5)]).parameters(),
    ),
    "at rest": ("at_rest = 'mean'", lambda: fitted([None, GEAR], at_rest="mean").parameters()),
    **{
        f"back_driven_efficiency({value})": ("efficiency = ", lambda value=value: back_driven_efficiency(value))
        for value in (0.0, -0.1, 1.1, np.nan, np.inf, "0.9", [0.9, np.nan])
    },
    **{
        f"Reducer({name}={value})": (
            f"{name} = ",
            lambda name=name, value=value: Reducer(**{"efficiency": 0.8, "allow_self_locking": True, name: value}),
        )
        for name in ("efficiency", "driven_back", "ratio")
        for value in (np.nan, np.inf, -np.inf, "much", [0.8])
    },
    "driven back above 1": ("driven_back = 1.5", lambda: Reducer(efficiency=0.8, driven_back=1.5)),
    "gains driven back": (
        "driven_back = 1.5", lambda: Reducer(efficiency=0.8, driven_back=1.5, allow_self_locking=True),
    ),
    **{
        f"sign_velocity={value}": (
            "sign_velocity = ",
            lambda value=value: PLAIN.statics.direct(np.ones(2), np.ones(2), sign_velocity=value),
        )
        for value in (-1.0, np.nan, np.inf, None, "much")
    },
    "losses": ("losses of shapes", lambda: BranchLosses(constant=ZERO, tension=ZERO, viscous=np.zeros((3, 3)))),
    "number for reducer": ("reducers = ", lambda: fitted([0.8, None])),
    "reducer alone": ("reducers = ", lambda: fitted(GEAR)),
    "output, shapes": ("broadcast", lambda: GEAR.output_torque(np.ones(2), np.ones(3))),
    "output, NaN": ("torque = nan", lambda: GEAR.output_torque(np.nan, 1.0)),
    "input, NaN": ("velocity = nan", lambda: GEAR.input_torque(1.0, np.nan)),
    "output, words": ("torque = 'much'", lambda: GEAR.output_torque("much", 1.0)),  # type: ignore[arg-type]
    "statics, shapes": ("broadcast", lambda: PLAIN.statics.inverse(np.ones((2, 2)), np.ones((3, 2)))),
    "statics, NaN": ("joint_velocity = nan", lambda: PLAIN.statics.inverse(np.ones(2), [np.nan, 0.0])),
}  # fmt: skip


@pytest.mark.parametrize("name", ROUTING)
def test_routing_refuses(name: str) -> None:
    said, call = ROUTING[name]
    with pytest.raises(ParameterError, match=said):
        call()
