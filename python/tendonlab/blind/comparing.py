"""Open the truth of rehearsed designs: how often effects were to be found, beside how often they were."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tendonlab.rehearsal.curve import clopper_pearson, fit_curve
from tendonlab.rehearsal.judge import judged
from tendonlab.rehearsal.tally import HITS
from tendonlab.report.diagnosis import Diagnosis, EffectFinding, plain
from tendonlab.report.numbers import counted

from .rehearsing import FOUND, REHEARSAL, REPORTS
from .runner import VERDICTS
from .scoring import cases_of, report_of, truth_of

FAILED = "failed"
Folders = Sequence[tuple[Path, Path]]  # truths, and what `rehearse` wrote


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """`cases`: one row per realised rig. `designs`, `repeats`, `effects`, `sizes`: shares by design, by whether it
    repeats an experiment, by effect and by gap over noise of the rehearsal; `pooled`: of all. `mean`, `error`: mean
    over designs of predicted less realised share, in points, and its standard error."""

    cases: pd.DataFrame
    designs: pd.DataFrame
    repeats: pd.DataFrame
    effects: pd.DataFrame
    sizes: pd.DataFrame
    pooled: pd.DataFrame
    mean: float
    error: float

    def __str__(self) -> str:
        tables = {f"by {name[:-1]}": getattr(self, name) for name in ("designs", "effects", "sizes")}
        tables |= {"by whether an experiment repeats": self.repeats, "pooled": self.pooled}
        blocks = [f"{title}\n{table.to_string(float_format='%.1f')}" for title, table in tables.items()]
        over = f"predicted less realised, over {counted(len(self.designs), 'design')}: {self.mean:+.1f} points"
        error = "" if np.isnan(self.error) else f" (standard error {self.error:.1f})"
        return "\n\n".join([*blocks, over + error])

    def to_dict(self) -> dict[str, object]:
        """Plain types; it tells the truth, and says so at its beginning."""
        names = ("designs", "repeats", "effects", "sizes", "pooled", "cases")
        tables = {name: getattr(self, name).reset_index().to_dict(orient="records") for name in names}
        found: dict[str, object] = plain({"mean": self.mean, "error": self.error, **tables})
        return {"format": "tendonlab-score/1", "of": "rehearsals", **found}


def compare(folders: Folders) -> Comparison:
    """Compare the designs of `rehearse` that are complete. A case without a report counts as not found, as in a
    rehearsal. Raises ValueError where no design is complete, a truth is missing or a report was changed."""
    rows = []
    for place, (sealed, out) in enumerate(folders):
        for verdicts in sorted(Path(out).glob(f"*/{REPORTS}/{VERDICTS}")):
            folder = verdicts.parent.parent
            name = folder.name if len(folders) == 1 else f"{place + 1}: {folder.name}"
            rows += [{"design": name, **row} for row in _design(Path(sealed) / folder.name, folder)]
    if not rows:
        raise ValueError(f"{', '.join(str(out) for _, out in folders)}: expected a complete design, found none")
    cases = pd.DataFrame(rows)
    designs = _shares(cases, "design")
    error = float(designs["points"].std() / np.sqrt(len(designs))) if len(designs) > 1 else float("nan")
    return Comparison(
        cases=cases,
        designs=designs,
        repeats=_shares(cases, "repeats"),
        effects=_shares(cases, "effect"),
        sizes=_shares(cases, "gap"),
        pooled=_shares(cases.assign(all="all"), "all"),
        mean=float(designs["points"].mean()),
        error=error,
    )


def _design(truths: Path, folder: Path) -> list[dict[str, Any]]:
    """One row per realised rig of a design."""
    rehearsal = json.loads((folder / REHEARSAL / FOUND).read_text(encoding="utf-8"))
    entries = {entry["effect"]: entry for entry in rehearsal["effects"]}
    reported = json.loads((folder / REPORTS / VERDICTS).read_text(encoding="utf-8"))["reports"]
    rows = []
    for case in cases_of(truths, reported):
        truth = truth_of(truths, case)
        (effect,) = truth["effects"]
        report = report_of(folder / REPORTS, case, reported.get(case, {"verdict": FAILED}))
        answer = FAILED if report["verdict"] == FAILED else judged(answer_of(report), effect)["outcome"]
        draw = {name: truth["draw"][name] for name in ("system", "sample_time", "repeats", "gap_noise")}
        predicted = _predicted(entries[effect], abs(truth["truth"][entries[effect]["parameter"]]))
        rows.append({"case": case, "effect": effect, **draw, **predicted, "outcome": answer})
    return [{**row, "found": row["outcome"] in HITS} for row in rows]


def answer_of(report: Mapping[str, Any]) -> Diagnosis:
    """The part of a report that is judged."""
    needed = [field.name for field in fields(Diagnosis) if field.default is field.default_factory is MISSING]
    names = ("element", "effect", "probability")
    effects = tuple(EffectFinding(**{name: entry[name] for name in names}) for entry in report["effects"])
    return Diagnosis(**{name: report[name] for name in needed} | {"effects": effects})


def _predicted(entry: Mapping[str, Any], amount: float) -> dict[str, Any]:
    """What the rehearsal says of an effect at an `amount` of its size parameter: the gap over noise that it gives it,
    the probability on its detection curve there, and its counts at the nearest size."""
    gaps, amounts, found, tried = (
        [size[name] for size in entry["sizes"]] for name in ("gap", "amount", "found", "tried")
    )
    near = int(np.argmin(np.abs(np.log(np.array(amounts) / amount))))
    order = np.argsort(amounts)
    gap = float(np.exp(np.interp(np.log(amount), np.log(amounts)[order], np.log(gaps)[order])))
    probability = fit_curve(gaps, found, tried).probability(np.array([gap]))[0]
    at = {"gap": float(f"{gap:.3g}"), "predicted": float(probability[0])}
    return {**at, "rehearsed": gaps[near], "hits": found[near], "tried": tried[near]}


def _shares(cases: pd.DataFrame, by: str) -> pd.DataFrame:
    """Predicted and realised shares, %, with 95 % Clopper–Pearson intervals, and their difference in points."""
    rows = {}
    for name, part in cases.groupby(by):
        cells = part.drop_duplicates(["design", "effect", "rehearsed"])
        predicted, realised = 100 * part["predicted"].mean(), 100 * part["found"].mean()
        rows[name] = {
            "predicted %": predicted,
            **_counted("rehearsed", int(cells["hits"].sum()), int(cells["tried"].sum())),
            **_counted("realised", int(part["found"].sum()), len(part)),
            "realised %": realised,
            "points": predicted - realised,
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(by)


def _counted(name: str, hits: int, num: int) -> dict[str, str]:
    low, high = clopper_pearson(hits, num)
    return {name: f"{hits} of {num}", f"{name} 95 %": f"{100 * low:.0f} to {100 * high:.0f}"}
