import numpy as np
import pytest

from tendonlab import _core

half = _core.friction.Efficiency(efficiency_loss=0.25, back_driven_loss=1.0)  # 80 % driving, 75 % driven back


def test_a_hoist_takes_more_up_than_it_gives_back_down() -> None:
    """A weight of 10 N·m: up takes 12.5 N·m at the input (times the ratio), down leaves 7.5 N·m."""
    assert 10.0 + half.force(velocity=[1.0, -1.0], load=10.0) == pytest.approx([12.5, 7.5], rel=1e-15)
    assert -10.0 + half.force(velocity=[-1.0, 1.0], load=-10.0) == pytest.approx([-12.5, -7.5], rel=1e-15)


def test_a_worm_gear_that_loses_more_driven_back_holds_its_load() -> None:
    worm = _core.friction.Efficiency(efficiency_loss=0.5, back_driven_loss=2.0)
    assert 10.0 + worm.force(velocity=-1.0, load=10.0) == 0.0
    assert np.all(worm.level(velocity=[1.0, -1.0], load=10.0) == [5.0, 10.0])
