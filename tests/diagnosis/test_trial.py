"""What a trial makes of beliefs, of effects that may be 0 although they gain, and of laws that are there elsewhere."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.diagnosis.search.contest import _reliever
from tendonlab.diagnosis.search.trial import Trial, gain_elsewhere, has_shape, is_constant, is_no_shape, restores_belief
from tendonlab.simulation.catalog import LEVEL


def believed(strain: float, **more: Any) -> Any:
    """A model with one stated parameter, `strain` sd from what is believed of it, and one effect."""
    free = (SimpleNamespace(name="inertia", mean=1.0, sd=0.1), SimpleNamespace(name="size", mean=0.0, sd=3.0))
    purposes = {"inertia": "structure", "size": "amplitude"}
    info = SimpleNamespace(
        effect=lambda name: SimpleNamespace(parameters=("size",), element="joint", roles=LEVEL, sees=1),
        parameter=lambda name: SimpleNamespace(purpose=purposes[name]),
    )
    made = SimpleNamespace(
        free=free[: 1 + bool(more)], x=(1.0 + 0.1 * strain, 2.0)[: 1 + bool(more)], shares=None, evidence=0.0
    )
    made.left_out, made.system, made.by_experiment = np.zeros(3), SimpleNamespace(info=info), lambda gains: gains
    made.counted = lambda *_: made
    for name, value in more.items():
        setattr(made, name, value)
    return made


def test_beliefs_that_suit_a_model_better_count_as_one_more_experiment() -> None:
    made = Trial.of("a", believed(1.0, evidence=5.0), believed(9.0))
    assert (made.left_out_gain, made.lost) == (pytest.approx(40.0), 0.0)
    worse = Trial.of("a", believed(9.0, evidence=5.0), believed(1.0))
    assert worse.left_out_gain == 0.0


@pytest.mark.parametrize(("interval", "nothing"), [((-0.1, 0.2), True), ((0.0, 0.2), True), ((0.1, 0.2), False)])
def test_an_effect_that_gains_may_be_nothing(interval: tuple[float, float], nothing: bool) -> None:
    fitted = believed(0.0, evidence=700.0, value=lambda name: (0.1, interval))
    assert Trial.of("a", fitted, believed(0.0)).is_nothing is nothing


@pytest.mark.parametrize(
    ("kind", "effect", "shape"),
    [
        ("two_inertia", "sensor.motor_angle:bias", False),
        ("two_inertia", "load:offset", False),
        ("two_inertia", "joint:stribeck", True),
        ("bowden_pair", "actuation:drive_inertia", False),
        ("bowden_pair", "sheath:distributed_presliding", True),  # acts on the torque that the sheath passes on
        ("bowden_pair", "sheath:velocity_gate", True),
    ],
)
def test_what_acts_on_a_command_a_load_or_a_reading_has_no_shape(kind: str, effect: str, shape: bool) -> None:
    assert has_shape(effect, tl.system_info(kind)) is shape


@pytest.mark.parametrize(
    ("kind", "effect", "constant"),
    [
        ("two_inertia", "sensor.motor_angle:bias", True),
        ("two_inertia", "actuation:offset", True),
        ("cable_joint", "load:offset", True),
        ("two_inertia", "sensor.motor_angle:delay", False),
        ("two_inertia", "actuation:gain_error", False),
        ("two_inertia", "actuation:deadband", False),
        ("two_inertia", "joint:coulomb", False),
    ],
)
def test_offsets_and_biases_are_constants(kind: str, effect: str, constant: bool) -> None:
    assert is_constant(effect, tl.system_info(kind)) is constant


def pulled_to(*sd: float, mean_square: float = 1.1) -> Any:
    """A model whose stated parameters are that many stated sd from their values, on a scale that is not logarithmic."""
    free = [SimpleNamespace(name=f"p{k}", mean=1.0, sd=0.1, log=False, value=float) for k in range(len(sd))]
    return SimpleNamespace(free=free, x=[1.0 + 0.1 * by for by in sd], mean_square=mean_square)


def stated(num: int) -> Any:
    parameters = {f"p{k}": SimpleNamespace(value=1.0, sd=0.1) for k in range(num)}
    return SimpleNamespace(dataset=SimpleNamespace(parameters=parameters))


@pytest.mark.parametrize(
    ("base", "extended", "restored"),
    [
        ((9.0, 0.0), (4.0, 0.0), True),  # 32 nats are enough
        ((7.5, 0.0), (2.0, 2.0), True),  # 24 nats, and what nobody believed is believed
        ((6.5, 4.0), (2.0, 2.0), False),  # 25 nats, but each parameter may have been where it was
        ((7.5, 0.0), (4.5, 0.0), False),  # and may be where it is
        ((7.5, 0.0), (3.0, 5.5), False),  # 9 nats
    ],
)
def test_an_effect_restores_belief_in_parameters_that_were_pulled_too_far(
    base: tuple[float, ...], extended: tuple[float, ...], restored: bool
) -> None:
    assert restores_belief(stated(len(base)), pulled_to(*base), pulled_to(*extended)) is restored


@pytest.mark.parametrize(
    ("mean_square", "gain", "found"),
    [
        (1.1, 25.0, "b"),  # what beliefs tell needs no higher bar of a further effect
        (1.1, 9.0, None),
        (9.0, 50.0, None),
    ],
)
def test_what_relieves_the_beliefs_takes_over_near_the_floor(
    mean_square: float, gain: float, found: str | None
) -> None:
    base = pulled_to(7.5, mean_square=mean_square)
    trials = [Trial("a", pulled_to(7.4), 200.0, 200.0, 0.0), Trial("b", pulled_to(0.5), gain, gain, 0.0)]
    fitter: Any = SimpleNamespace(case=stated(1))
    best = _reliever(fitter, base, trials)
    assert (best.effect if best else None) == found


def test_friction_that_the_model_has_elsewhere_needs_a_larger_share() -> None:
    """However little is left: Stribeck friction of a joint whose shape is not the library's looks like the motor's. A
    bias has no shape."""

    def needed(effect: str, gain: float, beside: str) -> bool:
        base: Any = SimpleNamespace(mean_square=3.0, added=(beside,))
        fitted: Any = SimpleNamespace(mean_square=1.1)
        friction = not effect.startswith("sensor")
        return is_no_shape(base, [Trial(effect, fitted, gain, gain, 0.0, has_shape=friction)], 10_000.0)

    assert not needed("motor:stribeck", 900.0, "joint:stribeck")
    assert needed("motor:stribeck", 1100.0, "joint:stribeck")
    assert needed("motor:asymmetry", 200.0, "joint:stribeck")
    assert needed("sensor.motor_angle:bias", 200.0, "sensor.joint_angle:bias")


@pytest.mark.parametrize(
    ("added", "heard", "gain"),
    [
        (("sensor.joint_velocity:delay",), "motor_angle", 30.0),  # of the other two outputs
        (("sensor.joint_velocity:delay",), "joint_velocity", 0.0),  # an injection passes the error on
        (("joint:stribeck",), "motor_angle", 0.0),
        (("sensor.joint_velocity:delay", "joint:stribeck"), "motor_angle", 0.0),
        ((), "motor_angle", 0.0),
    ],
)
def test_what_an_error_of_one_sensor_leaves_shows_in_that_sensor(
    added: tuple[str, ...], heard: str, gain: float
) -> None:
    outputs = [SimpleNamespace(name=name) for name in ("motor_angle", "joint_angle", "joint_velocity")]
    run: Any = SimpleNamespace(output=np.array([0, 1, 2]), residual=np.array([6.0, 5.0, 9.0]))
    better: Any = SimpleNamespace(output=run.output, residual=np.array([4.0, 1.0, 1.0]))
    system = SimpleNamespace(info=SimpleNamespace(outputs=outputs))
    base: Any = SimpleNamespace(added=added, system=system, shares=np.array([1.0, 5.0 / 3.0, 1.0]), runs=[run])
    fitted: Any = SimpleNamespace(runs=[better])
    assert gain_elsewhere(base, Trial("joint:stribeck", fitted, 60.0, 60.0, 0.0), heard=heard) == pytest.approx(gain)


def test_a_weak_effect_may_show_where_a_strong_one_does_not() -> None:
    base: Any = SimpleNamespace(mean_square=0.95, added=("sensor.joint_velocity:delay",))
    fitted: Any = SimpleNamespace(mean_square=0.9)
    trials = [Trial("joint:stribeck", fitted, 3000.0, 3000.0, 0.0)]
    assert not is_no_shape(base, trials, 4e6, elsewhere=90.0)
    assert is_no_shape(base, trials, 4e6, elsewhere=110.0)
