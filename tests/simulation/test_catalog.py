"""The tables of the core in Python: values that cannot be changed, look-ups that name the nearest row."""

import copy
import pickle

import pytest

import tendonlab as tl
from tendonlab.errors import ParameterError
from tendonlab.simulation.catalog import DIMENSIONS

INFO = tl.system_info("two_inertia")
ROWS = [
    *INFO.inputs,
    *INFO.outputs,
    *INFO.parameters,
    *INFO.effects,
    *INFO.elements,
    *INFO.ports,
    DIMENSIONS["damping"],
]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{type(row).__name__}-{row.name}")
def test_a_row_is_a_value(row: object) -> None:
    for twin in (pickle.loads(pickle.dumps(row)), copy.deepcopy(row)):
        assert twin == row
        assert hash(twin) == hash(row)
        assert repr(twin) == repr(row)
    assert repr(row).startswith(f"{type(row).__name__}(name='")
    assert row != "another type"
    with pytest.raises(AttributeError):
        row.name = "changed"  # type: ignore[attr-defined]


def test_rows_of_different_facts_differ() -> None:
    assert len({*INFO.parameters}) == len(INFO.parameters)
    assert INFO.parameters[0] != INFO.parameters[1]


def test_a_system_shows_what_it_is() -> None:
    assert repr(INFO).startswith("SystemInfo(two_inertia: motor_torque, known_torque -> motor_angle, ")
    shown = INFO._repr_html_()
    for name in ("motor_torque", "cable_torque", "gear_ratio", "joint:stribeck"):
        assert f"<td>{name}</td>" in shown
    assert shown.count("<table>") == 1


@pytest.mark.parametrize("kind", tl.kinds())
def test_a_system_pickles_to_itself(kind: str) -> None:
    info = tl.system_info(kind)
    assert pickle.loads(pickle.dumps(info)) is info
    assert copy.deepcopy(info) is info
    with pytest.raises(AttributeError):
        info.kind = "changed"  # type: ignore[misc]


def test_what_is_absent_is_none() -> None:
    assert INFO.parameter("gear_ratio").effect is None
    assert INFO.parameter("gear_ratio").role is None
    assert INFO.outputs[2].axis is None
    assert INFO.outputs[0].axis == 0
    assert INFO.inputs[0].replaced_by is None
    assert INFO.element("cable").axis is None


def test_roles_are_read_from_the_tables() -> None:
    rigid = tl.system_info("rigid_joint")
    gain, payload = rigid.with_role("command_gain"), rigid.with_role("payload")
    assert gain is not None
    assert payload is not None
    assert (gain.name, payload.name) == ("torque_constant", "gravity_torque")
    assert rigid.command == rigid.inputs[0]
    assert tl.system_info("bowden_pair").with_role("payload") is None
    assert tl.system_info("bowden_pair").command is None


@pytest.mark.parametrize("kind", tl.kinds())
def test_a_command_has_a_gain(kind: str) -> None:
    """So it may be logged as a current, a voltage or a number."""
    info = tl.system_info(kind)
    assert (info.command is None) == (info.with_role("command_gain") is None)


def test_places_without_ports_share_the_motion_of_an_element() -> None:
    acts_on = {element.name: element.acts_on for element in INFO.elements}
    assert acts_on["load"] == acts_on["joint"] == "joint"
    assert acts_on["actuation"] == "motor"


@pytest.mark.parametrize("row", ["parameter", "effect", "element"])
def test_an_unknown_row_is_answered_with_the_nearest(row: str) -> None:
    known = getattr(INFO, f"{row}s")[0].name
    with pytest.raises(ParameterError, match=f"'{known}x' is no {row} of two_inertia; did you mean '{known}'"):
        getattr(INFO, row)(f"{known}x")


def test_dimensions_state_units_and_the_scale_of_a_typical_value() -> None:
    damping = DIMENSIONS["damping"]
    assert (damping.rotary, damping.linear) == ("N*m*s/rad", "N*s/m")
    assert (damping.scale, damping.per) == ("effort", "flow")
    assert (DIMENSIONS["ratio"].scale, DIMENSIONS["ratio"].per) == (None, None)
    assert set(DIMENSIONS) >= {p.dimension for kind in tl.kinds() for p in tl.system_info(kind).parameters}


@pytest.mark.parametrize("kind", tl.kinds())
def test_an_effect_offers_the_class_of_its_law(kind: str) -> None:
    for effect in tl.system_info(kind).effects:
        assert effect.law is getattr(getattr(tl, effect.group), effect.law.__name__)
        assert (effect.law.name, effect.law.equation) == (effect.effect, effect.equation)
