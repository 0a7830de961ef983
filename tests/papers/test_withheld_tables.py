"""The tables that end a notebook: what was withheld, what was found, how far the gap shrank."""

from types import SimpleNamespace
from typing import Any

import pandas as pd
import pytest

from tendonlab.identification.result import Identification
from tendonlab.papers import withheld


def diagnosis(selected: tuple[str, ...]) -> Any:
    gaps = {"nominal": [4.0, 2.0], "refitted": [2.0, 1.0], "with_effect": [0.5, 0.0]}
    numbers = {"slack": {"value": 0.98765, "ci95": [0.9, 1.0], "unit": "1"}}
    effects = [
        SimpleNamespace(name="sheath:slack", probability=0.999, parameters=numbers),
        SimpleNamespace(name="cable:viscous", probability=0.2, parameters={}),
        SimpleNamespace(name="load:offset", probability=1e-9, parameters={}),
    ]
    return SimpleNamespace(
        selected=selected,
        verdict="effect" if selected else "parameters_only",
        held_out=pd.DataFrame(gaps, index=["a", "b"]),
        shrinkage={"from_refitted": {"value": 0.84}, "from_nominal": {"value": 0.5}},
        effects=effects,
    )


def test_each_held_out_run_has_its_own_shrinkage() -> None:
    assert withheld.shrinkages(diagnosis(("sheath:slack",))).to_dict() == {"a": 0.75, "b": 1.0}
    assert withheld.shrinkages(diagnosis(())).to_dict() == {"a": 0.5, "b": 0.5}


def test_the_summary_shows_the_extremes_of_single_runs() -> None:
    table = withheld.summary({"slack": diagnosis(("sheath:slack",)), "a radius": diagnosis(())})
    assert list(table.loc["slack"]) == ["effect", "sheath:slack", "refitted", "0.84", "0.75 to 1.00 (2 runs)"]
    assert list(table.loc["a radius"]) == ["parameters_only", "none", "nominal", "0.50", "0.50 to 0.50 (2 runs)"]


def test_probabilities_are_bounded_words_and_have_no_interval() -> None:
    table = withheld.probabilities(diagnosis(("sheath:slack",)))
    assert table["probability (1)"].tolist() == ["> 0.99", "0.20", "< 0.01"]
    assert table["selected"].tolist() == ["yes", "", ""]
    assert table.loc["sheath:slack", "numbers"] == "slack = 0.988"


def test_a_fit_is_set_next_to_the_twin(monkeypatch: pytest.MonkeyPatch) -> None:
    intervals = {"asymmetry": (0.06, 0.08), "compliance": (3.0, 4.0)}
    fit = SimpleNamespace(
        values={"asymmetry": 0.07, "compliance": 3.5},
        ci95=lambda name: intervals[name],
        system=SimpleNamespace(unit=lambda name: "1" if name == "asymmetry" else "m/N"),
    )

    def identified(*_: Any, **given: Any) -> Identification:
        assert given["effects"] == ("contact:asymmetry",)
        return fit  # type: ignore[return-value]

    monkeypatch.setattr(withheld, "identify", identified)
    data: Any = None
    table = withheld.established(data, ("contact:asymmetry",), {"asymmetry": 0.069, "compliance": 5.0})
    assert list(table.loc["asymmetry (1)"]) == ["0.069", "0.07", "0.06 to 0.08", "yes"]
    assert table.loc["compliance (m/N)", "holds the twin"] == "no"
