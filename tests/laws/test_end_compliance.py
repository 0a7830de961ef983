import pytest

from tendonlab import _core


def test_a_section_carries_its_stretch_over_its_compliance() -> None:
    law = _core.ends.Compliance(compliance=2e-6)
    assert law.force(position=[1e-3, -1e-3]) == pytest.approx([500.0, -500.0], rel=1e-14)


def test_two_sections_in_series_are_twice_as_compliant() -> None:
    one, two = (_core.ends.Compliance(compliance=c) for c in (2e-6, 4e-6))
    assert two.force(position=1e-3) == pytest.approx(one.force(position=0.5e-3), rel=1e-14)


def test_a_rigid_section_has_no_force_of_its_own() -> None:
    assert _core.ends.Compliance(compliance=0.0).force(position=1e-3) == 0.0
