"""What the functions of S4 refuse, by the name of the argument."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s4

NAN = float("nan")
BAD, ROW = np.array([1.0, NAN]), np.array([1.0, 2.0])


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: s4.capstan_play(BAD, T_0=1.0, mu=0.1, wrap=1.0), "T_in[1] = nan: expected a finite number"),
        (lambda: s4.capstan_play(ROW, T_0=NAN, mu=0.1, wrap=1.0), "T_0 = nan: expected"),
        (lambda: s4.capstan_play(ROW, T_0=1.0, mu=NAN, wrap=1.0), "mu = nan: expected"),
        (lambda: s4.capstan_play(ROW, T_0=1.0, mu=0.1, wrap=NAN), "wrap = nan: expected"),
        (lambda: s4.saturation(ROW, v_threshold=0.0), "v_threshold = 0.0: expected a value in (0, inf) m/s"),
        (lambda: s4.pointwise_stiffness(ROW, BAD, r=0.012, T_p=50.0), "dtheta[1] = nan: expected a finite number"),
        (lambda: s4.pointwise_stiffness(ROW, ROW, r=0.0, T_p=50.0), "r = 0.0: expected"),
        (lambda: s4.identify_stiffness(BAD, ROW, r=0.012), "T22[1] = nan: expected a finite number"),
        (lambda: s4.identify_stiffness(ROW, BAD, r=0.012), "dtheta[1] = nan: expected a finite number"),
        (lambda: s4.series_stiffness(), "number of sections = 0: expected a whole number of at least 1"),
        (lambda: s4.nrmse(ROW, np.ones(2)), "range of measured = 0.0: expected"),
        (lambda: s4.softer(s4.case("E1"), k=0.0), "k = 0.0: expected a value in (0, inf) N/m"),
        (lambda: s4.softer(s4.case("E1"), k=NAN), "k = nan: expected"),
        (lambda: s4.friction_coefficient(60.0, 50.0, 0.0), "wrap = 0.0: expected a value in (0, inf) rad"),
        (lambda: s4.friction_coefficient(60.0, 50.0, BAD), "wrap = nan: expected"),
        (lambda: s4.static_tensions(0.0, 0.0, s_1=1, s_2=1, mechanism=s4.design(), mu=-0.1), "mu = -0.1: expected"),
        (lambda: s4.stiffness(0.0, sign=0, mechanism=s4.design(), mu=0.1), "sign = 0: expected +1 or -1"),
        (lambda: s4.equilibrium_error(sign=2, mechanism=s4.design(), mu=0.1), "sign = 2: expected +1 or -1"),
    ],
)
def test_a_wrong_input_is_named(call: Callable[[], object], said: str) -> None:
    with pytest.raises(ParameterError, match=re.escape(said)):
        call()


def test_the_pointwise_stiffness_leaves_out_an_error_of_zero() -> None:
    k = s4.pointwise_stiffness(np.array([50.0, 62.0]), np.array([0.0, 1e-3]), r=0.012, T_p=50.0)
    assert np.isnan(k[0])
    assert k[1] == pytest.approx(1e6)
