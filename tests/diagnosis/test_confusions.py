"""What is easily mistaken for what, as a report and its proposals name it."""

from tendonlab.diagnosis.confusions import CONFUSIONS, among, confusions
from tendonlab.simulation.catalog import kinds, system_info

TWO_INERTIA = system_info("two_inertia")


def test_two_selected_effects_that_share_a_confusion_are_named_together() -> None:
    (shared,) = among(TWO_INERTIA, ["joint:stribeck", "motor:stribeck", "load:offset"])
    assert set(shared.effects) == {"joint:stribeck", "motor:stribeck"}
    assert "the cable differently" in shared.separates


def test_only_the_selected_ones_of_a_larger_confusion_are_named() -> None:
    (shared,) = among(TWO_INERTIA, ["actuation:offset", "joint:asymmetry"])
    assert set(shared.effects) == {"actuation:offset", "joint:asymmetry"}
    assert "cable stretch" in shared.separates


def test_what_separates_causes_is_something_that_the_rig_has() -> None:
    """A rigid joint has no cable that stretches; its asymmetry shows where its friction changes."""
    (shared,) = among(system_info("rigid_joint"), ["actuation:offset", "joint:asymmetry"])
    assert "cable" not in shared.separates
    assert "share of the friction" in shared.separates
    (offsets,) = among(system_info("servo_pendulum"), ["actuation:offset", "load:offset"])
    assert "switched off" in offsets.separates  # nothing is said of an asymmetry or a bias, which are not among them


def test_one_effect_alone_is_confused_with_nothing_selected() -> None:
    for confusion in CONFUSIONS:
        assert among(TWO_INERTIA, confusion.effects[:1]) == []
    assert among(TWO_INERTIA, []) == []


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
