import pytest

from tendonlab import _core


@pytest.mark.parametrize(("loss", "left"), [(0.25, 30.0), (1.0, 0.0), (-0.5, 60.0)])
def test_later_laws_see_the_pretension_that_is_left_and_all_else_as_it_is(loss: float, left: float) -> None:
    port = {"velocity": 0.3, "position": 0.1, "load": 5.0, "wrap_angle": 2.0}
    behind = _core.sheath.PretensionLoss(pretension_loss=loss).motion(**port, preload=40.0)
    assert behind.pop("preload") == pytest.approx(left, abs=1e-12)
    assert behind == port


def test_friction_falls_with_it() -> None:
    """Capstan friction is proportional to the pretension, so half of it is left of half a pretension."""
    capstan = _core.sheath.Capstan(friction_coefficient=0.1, static_friction_coefficient=0.1, stribeck_velocity=0.1)
    behind = _core.sheath.PretensionLoss(pretension_loss=0.5).motion(velocity=0.3, wrap_angle=2.0, preload=40.0)
    assert capstan.level(**behind, curvature_skew=0.0) == pytest.approx(
        0.5 * capstan.level(velocity=0.3, wrap_angle=2.0, preload=40.0), rel=1e-14
    )
