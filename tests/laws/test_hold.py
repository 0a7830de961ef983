from tendonlab.transmission import Hold


def test_it_gives_the_share_of_the_change_of_sense() -> None:
    assert Hold(hold=1.0).force(load=-70.0) == -70.0
    assert Hold(hold=0.25).force(load=-70.0) == -17.5
