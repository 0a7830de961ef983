"""The fit from which the first noise floor follows."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.diagnosis.floor import rough_fit
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter


@pytest.mark.parametrize("is_at_bound", [False, True])
def test_a_rough_fit_that_ends_at_a_bound_is_made_under_noise_as_large_as_its_misfit(
    is_at_bound: bool, twin_case: Any, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It then starts again at what is stated, and ends near it."""
    ended = replace(nominal, at_bound=(is_at_bound,) * len(nominal.free))
    monkeypatch.setattr(Fitter, "fit", lambda self, system, **options: ended)
    fit = rough_fit(twin_case, _core.Cancel())
    assert (fit is not ended) == is_at_bound
    if is_at_bound:
        assert not any(fit.at_bound)
        assert fit.mean_square < 0.5 * 20**2 * nominal.mean_square  # in units of noise that is 20 times less
        sds = [abs(x - f.mean) / f.sd for f, x in zip(fit.free, fit.x, strict=True)]
        assert np.max(sds) < 5.0
