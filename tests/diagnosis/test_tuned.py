"""The refitted simulator starts where the rough fit ended, as long as that can be simulated."""

from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.diagnosis.outcome import _tuned
from tendonlab.errors import NumericalError


@pytest.mark.parametrize("stiff", [False, True])
def test_where_the_rough_fit_is_too_stiff_tuning_starts_from_the_nominal_simulator(stiff: bool) -> None:
    rough: Any = SimpleNamespace(system="rough")
    nominal: Any = SimpleNamespace(system="nominal", initial=[[2.0]])

    def fit(system: str, *, initial: Any) -> Any:
        if stiff and system == "rough":
            raise NumericalError("simulation stopped after 34000 step attempts")
        return system, initial

    fitter: Any = SimpleNamespace(fit=fit)
    assert _tuned(fitter, rough, nominal, [[1.0]]) == (("nominal", [[2.0]]) if stiff else ("rough", [[1.0]]))
