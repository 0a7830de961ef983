"""What holds for every registered law, whatever its formula; a new one is tested before its author writes a test."""

import copy
import inspect
import pickle
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import arrays
from hypothesis.strategies import floats

from tendonlab import _core
from tendonlab.errors import ParameterError

VELOCITY = np.linspace(-2.0, 2.0, 41)
POSITION = np.linspace(-0.5, 0.5, 12)[:, None]  # not 0: the only point where a gap of no width does not touch
MOTION = {"velocity": VELOCITY, "position": POSITION, "load": 3.0}
PORT = {**MOTION, "wrap_angle": 2.4 * POSITION, "preload": 2.0}
TIME = np.arange(VELOCITY.size) * 0.01
velocities = arrays(float, 16, elements=floats(-10, 10))


def test_it_says_what_it_is(law: Any) -> None:
    one = law.law
    assert one.name == law.name
    for text in (one.noun, one.equation, one.source, one.summary):
        assert len(text) > 2
    assert one.roles
    assert law.amplitudes, "no value switches it off"
    for p in one.parameters:
        assert p.name in one.__doc__
        assert p.meaning in one.__doc__
        assert p.lower <= p.typical <= p.upper
    assert one.equation in one.__doc__
    assert one.source in one.__doc__


def test_its_parameters_can_be_read_and_kept(law: Any) -> None:
    one = law.make()
    assert repr(one).startswith(f"{law.law.__name__}(")
    again = pickle.loads(pickle.dumps(one))
    for p in law.law.parameters:
        assert getattr(one, p.name) == getattr(again, p.name) == p.typical
        with pytest.raises(AttributeError):
            setattr(one, p.name, 0.0)


def test_a_value_outside_its_bounds_is_refused(law: Any) -> None:
    """The message states the unit, but none for a ratio."""
    for p in law.law.parameters:
        unit = "$" if p.dimension in ("ratio", "effort_per_load") else " .+"
        for wrong in (np.nan, np.inf, p.lower - 1.0):
            with pytest.raises(ParameterError, match=rf"{p.name} = .*: expected a value in \[.*\]{unit}"):
                law.make(**{p.name: wrong})


def test_a_misspelt_keyword_is_answered_with_the_nearest(law: Any) -> None:
    known = law.law.parameters[0].name
    with pytest.raises(ParameterError, match=f"{known}x: {law.law.__name__} has no such parameter; did you mean"):
        law.make(**{known + "x": 1.0})


def test_a_missing_keyword_is_named_with_its_meaning(law: Any) -> None:
    for p in law.law.parameters:
        others = {q.name: q.typical for q in law.law.parameters if q.name != p.name}
        if p.purpose == "share":
            assert getattr(law.law(**others), p.name) == p.typical
        else:
            with pytest.raises(ParameterError, match=f"{p.name} is missing: expected {p.meaning}"):
                law.law(**others)


def behind(law: Any, one: Any) -> dict[str, np.ndarray]:
    """All that a law of a slot or of a signal answers at the same motion, by method; of a motion all fields."""
    roles, answers = set(law.law.roles), {}
    for role in roles & {"level", "factor", "gain"}:
        answers[role] = getattr(one, role)(**PORT)
    if roles & {"level", "force"}:
        answers["force"] = one.force(**PORT)
    if "memory" in roles:
        answers["force"] = one.force(velocity=VELOCITY, deflection=0.01, level=0.7)
    if "motion" in roles:
        answers |= one.motion(**port_of(one))
    if "signal" in roles:
        answers["signal"] = one.apply(VELOCITY, **beside_the_signal(one))
    return {name: np.asarray(values) for name, values in answers.items()}


def port_of(one: Any) -> dict[str, Any]:
    """A port with a value other than 0 in each of its fields."""
    return {name: PORT.get(name, 0.7) for name in one.motion()}


def beside_the_signal(one: Any) -> dict[str, Any]:
    """What else a law of a signal sees, each other than 0."""
    names = list(inspect.signature(one.apply).parameters)[1:]
    return {name: TIME if name == "time" else 0.7 for name in names}


def test_off_means_nothing_in_every_answer(law: Any) -> None:
    """No friction, factors of one, the dry friction alone behind a memory, and all fields of a motion as they came."""
    neutral = {"level": 0.0, "force": 0.0, "factor": 1.0, "gain": 1.0, "signal": VELOCITY}
    if "memory" in law.law.roles:
        neutral["force"] = 0.7 * np.sign(VELOCITY)
    if "motion" in law.law.roles:
        neutral |= port_of(law.off())
    for name, answer in behind(law, law.off()).items():
        np.testing.assert_array_equal(answer, np.broadcast_to(neutral[name], answer.shape), err_msg=name)


def test_on_differs_from_off(law: Any) -> None:
    off, on = behind(law, law.off()), behind(law, law.make())
    assert on.keys() == off.keys() != set()
    assert any(not np.array_equal(on[name], off[name]) for name in on)


def test_each_amplitude_alone_switches_it_on(law: Any) -> None:
    off = behind(law, law.off())
    for name in law.amplitudes:
        typical = next(p.typical for p in law.law.parameters if p.name == name)
        alone = behind(law, law.make(**{**dict.fromkeys(law.amplitudes, 0.0), name: typical}))
        assert any(not np.array_equal(alone[answer], off[answer]) for answer in off), name


@pytest.mark.roles("level", "force", but="factor", group="friction")
@given(velocity=velocities)
@settings(max_examples=30, deadline=None)
def test_friction_never_adds_energy(law: Any, velocity: np.ndarray) -> None:
    """A factor alone says nothing: see below."""
    assert np.all(law.make().force(velocity=velocity, load=-2.0) * velocity >= 0)


@pytest.mark.roles("factor")
def test_a_factor_keeps_the_level_a_magnitude(law: Any) -> None:
    for p in law.law.parameters:
        if p.dimension == "ratio":
            for extreme in (p.lower, p.upper):
                assert np.all(law.make(**{p.name: extreme}).factor(**{**PORT, "wrap_angle": 1.2}) >= 0)


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


@pytest.mark.roles("level", "factor", "force", "gain")
def test_it_is_finite_and_broadcasts(law: Any) -> None:
    one = law.make()
    for role in set(law.law.roles) & {"level", "factor", "force", "gain"}:
        of = getattr(one, role)
        answer = of(**PORT)
        assert np.all(np.isfinite(answer))
        for i, j in ((0, 0), (5, 20), (10, 40)):  # a batch equals a loop
            assert answer[i, j] == of(
                **{name: np.broadcast_to(of_all, (12, 41))[i, j] for name, of_all in PORT.items()}
            )


@pytest.mark.roles("level", "factor", "force")
def test_a_motion_that_is_not_finite_is_refused(law: Any) -> None:
    for role in set(law.law.roles) & {"level", "factor", "force"}:
        with pytest.raises(ParameterError, match="velocity = nan: expected a value in"):
            getattr(law.make(), role)(velocity=np.array([0.0, np.nan]))


def test_positional_numbers_are_refused_with_the_keyword_to_use(law: Any) -> None:
    known = law.law.parameters[0].name
    with pytest.raises(ParameterError, match=rf"{law.law.__name__}\(1\.0\): expected keywords, .*\({known}=…\)"):
        law.law(1.0)


def test_laws_of_equal_numbers_are_equal(law: Any) -> None:
    name = law.amplitudes[0]
    one, again, off = law.make(), copy.copy(law.make()), law.make(**{name: 0.0})
    assert one == again != off
    assert hash(one) == hash(again)
    assert type(again) is law.law
    assert isinstance(one, _core.Law)


def test_signatures_name_the_arguments(law: Any) -> None:
    assert list(inspect.signature(law.law).parameters) == [p.name for p in law.law.parameters]
    methods = [name for name, of in vars(law.law).items() if callable(of) and not name.startswith("_")]
    for name in methods:
        of = getattr(law.make(), name)
        assert inspect.signature(of).parameters
        assert "->" not in of.__doc__
        with pytest.raises(ParameterError, match="mistaken: expected one of"):
            of(**dict.fromkeys(inspect.signature(of).parameters, 1.0), mistaken=1.0)
