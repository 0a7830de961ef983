"""Open the truth and compare: the share of blind cases that the diagnosis got right, by kind and by strength."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tendonlab.report.diagnosis import plain

from .runner import REPORT, VERDICTS, sha256

BINS = (0.0, 0.5, 1.0, 2.0, 4.0, np.inf)  # gap/noise
SURE = 0.8  # probability above which a report names an effect with confidence
PAIRS = ("pair_both", "pair_one", "pair_wrong")
FAULTS = ("fault_kind", "fault_signal")
OF_TRUTH = ("true_probability", "covered", "ranked_share")
HITS = ("top1", "told_apart", "established", "ranked_first", "top3", "class_hit", "element_hit", "verdict_hit")
NONE = "– (n = 0)"  # a share of cases of which there are none
LARGEST_GROUP = 3  # effects that a report cannot tell apart, of which the true one counts as one of so many


@dataclass(frozen=True, kw_only=True)
class Score:
    """`cases`: one row per case, indexed by its id. `summary`: shares over all. `verdicts`: truth by verdict, counts.

    `parts`: the summary of the cases with and without repeats, and of each system. `causes`: shares by unknown cause.
    `strengths`: shares by gap/noise. `effects`: shares by
    true effect.
    """

    cases: pd.DataFrame
    summary: dict[str, float]
    parts: pd.DataFrame
    verdicts: pd.DataFrame
    strengths: pd.DataFrame
    effects: pd.DataFrame
    causes: pd.DataFrame

    def __str__(self) -> str:
        shown = {name: NONE if np.isnan(value) else f"{value:.3g}" for name, value in self.summary.items()}
        lines = [f"{name:<28s} {text}" for name, text in shown.items()]
        tables = [
            ("by part of the cases", self.parts),
            ("verdict (truth in rows)", self.verdicts),
            ("by gap/noise", self.strengths),
            ("by effect", self.effects),
            ("by unknown cause", self.causes),
        ]
        tables = [(title, table) for title, table in tables if len(table)]
        blocks = [f"{title}\n{table.to_string(float_format='%.2f', na_rep='–')}" for title, table in tables]
        return "\n\n".join(["\n".join(lines), *blocks])

    def to_dict(self) -> dict[str, object]:
        """Plain types: summary and rows; null where there is nothing to count."""
        rows = json.loads(self.cases.reset_index().to_json(orient="records"))
        parts = {str(name): dict(column) for name, column in self.parts.items()}
        found: dict[str, object] = plain({"summary": self.summary, "parts": parts, "cases": rows})
        return {"format": "tendonlab-score/1", **found}


def score(sealed: Path | str, reports: Path | str) -> Score:
    """Score the reports of `run` against the truth files of `draw`.

    Top-1: the most probable effect is the true one (or an accepted one) and was selected under the verdict "effect"
    or "unknown_effect"; `ranked_first` asks for the rank alone. Every truth counts: a case without a report (crash,
    time-out, never run) is wrong in every line. Raises ValueError where a report was changed after it was hashed, or
    a truth is missing.
    """
    sealed, reports = Path(sealed), Path(reports)
    if not (reports / VERDICTS).exists():
        raise ValueError(f"{reports / VERDICTS} is missing: expected the folder that `blind run` wrote")
    told = json.loads((reports / VERDICTS).read_text(encoding="utf-8"))["reports"]
    rows = []
    for name in cases_of(sealed, told):
        truth, verdict = truth_of(sealed, name), told.get(name, {"verdict": "failed"})
        rows.append({"case": name, **_facts(truth), **compared(truth, report_of(reports, name, verdict))})
    if not rows:
        raise ValueError(f"{reports / VERDICTS} lists no report: expected at least one")
    return _tables(pd.DataFrame(rows).set_index("case"))


def cases_of(sealed: Path, reported: Iterable[str]) -> list[str]:
    """The cases that have a truth, a report or both."""
    return sorted({*reported, *(path.stem for path in sealed.glob("*.toml"))})


def truth_of(sealed: Path, name: str) -> dict[str, Any]:
    """The truth of a case. Raises ValueError where that is missing or of another format."""
    path = sealed / f"{name}.toml"
    if not path.exists():
        raise ValueError(f"{path} is missing: expected the truth of {name}")
    truth = tomllib.loads(path.read_text(encoding="utf-8"))
    if truth.get("format") != "tendonlab-sealed/1":
        raise ValueError(f"{path}: format = {truth.get('format')!r}: expected 'tendonlab-sealed/1'")
    return truth


def report_of(reports: Path, name: str, verdict: Mapping[str, Any]) -> dict[str, Any]:
    """The report on a case. Raises ValueError where it is not the one that was hashed."""
    if verdict["verdict"] == "failed":
        return {"verdict": "failed", "effects": [], "selected": []}
    path = reports / name / REPORT
    if not path.exists() or sha256(path) != verdict["sha256"]:
        raise ValueError(f"{path} is not the report that was hashed in {VERDICTS}: expected sha256 {verdict['sha256']}")
    report: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return report


def _facts(truth: Mapping[str, Any]) -> dict[str, object]:
    draw = truth.get("draw", {})
    names = ("system", "cause", "gap_noise", "excitation", "controller", "repeats", "form", "is_documented_form")
    drawn = {name: draw.get(name) for name in names} | {"repeats": draw.get("repeats", True)}  # once all cases had them
    return {"effect": ",".join(truth["effects"]), "truth": truth["verdict"]} | drawn


def compared(truth: Mapping[str, Any], report: Mapping[str, Any]) -> dict[str, object]:
    """One row of the cases: what a report says beside the truth."""
    ranked = sorted(report.get("effects", []), key=lambda entry: -float(entry["probability"]))
    names = [f"{entry['element']}:{entry['effect']}" for entry in ranked]
    selected, failed = list(report.get("selected", [])), report["verdict"] == "failed"
    found: dict[str, object] = {
        "verdict": report["verdict"],
        "first": names[0] if names else "",
        "probability": float(ranked[0]["probability"]) if ranked else np.nan,
        "selected": ",".join(selected),
        "verdict_hit": report["verdict"] == truth["verdict"],
        "failed": failed,
        "shrinkage": 0.0 if failed else _shrinkage(report),
        "seconds": float(report.get("seconds", np.nan)),
    }
    if truth["verdict"] == "data_fault":
        return found | _fault(truth["fault"], report)
    found["blocked"] = failed or report["verdict"] == "data_fault"
    right = {*truth["effects"], *truth.get("accept", [])}
    if len(truth["effects"]) > 1:
        return found | _pair(right, set(selected), report["verdict"])
    if truth["verdict"] == "unknown_effect":
        named = [float(e["probability"]) for e, name in zip(ranked, names, strict=True) if name in selected]
        return found | {"unknown_hit": found["verdict_hit"], "unknown_named": failed or max(named, default=0.0) > SURE}
    if not truth["effects"]:
        return found | {"false_alarm": bool(selected) or report["verdict"] in ("effect", "unknown_effect", "failed")}
    first = names[0] if names else ""
    names_it = report["verdict"] in ("effect", "unknown_effect") and first in selected
    there = [entry for entry, name in zip(ranked, names, strict=True) if name in right]
    known = [e for e, n in zip(ranked, names, strict=True) if n in truth["effects"] and n in selected]
    is_own_form = bool(truth.get("draw", {}).get("is_documented_form"))
    told = known if is_own_form else []
    whole = ("effect",) if is_own_form else ("effect", "unknown_effect")
    return found | {
        "true_probability": min(1.0, sum(float(entry["probability"]) for entry in there)),
        "covered": _covered(told[0], truth.get("truth", {})) if told else np.nan,
        "top1": first in right and names_it,
        "established": bool(selected) and right.issuperset(selected) and report["verdict"] in whole,
        "ranked_first": first in right,
        "ranked_share": _ranked_share(report, first, right),
        "told_apart": first in right and names_it and not tied(report, first) - right,
        "top3": bool(right & set(names[:3])),
        "class_hit": _part(first, 2) in {_part(name, 2) for name in right},
        "element_hit": _part(first, 0) in {_part(name, 0) for name in right},
    }


def _covered(entry: Mapping[str, Any], truth: Mapping[str, float]) -> float:
    """Share of the parameters of an effect whose 95 % interval holds the true value; NaN where none has both."""
    inside = []
    for name, found in entry.get("parameters", {}).items():
        value = truth.get(f"{entry['element']}_{name}", truth.get(name))
        if value is not None and found["ci95"] is not None:
            inside.append(found["ci95"][0] <= value <= found["ci95"][1])
    return float(np.mean(inside)) if inside else float("nan")


def _pair(right: set[str], selected: set[str], verdict: str) -> dict[str, object]:
    """Of two missing effects both, or one, are selected and established; what is selected beside them is wrong."""
    count = len(right & selected) if verdict in ("effect", "unknown_effect") else 0
    return {"pair_both": count >= 2, "pair_one": count >= 1, "pair_wrong": bool(selected - right)}


def _fault(fault: Mapping[str, Any], report: Mapping[str, Any]) -> dict[str, object]:
    """Something of the right kind blocks, and it names a signal, or the experiment, that is wrong."""
    kind = [entry for entry in report.get("data", []) if entry["blocks"] and entry["problem"] == fault["problem"]]
    named = {str(name) for entry in kind for name in (entry["signal"], entry["experiment"], *entry.get("or", []))}
    return {"fault_kind": bool(kind), "fault_signal": bool(named & {*fault["signals"], *fault["experiments"]})}


def tied(report: Mapping[str, Any], effect: str) -> set[str]:
    """What the data cannot tell from an effect."""
    return {str(name) for group in report.get("indistinguishable", []) if effect in group for name in group}


def _ranked_share(report: Mapping[str, Any], first: str, right: set[str]) -> float:
    """1 where the first effect is right; 1/size where the first one's group, of at most three, holds a right one."""
    group = tied(report, first)
    if first in right:
        return 1.0
    return 1.0 / len(group) if group & right and len(group) <= LARGEST_GROUP else 0.0


def _part(name: str, index: int) -> str:
    return name.partition(":")[index]


def _shrinkage(report: Mapping[str, Any]) -> float:
    value = ((report.get("shrinkage") or {}).get("from_refitted") or {}).get("value")
    return float(value) if value is not None else float("nan")


def _tables(cases: pd.DataFrame) -> Score:
    for name in (*HITS, *PAIRS, *FAULTS, *OF_TRUTH, "blocked", "false_alarm", "unknown_hit", "unknown_named"):
        if name not in cases:
            cases[name] = np.nan
        cases[name] = cases[name].astype(float)
    single = _single(cases)
    cells = pd.cut(single["gap_noise"].astype(float), list(BINS), right=False).astype(str)
    return Score(
        cases=cases,
        summary=_summary(cases),
        parts=pd.DataFrame({name: _summary(part) for name, part in _parts(cases).items()}),
        verdicts=pd.crosstab(cases["truth"], cases["verdict"]),
        strengths=_shares(single, cells),
        effects=_shares(single, single["effect"]),
        causes=_by_cause(cases[cases["truth"] == "unknown_effect"]),
    )


def _parts(cases: pd.DataFrame) -> dict[str, pd.DataFrame]:
    repeats = cases["repeats"].astype(bool)
    parts = {"with repeats": cases[repeats], "without repeats": cases[~repeats]}
    if cases["system"].nunique() > 1:
        parts |= {str(name): part for name, part in cases.groupby("system")}
    return {name: part for name, part in parts.items() if len(part)}


def _single(cases: pd.DataFrame) -> pd.DataFrame:
    return cases[(cases["effect"] != "") & cases["pair_both"].isna()]


def _summary(cases: pd.DataFrame) -> dict[str, float]:
    single = _single(cases)
    summary = {"cases": float(len(cases)), "single effects": float(len(single))}
    summary |= {name.replace("_", " "): _mean(single[name]) for name in HITS if name != "verdict_hit"}
    if cases["pair_both"].notna().any():
        summary |= {name.replace("_", " "): _mean(cases[name]) for name in PAIRS}
    if cases["fault_kind"].notna().any():
        summary |= {name.replace("_", " "): _mean(cases[name]) for name in FAULTS}
    summary["blocked without a fault"] = _mean(cases["blocked"])
    summary["verdict right"] = _mean(cases["verdict_hit"])
    for truth in ("no_gap", "parameters_only"):
        summary[f"false alarms on {truth}"] = _mean(cases.loc[cases["truth"] == truth, "false_alarm"])
    summary["unknown recall"] = _mean(cases["unknown_hit"])
    summary[f"unknown named with P > {SURE}"] = _mean(cases["unknown_named"])
    summary["probability of the truth"] = _mean(single["true_probability"])
    summary["intervals that cover"] = _mean(single["covered"])
    summary["median shrinkage"] = float(single["shrinkage"].median()) if len(single) else float("nan")
    summary["seconds per case"] = _mean(cases["seconds"])
    summary["failed"] = float(cases["failed"].sum())
    return summary


def _by_cause(cases: pd.DataFrame) -> pd.DataFrame:
    groups = cases.groupby("cause")
    table = groups[["unknown_hit", "unknown_named"]].mean()
    table.insert(0, "cases", groups.size())
    return table


def _mean(values: pd.Series) -> float:
    return float(values.mean()) if values.notna().any() else float("nan")


def _shares(single: pd.DataFrame, by: pd.Series) -> pd.DataFrame:
    groups = single.groupby(by)
    table = groups[[*HITS, "shrinkage"]].mean()
    table.insert(0, "cases", groups.size())
    return table
