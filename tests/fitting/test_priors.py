"""Coordinates of free parameters."""

import copy
import math
import pickle

import numpy as np
import pytest

from tendonlab._core import Free
from tendonlab.fitting.priors import AMPLITUDE_SD, FRACTION_SD, SHAPE_LOG_SD, Scale, free_parameters, start_of
from tendonlab.papers import s2
from tendonlab.simulation.records import NominalParameter
from tendonlab.simulation.system import System

DAMPING = Free(
    name="cable_damping", index=0, log=True, scale=0.05, start=0.05, mean=0.0, sd=0.6, lower=0.0, upper=math.inf
)
AMPLITUDE = Free(name="coulomb", index=3, log=False, scale=0.1, start=0.1, mean=0.0, sd=1.0, lower=0.0, upper=1.0)


def test_a_logarithm_starts_above_0_also_where_a_fit_went_there() -> None:
    """A long step of a fit may end where exp(x) is 0; the next fit begins there, and its prior pulls it back."""
    assert DAMPING.value(-945.0) == 0.0
    begun = DAMPING.started(DAMPING.value(-945.0))
    assert 0.0 < begun.start < 1e-300
    assert math.isfinite(begun.coordinate(begun.start))
    assert DAMPING.started(0.02).start == 0.02


def test_what_is_no_logarithm_starts_at_0() -> None:
    assert AMPLITUDE.started(0.0).start == 0.0
    assert AMPLITUDE.started(2.0).start == 1.0


@pytest.mark.parametrize("free", [DAMPING, AMPLITUDE], ids=lambda f: f.name)
def test_a_coordinate_stands_for_its_value(free: Free) -> None:
    assert free.coordinate(free.value(0.7)) == pytest.approx(0.7)
    slope = (free.value(0.7 + 1e-6) - free.value(0.7 - 1e-6)) / 2e-6
    assert free.slope(0.7) == pytest.approx(slope, rel=1e-6)


def test_values_stay_within_bounds_and_finite() -> None:
    assert (AMPLITUDE.value(-3.0), AMPLITUDE.value(30.0)) == (0.0, 1.0)
    assert math.isfinite(DAMPING.value(1e6))


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda free: pickle.loads(pickle.dumps(free))])
def test_a_free_parameter_can_be_copied(copied: object) -> None:
    assert callable(copied)
    other = copied(DAMPING)
    names = ("name", "index", "log", "scale", "start", "mean", "sd", "lower", "upper")
    assert [getattr(other, name) for name in names] == [getattr(DAMPING, name) for name in names]
    assert np.isinf(other.upper)


@pytest.mark.parametrize(("sd", "scale", "prior"), [(0.2, 0.2, 1.0), (math.inf, 0.15, math.inf), (None, 0.15, 1.0)])
def test_a_value_below_0_has_the_prior_that_is_stated(sd: float | None, scale: float, prior: float) -> None:
    """Without an sd the prior is 30 % of the value wide; with inf it says nothing."""
    rig = System(kind="rigid_joint", parameters={"inertia": 1.0, "gravity_torque": -0.5, "torque_constant": 1.0})
    nominal = {"gravity_torque": NominalParameter(-0.5, sd=sd)}
    (free,) = free_parameters(rig, nominal, {"joint": Scale(3.0, 1.0, 1.0)})
    assert (free.name, free.log, free.sd) == ("gravity_torque", False, prior)
    assert free.scale == pytest.approx(scale)
    assert free.value(free.mean) == pytest.approx(-0.5)


def test_an_added_effect_starts_at_nothing_with_a_shape_that_is_typical_of_the_rig() -> None:
    """Its amplitude may go to either side of 0 by the scale of the efforts; its shape is known to a factor."""
    seen = {"joint": Scale(effort=3.0, flow=0.5, displacement=1.0)}
    rig = System(kind="rigid_joint", parameters={"inertia": 1.0, "gravity_torque": 0.5, "torque_constant": 1.0})
    system = rig.with_effects({"joint:stribeck": start_of(rig, "joint:stribeck", seen)})
    amplitude, shape = free_parameters(system, {}, seen, added=["joint:stribeck"])
    assert (amplitude.name, amplitude.log, amplitude.mean, amplitude.sd) == (
        "joint_static_excess", False, 0.0, AMPLITUDE_SD,
    )  # fmt: skip
    assert amplitude.start == 0.0
    assert amplitude.value(1.0) == pytest.approx(3.0 * 0.05)  # the typical excess is a twentieth of the effort
    assert (shape.name, shape.log, shape.mean, shape.sd) == ("joint_stribeck_velocity", True, 0.0, SHAPE_LOG_SD)
    assert shape.value(0.0) == pytest.approx(0.5 * 0.1)
    assert shape.value(math.log(2.0)) == pytest.approx(2.0 * shape.value(0.0))


def test_a_fraction_is_believed_as_it_is() -> None:
    """Its logarithm would keep it from 0."""
    seen = {"joint": Scale(effort=3.0, flow=0.5, displacement=1.0)}
    rig = System(kind="rigid_joint", parameters={"inertia": 1.0, "gravity_torque": 0.5, "torque_constant": 1.0})
    system = rig.with_effects({"joint:load_dependence": start_of(rig, "joint:load_dependence", seen)})
    share, amplitude = free_parameters(system, {}, seen, added=["joint:load_dependence"])
    assert (amplitude.name, share.name) == ("joint_load_dependence", "motor_inertia_share")
    assert (share.log, share.lower, share.upper) == (False, 0.0, 1.0)
    assert (share.start, share.value(share.mean)) == (0.5, pytest.approx(0.5))
    assert share.value(share.mean + share.sd) == pytest.approx(0.5 + FRACTION_SD)
    (again, *_) = free_parameters(system, {"motor_inertia_share": NominalParameter(0.5)}, seen)
    assert (again.name, again.log, again.value(again.mean)) == ("motor_inertia_share", False, pytest.approx(0.5))


def believed(**stated: NominalParameter) -> dict[str, Free]:
    """The free parameters of a joint of known torque constant, with efforts of 3 N·m and speeds of 0.5 rad/s."""
    values = {"inertia": 0.5, "gravity_torque": 1.0, "torque_constant": 2.0, "coulomb": 0.2, "viscous": 0.4}
    given = {name: NominalParameter(value) for name, value in values.items()} | stated
    system = System(
        kind="rigid_joint",
        parameters={name: p.value for name, p in given.items()},
        effects=("joint:coulomb", "joint:viscous"),
    )
    free = free_parameters(system, given, {"joint": Scale(effort=3.0, flow=0.5, displacement=1.0)})
    return {f.name: f for f in free}


def test_what_cannot_be_negative_is_believed_in_its_logarithm() -> None:
    """To 30 %, damping to 60 %, or as stated; a torque constant without sd is taken at its word."""
    found = believed(coulomb=NominalParameter(0.2, sd=0.01))
    assert set(found) == {"inertia", "gravity_torque", "coulomb", "viscous"}
    assert {name: (f.log, f.mean) for name, f in found.items() if name != "gravity_torque"} == dict.fromkeys(
        ("inertia", "coulomb", "viscous"), (True, 0.0)
    )
    assert (found["inertia"].sd, found["viscous"].sd, found["coulomb"].sd) == (0.3, 0.6, pytest.approx(0.05))
    assert found["inertia"].value(0.0) == pytest.approx(0.5)
    assert found["inertia"].value(0.1) == pytest.approx(0.5 * math.exp(0.1))
    assert "torque_constant" in believed(torque_constant=NominalParameter(2.0, sd=0.1))
    assert "inertia" not in believed(inertia=NominalParameter(0.5, sd=0.0))


def test_what_may_have_either_sign_is_believed_as_it_is() -> None:
    """To 30 % of its value, or to three times what is typical of the rig, if that is more; or as stated."""
    typical = 3.0 * abs(System(
        kind="rigid_joint", parameters={"inertia": 1.0, "gravity_torque": 0.5, "torque_constant": 1.0}
    ).info.parameter("gravity_torque").typical)  # fmt: skip
    plain = believed(gravity_torque=NominalParameter(100.0))["gravity_torque"]
    assert (plain.log, plain.sd, plain.scale) == (False, 1.0, pytest.approx(max(30.0, 3.0 * typical)))
    small = believed(gravity_torque=NominalParameter(0.001))["gravity_torque"]
    assert small.scale == pytest.approx(max(3.0 * typical, 0.0003))
    assert small.value(small.mean) == pytest.approx(0.001)
    known = believed(gravity_torque=NominalParameter(1.0, sd=0.25))["gravity_torque"]
    assert (known.scale, known.mean, known.sd) == (0.25, 4.0, 1.0)


def test_stated_bounds_narrow_those_of_the_parameter() -> None:
    free = believed(coulomb=NominalParameter(0.2, lower=0.1, upper=0.3), viscous=NominalParameter(0.4, lower=-1.0))
    assert (free["coulomb"].lower, free["coulomb"].upper) == (0.1, 0.3)
    assert free["viscous"].lower == 0.0


def test_a_zero_that_cannot_be_negative_may_only_grow() -> None:
    free = believed(viscous=NominalParameter(0.0, sd=0.2))["viscous"]
    assert (free.log, free.scale, free.mean, free.lower) == (False, 0.2, 0.0, 0.0)


def test_the_unit_of_a_dimension_is_made_of_what_was_seen() -> None:
    of = Scale(effort=6.0, flow=0.5, displacement=2.0)
    assert [of.of(d) for d in ("effort", "flow", "displacement", "stiffness", "damping", "ratio")] == [
        6.0, 0.5, 2.0, 3.0, 12.0, 1.0,
    ]  # fmt: skip


def test_a_shape_that_may_have_either_sign_is_no_logarithm() -> None:
    """Where the branches of a bushing meet: typically at the middle, in radians."""
    rows = free_parameters(
        s2.system(s2.constants()), {}, {"bushing_2": Scale(1.0, 1.0, 1.0)}, added=["bushing_2:bushing_branches"]
    )
    meeting = next(f for f in rows if f.name == "bushing_2_c1")
    assert (meeting.log, meeting.scale, meeting.sd) == (False, 1.0, AMPLITUDE_SD)
