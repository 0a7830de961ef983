"""What holds for every registered law, whatever its formula; a new one is tested before its author writes a test."""

import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import arrays
from hypothesis.strategies import floats

from tendonlab.errors import ParameterError

VELOCITY = np.linspace(-2.0, 2.0, 41)
POSITION = np.linspace(-0.5, 0.5, 11)[:, None]
MOTION = {"velocity": VELOCITY, "position": POSITION, "load": 3.0}
velocities = arrays(float, 16, elements=floats(-10, 10))


def test_it_says_what_it_is(law: Any) -> None:
    one = law.law
    assert one.name == law.name
    for text in (one.noun, one.equation, one.source, one.summary):
        assert len(text) > 2
    assert one.roles
    assert law.amplitudes, "no value switches it off"
    for p in one.parameters:
        assert p["name"] in one.__doc__
        assert p["meaning"] in one.__doc__
        assert p["lower"] <= p["typical"] <= p["upper"]
    assert one.equation in one.__doc__
    assert one.source in one.__doc__


def test_its_parameters_can_be_read_and_kept(law: Any) -> None:
    one = law.make()
    assert repr(one).startswith(f"{law.law.__name__}(")
    again = pickle.loads(pickle.dumps(one))
    for p in law.law.parameters:
        assert getattr(one, p["name"]) == getattr(again, p["name"]) == p["typical"]
        with pytest.raises(AttributeError):
            setattr(one, p["name"], 0.0)


def test_a_value_outside_its_bounds_is_refused(law: Any) -> None:
    for p in law.law.parameters:
        for wrong in (np.nan, np.inf, p["lower"] - 1.0):
            with pytest.raises(ParameterError, match=rf"{p['name']} = .*: expected a value in \[.*\] .+"):
                law.make(**{p["name"]: wrong})


def test_a_misspelt_keyword_is_answered_with_the_nearest(law: Any) -> None:
    known = law.law.parameters[0]["name"]
    with pytest.raises(ParameterError, match=f"{known}x: {law.law.__name__} has no such parameter; did you mean"):
        law.make(**{known + "x": 1.0})


def test_a_missing_keyword_is_named_with_its_meaning(law: Any) -> None:
    for p in law.law.parameters:
        others = {q["name"]: q["typical"] for q in law.law.parameters if q["name"] != p["name"]}
        if p["purpose"] == "share":
            assert getattr(law.law(**others), p["name"]) == p["typical"]
        else:
            with pytest.raises(ParameterError, match=f"{p['name']} is missing: expected {p['meaning']}"):
                law.law(**others)


@pytest.mark.roles("level", "force")
def test_off_means_no_force(law: Any) -> None:
    assert not np.any(law.off().force(**MOTION))


@pytest.mark.roles("level")
def test_off_means_no_level(law: Any) -> None:
    assert not np.any(law.off().level(**MOTION))


@pytest.mark.roles("factor")
def test_off_means_a_factor_of_one(law: Any) -> None:
    assert np.all(law.off().factor(**MOTION) == 1.0)


@pytest.mark.roles("memory")
def test_off_means_the_dry_friction_alone(law: Any) -> None:
    found = law.off().force(velocity=VELOCITY, deflection=0.01, level=0.7)
    np.testing.assert_array_equal(found, 0.7 * np.sign(VELOCITY))


@pytest.mark.roles("motion")
def test_off_means_the_motion_itself(law: Any) -> None:
    np.testing.assert_array_equal(law.off().stretch(position=POSITION), POSITION)


@pytest.mark.roles("signal")
def test_off_means_the_signal_itself(law: Any) -> None:
    np.testing.assert_array_equal(law.off().apply(VELOCITY), VELOCITY)


@pytest.mark.roles("level", "force", but="factor", group="friction")
@given(velocity=velocities)
@settings(max_examples=30, deadline=None)
def test_friction_never_adds_energy(law: Any, velocity: np.ndarray) -> None:
    """A factor alone says nothing: see below."""
    assert np.all(law.make().force(velocity=velocity, load=-2.0) * velocity >= 0)


@pytest.mark.roles("factor")
def test_a_factor_keeps_the_level_a_magnitude(law: Any) -> None:
    for p in law.law.parameters:
        if p["dimension"] == "ratio":
            for extreme in (p["lower"], p["upper"]):
                assert np.all(law.make(**{p["name"]: extreme}).factor(velocity=VELOCITY) >= 0)


@pytest.mark.roles("memory")
def test_a_memory_dissipates_over_a_cycle(law: Any) -> None:
    """Work against the law over closed cycles of motion that never slide through, and that do."""
    for amplitude in (0.02, 0.5):
        t = np.linspace(0.0, 2 * np.pi, 40001)
        velocity = amplitude * np.cos(t)
        one, z, work = law.make(), 0.0, 0.0
        cycles = np.tile(velocity[:-1], 2)
        for k, v in enumerate(cycles):
            if k >= len(velocity) - 1:  # the first cycle only forgets the start
                work += one.force(velocity=v, deflection=z, level=0.5) * v * t[1]
            z += one.rate(velocity=v, deflection=z, level=0.5) * t[1]
        assert work > 0


@pytest.mark.roles("level", "factor", "force")
def test_it_is_finite_and_broadcasts(law: Any) -> None:
    one = law.make()
    for role in set(law.law.roles) & {"level", "factor", "force"}:
        of = getattr(one, role)
        found = of(**MOTION)
        assert np.all(np.isfinite(found))
        for i, j in ((0, 0), (5, 20), (10, 40)):  # a batch equals a loop
            assert np.broadcast_to(found, (11, 41))[i, j] == of(velocity=VELOCITY[j], position=POSITION[i, 0], load=3.0)


@pytest.mark.roles("level", "factor", "force")
def test_a_motion_that_is_not_finite_is_refused(law: Any) -> None:
    for role in set(law.law.roles) & {"level", "factor", "force"}:
        with pytest.raises(ParameterError, match="velocity = nan: expected a value in"):
            getattr(law.make(), role)(velocity=np.array([0.0, np.nan]))
