"""What the functions of S3 refuse, by the name of the argument."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s3

NAN = float("nan")


def predict(*, tau_in: tuple[float, ...] = (0.0, 1.0), v: tuple[float, ...] = (1.0, 1.0), y0: float = 0.0) -> None:
    shape, p = s3.Shape.even(3.6, length=0.8), s3.paper_parameters()
    s3.predict(np.array(tau_in), np.array(v), shape=shape, T_s=264.8, p=p, dt=1e-3, y0=y0)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: predict(tau_in=(0.0, NAN)), "tau_in[1] = nan: expected a finite number"),
        (lambda: predict(v=(NAN, 1.0)), "v[0] = nan: expected a finite number"),
        (lambda: predict(v=(1.0,)), "expected"),
        (lambda: predict(y0=NAN), "y0 = nan: expected"),
        (lambda: predict(y0=float("inf")), "y0 = inf: expected"),
        (lambda: s3.mean_squared_error(np.array([]), np.array([])), "measured has 0 samples: expected at least 1"),
        (lambda: s3.mean_squared_error(np.zeros(3), np.zeros(1)), "predicted has 1 samples: expected 3"),
        (lambda: s3.capstan_tension(50.0, -0.1, 1.0), "mu = -0.1: expected a value in [0, inf)"),
        (lambda: s3.capstan_tension(50.0, NAN, 1.0), "mu = nan: expected"),
        (lambda: s3.fit_gradient([]), "number of records = 0: expected a whole number of at least 1"),
        (lambda: s3.fit_nelder_mead([]), "number of records = 0: expected a whole number of at least 1"),
    ],
)
def test_a_wrong_input_is_named(call: Callable[[], object], said: str) -> None:
    with pytest.raises(ParameterError, match=re.escape(said)):
        call()
