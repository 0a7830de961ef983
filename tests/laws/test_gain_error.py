from tendonlab import _core


def test_a_tenth_too_much_is_a_tenth_at_every_level() -> None:
    assert _core.actuation.GainError(gain_error=0.125).apply([-8.0, 0.0, 16.0]).tolist() == [-9.0, 0.0, 18.0]
