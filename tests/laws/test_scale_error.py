from tendonlab import _core


def test_a_heavier_mass_weighs_more_at_every_angle() -> None:
    assert _core.loading.ScaleError(scale_error=0.25).apply([4.0, -2.0]).tolist() == [5.0, -2.5]
