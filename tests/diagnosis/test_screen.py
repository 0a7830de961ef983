"""The screen of candidates: most promising first, started at a shape of its grid."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from tendonlab import _core
from tendonlab.diagnosis.search import screen
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.priors import start_of
from tendonlab.fitting.problem import Fitter


def test_candidates_come_most_promising_first(fitter: Fitter, nominal: Fitted) -> None:
    library = ("joint:asymmetry", "joint:stribeck", "actuation:offset")
    with ThreadPoolExecutor(1) as pool:
        workshop = Workshop(pool, _core.Cancel(), progress=False, library=library)
        gains = [one.gain for one in workshop.screen_all(fitter, nominal, "")]
    assert gains == sorted(gains, reverse=True)
    assert gains[0] > gains[-1]


def test_fits_start_at_a_multiple_of_the_typical_shape(
    fitter: Fitter, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(screen, "SHAPES", (3.0,))
    (start,) = screen.screen(fitter, nominal, "joint:stribeck").starts
    typical = start_of(nominal.system, "joint:stribeck", fitter.case.scales)
    assert start["joint_stribeck_velocity"] == pytest.approx(3.0 * typical["joint_stribeck_velocity"])
