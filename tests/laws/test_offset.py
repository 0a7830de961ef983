from tendonlab import _core


def test_it_is_there_at_zero_command_and_the_same_at_any_other() -> None:
    assert _core.actuation.Offset(offset=0.25).apply([0.0, -4.0]).tolist() == [0.25, -3.75]
