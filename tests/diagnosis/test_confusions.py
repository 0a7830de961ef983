"""What is easily mistaken for what, as a report and its proposals name it."""

from tendonlab.diagnosis.confusions import CONFUSIONS, among, confusions
from tendonlab.simulation.catalog import kinds, system_info


def test_two_selected_effects_that_share_a_confusion_are_named_together() -> None:
    (shared,) = among(["joint:stribeck", "motor:stribeck", "load:offset"])
    assert set(shared.effects) == {"joint:stribeck", "motor:stribeck"}
    assert "the cable differently" in shared.separates


def test_only_the_selected_ones_of_a_larger_confusion_are_named() -> None:
    (shared,) = among(["actuation:offset", "joint:asymmetry"])
    assert set(shared.effects) == {"actuation:offset", "joint:asymmetry"}


def test_one_effect_alone_is_confused_with_nothing_selected() -> None:
    for confusion in CONFUSIONS:
        assert among(confusion.effects[:1]) == []
    assert among([]) == []


def test_an_effect_is_mistaken_only_for_what_its_system_may_have() -> None:
    """A rigid joint has no motor of its own: its friction has one place only."""
    assert confusions(system_info("rigid_joint"), "joint:stribeck") == []
    (other,) = confusions(system_info("two_inertia"), "joint:stribeck")
    assert other.effects == ("motor:stribeck",)
    (words,) = confusions(system_info("rigid_joint"), "actuation:gain_error")
    assert words.effects == ("all torque parameters together",)


def test_every_effect_that_is_confused_is_one_of_some_system() -> None:
    known = {effect.name for kind in kinds() for effect in system_info(kind).effects}
    assert {name for confusion in CONFUSIONS for name in confusion.effects if ":" in name} <= known
