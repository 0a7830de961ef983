from tendonlab import _core


def test_it_gives_the_share_of_the_change_of_sense() -> None:
    assert _core.transmission.Hold(hold=1.0).force(load=-70.0) == -70.0
    assert _core.transmission.Hold(hold=0.25).force(load=-70.0) == -17.5
