"""What a diagnosis found of an effect that was withheld from a simulator: tables for the end of a notebook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from tendonlab.data import Dataset
from tendonlab.identification.identify import identify
from tendonlab.report.diagnosis import Diagnosis


def shrinkages(why: Diagnosis) -> pd.Series:
    """By how much the gap of each held-out experiment shrinks, 1 where it ends at the noise floor: from the refitted
    simulator to that with the selected effects; where none was selected, from the nominal to the refitted one."""
    before, after = ("refitted", "with_effect") if why.selected else ("nominal", "refitted")
    return (1.0 - why.held_out[after] / why.held_out[before]).rename("shrinkage")


def summary(cases: Mapping[str, Diagnosis]) -> pd.DataFrame:
    """A row by what was withheld: the verdict, the selected effects, how far the gap shrinks over all held-out
    experiments and one by one. So few experiments give no interval, so their extremes stand in its place."""
    rows = {}
    for withheld, why in cases.items():
        pooled = why.shrinkage["from_refitted" if why.selected else "from_nominal"]
        single = shrinkages(why)
        rows[withheld] = {
            "verdict": why.verdict,
            "selected": ", ".join(why.selected) or "none",
            "the gap shrinks from": "refitted" if why.selected else "nominal",
            "by (1)": f"{pooled['value']:.2f}" if pooled else "",
            "in single held-out runs, by (1)": f"{single.min():.2f} to {single.max():.2f} ({len(single)} runs)",
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("withheld")


def probabilities(why: Diagnosis, *, most: int = 4) -> pd.DataFrame:
    """The `most` probable effects: how probable it is that each is a part of the cause; numbers of those selected."""
    rows = {}
    for effect in why.effects[:most]:
        chosen = effect.name in why.selected
        numbers = [f"{name} = {_quantity(row)}" for name, row in effect.parameters.items() if chosen]
        probable = "< 0.01" if effect.probability < 0.01 else f"{min(effect.probability, 0.99):.2f}"
        rows[effect.name] = {
            "probability (1)": "> 0.99" if effect.probability > 0.99 else probable,
            "selected": "yes" if chosen else "",
            "numbers": ", ".join(numbers),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("effect")


def established(dataset: Dataset, effects: Sequence[str], twin: Mapping[str, float]) -> pd.DataFrame:
    """A fit of the simulator with `effects` to the training experiments: of the parameters in `twin`, by their names in
    the system, the twin's value, the value found and its 95 % interval."""
    fit = identify(dataset, effects=effects, progress=False)
    rows = {}
    for name, true in twin.items():
        low, high = fit.ci95(name)
        rows[f"{name} ({fit.system.unit(name)})"] = {
            "twin": f"{true:.4g}",
            "found": f"{fit.values[name]:.4g}",
            "95 % interval": f"{low:.4g} to {high:.4g}",
            "holds the twin": "yes" if low <= true <= high else "no",
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("parameter")


def _quantity(row: Mapping[str, Any]) -> str:
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    return f"{row['value']:.3g}{unit}"
