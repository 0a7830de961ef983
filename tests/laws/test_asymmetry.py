import pytest

from tendonlab import _core

law = _core.friction.Asymmetry(level_asymmetry=0.25, viscous_asymmetry=0.5)


def test_forwards_and_backwards_differ_by_twice_the_share() -> None:
    assert law.factor(velocity=[3.0, -0.01]).tolist() == [1.25, 0.75]
    assert law.factor(velocity=0.0) == 1.0  # at rest there is no direction


def test_viscous_friction_forwards_and_backwards_around_the_mean_one() -> None:
    """With F_v = 2: 2.5 forwards, 1.5 backwards, as two laws in one slot add."""
    mean = _core.friction.Viscous(viscous=2.0)
    both = [mean.force(velocity=v) + law.force(velocity=v) for v in (1.0, -1.0)]
    assert both == pytest.approx([2.5, -1.5])
