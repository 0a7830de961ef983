"""A law that is the whole friction of its element replaces the others there, and nothing elsewhere."""

from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.diagnosis.search.swap import can_replace, extended

LUGRE = {
    "contact_lugre_coulomb": 0.2,
    "contact_lugre_static_friction": 0.3,
    "contact_lugre_stribeck_velocity": 0.1,
    "contact_lugre_stribeck_exponent": 2.0,
}


@pytest.fixture(scope="module")
def system() -> tl.System:
    """A bench whose contact has a whole law, a term added to it, and a sensor with a bias."""
    info = tl.system_info("friction_map")
    effects = ("contact:load_and_ratio", "contact:asymmetry", "sensor.friction_torque:bias")
    names = [name for effect in effects for name in info.effect(effect).parameters]
    return tl.System(kind="friction_map", parameters=dict.fromkeys(names, 0.5), effects=effects)


def test_a_whole_friction_takes_the_place_of_all_others_of_its_element(system: tl.System) -> None:
    swapped = extended(system, {"contact:static_lugre": LUGRE})
    assert set(swapped.effects) == {"contact:static_lugre", "sensor.friction_torque:bias"}
    own = {name: value for name, value in swapped.parameters.items() if swapped.info.parameter(name).effect}
    assert own == {**LUGRE, "sensor.friction_torque_bias": 0.5}


def test_a_term_joins_what_is_there(system: tl.System) -> None:
    joined = extended(system, {"contact:coulomb": {"contact_coulomb": 0.1}})
    assert set(joined.effects) == {*system.effects, "contact:coulomb"}
    assert joined.parameters == {**system.parameters, "contact_coulomb": 0.1}


def test_a_whole_friction_that_is_there_already_replaces_nothing(system: tl.System) -> None:
    changed = extended(system, {"contact:load_and_ratio": {"coulomb": 0.7}})
    assert changed.effects == system.effects
    assert changed.parameters == {**system.parameters, "coulomb": 0.7}


def test_only_a_whole_friction_of_the_same_element_that_no_effect_was_added_to_is_replaced(system: tl.System) -> None:
    lugre = system.info.effect("contact:static_lugre")
    assert can_replace(lugre, system, [])
    assert can_replace(lugre, system, ["sensor.friction_torque:bias"])
    assert not can_replace(lugre, system, ["contact:asymmetry"])
    terms = tl.System(kind="friction_map", parameters={"contact_coulomb": 0.1}, effects=("contact:coulomb",))
    assert not can_replace(lugre, terms, [])
    elsewhere: Any = SimpleNamespace(element="motor", roles=lugre.roles)
    assert not can_replace(elsewhere, system, [])
