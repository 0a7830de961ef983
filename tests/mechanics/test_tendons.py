"""What tendon transmissions, their losses and reducers are given: one wrong thing at a time is refused."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.mechanics.tendons import BranchLosses, Reducer, TendonTransmission, back_driven_efficiency

ONE, EYE = np.ones(2), np.eye(2)
ZERO = np.zeros((2, 2))


def device(**changes: object) -> TendonTransmission:
    return TendonTransmission(**{"radius": EYE, "motor_radius": ONE, **changes})  # type: ignore[arg-type]


def losses(**changes: np.ndarray) -> BranchLosses:
    return BranchLosses(**{"constant": ZERO, "tension": ZERO, "viscous": ZERO, **changes})


WRONG: dict[str, tuple[Callable[[], object], str]] = {
    "radii of another number": (lambda: device(radius=np.eye(3)), r"radius = .*array of shape \(2, 2\)"),
    "a radius of nan": (lambda: device(radius=np.array([[1.0, 0.0], [np.nan, 1.0]])), "radius = .*lower triangular"),
    "a radius above": (lambda: device(radius=np.array([[1.0, 0.1], [0.0, 1.0]])), "radius = .*lower triangular"),
    "no driven pulley": (lambda: device(radius=np.array([[1.0, 0.0], [0.3, 0.0]])), "expected no 0 on the diagonal"),
    "a motor radius of 0": (lambda: device(motor_radius=np.array([1.0, 0.0])), "motor_radius = .*other than 0"),
    "a motor radius of nan": (lambda: device(motor_radius=np.array([1.0, np.nan])), "motor_radius = .*other than 0"),
    "a table of motor radii": (lambda: device(motor_radius=np.ones((2, 1))), "motor_radius = .*expected a list"),
    "no motors": (lambda: device(motor_radius=np.ones(0), radius=np.ones((0, 0))), "motor_radius = .*expected a list"),
    "losses of another number": (lambda: device(losses=BranchLosses.none(3)), "losses of 3 transmissions: expected 2"),
    "too few reducers": (lambda: device(reducers=[None]), "reducers: 1 given, expected 2"),
    "constant below 0": (lambda: losses(constant=-EYE), r"constant loss = .*\[0, inf\)"),
    "all tension lost": (lambda: losses(tension=EYE), r"tension loss = .*\[0, 1.0\)"),
    "a row of losses": (lambda: losses(viscous=ONE), r"viscous loss of shape \(2,\)"),
    "an efficiency of 0": (lambda: back_driven_efficiency([0.9, 0.0]), r"expected values in \(0, 1\]"),
    "an efficiency above 1": (lambda: back_driven_efficiency(1.1), r"expected values in \(0, 1\]"),
    "a reducer that locks": (lambda: Reducer(efficiency=0.5), "at 0.5 and below it locks itself"),
    "a reducer that gains": (lambda: Reducer(efficiency=1.01), r"expected a value in \(0.5, 1\]"),
    "a ratio of 0": (lambda: Reducer(efficiency=0.9, ratio=0.0), "ratio = 0.0: expected a positive number"),
    "a ratio of inf": (lambda: Reducer(efficiency=0.9, ratio=np.inf), "ratio = inf: expected a positive number"),
    "a loss on one way only": (lambda: Reducer(efficiency=1.0, driven_back=0.9), "expected 1 where nothing is lost"),
    "driven back to 0": (lambda: Reducer(efficiency=0.9, driven_back=0.0), r"driven_back = 0.0: expected a value"),
    "a joint too many": (lambda: device().statics.inverse(np.ones(3), ONE), r"torque of shape \(3,\): expected"),
    "a model of its own": (lambda: device().statics.inverse(ONE, ONE, model="eq13"), 'model = "eq13"'),  # type: ignore[arg-type]
    "five joints": (lambda: device(radius=np.eye(5), motor_radius=np.ones(5)).parameters(), "5 joints.*at most 4"),
    "a reducer at a motor": (
        lambda: device(motor_reducers=[Reducer(efficiency=0.9), None]).parameters(), "expected at most 4 and none",
    ),
    "at rest otherwise": (
        lambda: device(reducers=[Reducer(efficiency=0.9), None], at_rest="hold").parameters(), "at_rest = 'hold'",
    ),
}  # fmt: skip


@pytest.mark.parametrize(("call", "told"), WRONG.values(), ids=WRONG)
def test_one_wrong_thing_is_refused(call: Callable[[], object], told: str) -> None:
    with pytest.raises(ParameterError, match=told):
        call()


def test_a_reducer_loses_the_same_power_both_ways() -> None:
    """Of 0.8: it takes 1.25 to give 1; driven back by 1 it gives 0.75, so that a quarter is lost each time."""
    reducer = Reducer(efficiency=0.8)
    assert reducer.back_driven == pytest.approx(0.75)
    assert (reducer.loss, reducer.back_driven_loss) == pytest.approx((0.25, 1.0))
    assert Reducer(efficiency=0.8, driven_back=0.5).back_driven_loss == pytest.approx(2.0)
    assert Reducer(efficiency=1.0).back_driven_loss == 1.0
    assert Reducer(efficiency=0.4, allow_self_locking=True).back_driven == pytest.approx(-0.5)
    assert float(Reducer(efficiency=0.8, ratio=5.0).output_torque(2.0, 1.0)) == pytest.approx(8.0)
    assert float(Reducer(efficiency=0.8, ratio=5.0).input_torque(-10.0, 1.0)) == pytest.approx(-1.5)


def test_a_system_holds_the_numbers_of_the_device_and_plain_joints_beyond_it() -> None:
    """The pulley is the radius on the diagonal over the ratio of its reducer."""
    radius = np.array([[0.1, 0.0], [-0.02, 0.06]])
    lost = losses(constant=np.array([[1.0, 9.0], [2.0, 3.0]]), tension=0.1 * EYE)
    found = device(
        radius=radius, motor_radius=np.array([0.01, 0.02]), losses=lost,
        reducers=[None, Reducer(efficiency=0.9, ratio=3.0)],
    ).parameters()  # fmt: skip
    wanted = {
        "radius_1_1": 0.1, "radius_2_1": -0.02, "radius_2_2": 0.02, "radius_3_3": 1.0, "radius_3_1": 0.0,
        "motor_radius_1": 0.01, "motor_radius_2": 0.02, "motor_radius_4": 1.0,
        "reducer_ratio_1": 1.0, "reducer_ratio_2": 3.0, "reducer_efficiency_2": 0.9, "reducer_efficiency_3": 1.0,
        "constant_loss_1_0": 1.0, "constant_loss_2_0": 2.0, "constant_loss_2_1": 3.0, "tension_loss_1_0": 0.1,
        "tension_loss_2_0": 0.0, "viscous_loss_2_1": 0.0, "constant_loss_3_0": 0.0,
    }  # fmt: skip
    assert {name: found[name] for name in wanted} == pytest.approx(wanted)


def test_losses_scale_kind_by_kind_and_their_power_is_that_of_the_branches() -> None:
    lost = losses(constant=np.array([[1.0, 0.0], [2.0, 3.0]])).scaled(constant=2.0)
    assert lost.constant.tolist() == [[2.0, 0.0], [4.0, 6.0]]
    of = device(losses=lost)
    run = of.statics.inverse([1.0, 5.0], [0.5, -0.2], model="eq12")
    assert run.loss == pytest.approx(np.array([[2.0, 0.0], [-4.0, -6.0]]))
    assert float(run.branch_power) == pytest.approx(2.0 * 0.5 + (4.0 + 6.0) * 0.2)
