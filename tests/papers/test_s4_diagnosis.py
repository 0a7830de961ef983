"""S4's own gaps, withheld from the simulator of its twin: elastic ends against a mere softer cable, a friction
coefficient that differs by direction, and friction of the joint."""

from dataclasses import replace
from pathlib import Path

import pytest

import tendonlab as tl
from diagnoses import diagnose
from tendonlab.papers import s4
from tendonlab.report.diagnosis import Diagnosis

pytestmark = pytest.mark.slow
TOLD = ("bristle_stiffness", "contact_viscous")
KEPT = ("static_friction_coefficient", "stribeck_velocity", "bristle_stiffness", "bristle_damping")


def diagnosed(folder: Path, of: s4.Case, *, knows_direction: bool) -> Diagnosis:
    rig = s4.write_rig(folder, of, s4.nominal(knows_direction=knows_direction), name=folder.name)
    return diagnose(tl.load(rig))


def test_the_direction_of_friction_is_found(tmp_path: Path) -> None:
    found = diagnosed(tmp_path / "rig-direction", s4.case("E1"), knows_direction=False)
    assert found.verdict == "effect"
    assert found.selected == ("contact:asymmetry",)
    asymmetry = found.effects[0].parameters["coefficient_asymmetry"]["value"]
    assert asymmetry == pytest.approx((0.178 - 0.155) / (0.178 + 0.155), abs=2e-3)
    assert found.shrinkage["from_refitted"]["value"] > 0.8


def test_elastic_ends_are_found(tmp_path: Path) -> None:
    """Tuning alone takes them for a softer cable; the loop that is left tells."""
    found = diagnosed(tmp_path / "rig-ends", s4.case("E2"), knows_direction=True)
    assert found.verdict == "effect"
    assert found.selected == ("ends:compliance",)
    compliance = found.effects[0].parameters["compliance"]["value"]
    assert compliance == pytest.approx(1 / (5 * 5.023e4), rel=0.02)
    assert found.shrinkage["from_refitted"]["value"] > 0.8


def test_elastic_ends_are_found_with_the_contacts_free(tmp_path: Path) -> None:
    """What the paper keeps as in Table III may move by 30 %. Without the ends it moves to where no contact is (mu_s to
    next to nothing), and from there no fit finds back: the ends are fitted from what was believed, too."""
    believed = s4.nominal(knows_direction=True)
    rig = tl.load(s4.write_rig(tmp_path / "free", s4.case("E2"), believed, name="free", duration=2.0))
    free = {name: replace(rig.parameters[name], sd=0.3 * rig.parameters[name].value) for name in KEPT}
    rig = replace(rig, parameters={**rig.parameters, **free})
    found = diagnose(rig, library=["ends:compliance", "sensor.tension_23:delay"])
    assert found.verdict == "effect"
    assert found.selected == ("ends:compliance",)
    compliance = found.effects[0].parameters["compliance"]["value"]
    assert compliance == pytest.approx(1 / (5 * 5.023e4), rel=0.02)


def test_a_softer_cable_is_a_softer_cable(tmp_path: Path) -> None:
    """Of nearly the same amplitude and tensions as the rig with elastic ends, and yet nothing but a parameter."""
    found = diagnosed(tmp_path / "softer", s4.softer(s4.case("E1"), k=3.596e4), knows_direction=True)
    assert found.verdict == "parameters_only"
    assert found.selected == ()


def test_a_wrong_pretension_is_a_parameter(tmp_path: Path) -> None:
    """E4: the screws hold 56 N where the simulator believes 50."""
    found = diagnosed(tmp_path / "pretension", s4.case("E4"), knows_direction=True)
    assert found.verdict == "parameters_only"
    assert found.selected == ()
    assert found.details["parameters"]["pretension"]["value"] == pytest.approx(56.0, abs=0.1)


def test_friction_of_the_joint_is_found_part_by_part(tmp_path: Path) -> None:
    """E3: a LuGre joint of 0.05 N·m, and 0.06 at rest; three effects of the library together are that law."""
    found = diagnosed(tmp_path / "joint", s4.case("E3"), knows_direction=True)
    assert found.verdict == "effect"
    assert found.selected == ("joint:coulomb", "joint:stribeck", "joint:presliding")
    numbers = {name: row["value"] for effect in found.effects[:3] for name, row in effect.parameters.items()}
    wanted = {
        "coulomb": 0.05,
        "static_excess": 0.01,
        "stribeck_velocity": 0.01,
        "bristle_stiffness": 1e3,
        "bristle_damping": 10.0,
    }
    assert numbers == pytest.approx(wanted, rel=0.05)
    assert found.shrinkage["from_refitted"]["value"] > 0.9


def test_the_rest_of_table_iii_can_be_fitted(tmp_path: Path) -> None:
    """From 30 % off: bristle stiffness and viscous friction come back; mu_s and v_s hardly show at these speeds,
    and their intervals say so."""
    folder = s4.write_rig(tmp_path / "known", s4.case("E1"), s4.nominal(knows_direction=True), name="known")
    rig = tl.load(folder)
    off = {name: replace(rig.parameters[name], value=0.7 * rig.parameters[name].value) for name in TOLD}
    found = s4.identify_dynamic(replace(rig, parameters={**rig.parameters, **off})).parameters
    assert found.loc["bristle_stiffness", "value"] == pytest.approx(1e6, rel=0.02)
    assert found.loc["contact_viscous", "value"] == pytest.approx(500.0, rel=0.01)
    assert found.loc["static_friction_coefficient", "sd"] > 0.01
    for name, truth in (("bristle_damping", 1e3), ("stribeck_velocity", 5e-5), ("static_friction_coefficient", 0.2)):
        assert found.loc[name, "ci95_lower"] < truth < found.loc[name, "ci95_upper"]
