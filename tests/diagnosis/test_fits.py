"""What notes say of a fit."""

from dataclasses import replace
from typing import Any

from tendonlab.diagnosis.answer import notes
from tendonlab.diagnosis.search.select import Search
from tendonlab.fitting.problem import Fitter


def test_what_the_experiments_state_themselves_is_told(fitter: Fitter, twin_case: Any) -> None:
    """Of gravity, which every experiment knows, no residual says anything; nor is it proposed to be anything else."""
    known = tuple(replace(e, conditions={**e.conditions, "gravity_torque": 1.0}) for e in twin_case.experiments)
    case = replace(twin_case, experiments=known)
    fitted = replace(fitter, case=case).fit(case.system, max_iterations=1)
    search = Search(fitter, tuned=fitted, steps=(), rounds=())
    warning = "not informed by these data and held at the nominal value: gravity_torque"
    assert warning in notes.warnings(case, fitter.floor, search)
    rows = notes.details(case, fitter.floor, fitted, search)["parameters"]
    assert [name for name, row in rows.items() if not row["informed"]] == ["gravity_torque"]
