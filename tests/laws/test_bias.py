from tendonlab import _core


def test_differences_of_readings_do_not_see_it() -> None:
    first, second = _core.sensing.Bias(bias=-0.5).apply([1.0, 3.0])
    assert (first, second - first) == (0.5, 2.0)
