"""Ties of a report that one more experiment can settle, and how many of them it settled."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from tendonlab.rehearsal.curve import clopper_pearson
from tendonlab.report.diagnosis import plain

from .runner import VERDICTS
from .scoring import SURE, compared, report_of, tied, truth_of
from .systems import SYSTEMS

DECIDES = 10.0  # nats that the proposed experiment must promise
OPEN = 0.02  # probability of an effect from which it may be the right one
FAILED = {"verdict": "failed"}
OUTCOMES = ("settled", "open", "wrong")


class Tie(NamedTuple):
    """Effects between which a report cannot decide, the nats that the experiment it proposes is expected to bring
    between them, and that entry of `next_experiments`."""

    effects: frozenset[str]
    promised: float
    experiment: Mapping[str, Any]


def tie_of(report: Mapping[str, Any]) -> Tie | None:
    """The tie that the first proposed experiment with a reference can settle. None where it separates no two effects,
    promises less than `DECIDES`, or where the report has decided between them already: it is sure of one, or one is
    less probable than `OPEN`."""
    proposed = next((entry for entry in report.get("next_experiments", []) if entry.get("reference")), None)
    if proposed is None:
        return None
    effects, promised = frozenset(map(str, proposed["separates"])), float(proposed["expected_gain"])
    separates = len(effects) > 1 and all(":" in name for name in effects)  # else what an unknown cause follows
    if not separates or promised < DECIDES or decided(report, effects):
        return None
    if min(_probabilities(report).get(name, 0.0) for name in effects) < OPEN:
        return None
    return Tie(effects, promised, proposed)


def decided(report: Mapping[str, Any], effects: frozenset[str]) -> set[str]:
    """Those of the effects that a report is sure of: more probable than `SURE`, together with what the data cannot tell
    from them, none of which is another one of these effects."""
    each = _probabilities(report)
    groups = {name: {name, *tied(report, name)} for name in effects}
    return {
        name
        for name, group in groups.items()
        if group & effects == {name} and sum(each.get(one, 0.0) for one in group) > SURE
    }


def _probabilities(report: Mapping[str, Any]) -> dict[str, float]:
    """Of each effect."""
    return {f"{entry['element']}:{entry['effect']}": float(entry["probability"]) for entry in report.get("effects", [])}


@dataclass(frozen=True, kw_only=True)
class Settlement:
    """`ties`: one row per tie of which one effect is right; `outcome`: "settled" where the new report is sure of this
    one alone, or establishes it, apart from the others, and the first one did not; "wrong" where it is sure of another
    one; else "open". `others`: number of ties without a right effect, or with nothing but right ones."""

    ties: pd.DataFrame
    others: int

    @property
    def settled(self) -> int:
        """Number of ties that were settled."""
        return int((self.ties["outcome"] == "settled").sum())

    def __str__(self) -> str:
        low, high = clopper_pearson(self.settled, len(self.ties))
        share = f"{self.settled} of {len(self.ties)} (95 % interval {100 * low:.0f} to {100 * high:.0f} %)"
        kinds = pd.crosstab(self.ties["system"], self.ties["outcome"]).reindex(columns=OUTCOMES, fill_value=0)
        rows = self.ties[["effects", "right", "promised", "outcome", "probability"]]
        return "\n\n".join(
            [
                f"ties settled: {share}\nties without one right effect, not counted: {self.others}",
                f"by system\n{kinds.to_string()}",
                f"by case\n{rows.to_string(float_format='%.2f')}",
            ]
        )

    def to_dict(self) -> dict[str, object]:
        """Plain types; the rows tell the truth."""
        low, high = clopper_pearson(self.settled, len(self.ties))
        counts = {"settled": self.settled, "ties": len(self.ties), "ci95": [low, high], "others": self.others}
        rows = plain(self.ties.reset_index().to_dict(orient="records"))
        return {"format": "tendonlab-score/1", "of": "ties", **counts, "cases": rows}


def settled(sealed: Path | str, before: Path | str, after: Path | str) -> Settlement:
    """Count the ties of the reports `before` that the reports `after` settle, which `run` wrote of the cases that
    `follow` drew. A case without a new report counts as open. Raises ValueError where no case has a tie, a truth is
    missing or a report was changed."""
    sealed, before, after = Path(sealed), Path(before), Path(after)
    told, new = _verdicts(before), _verdicts(after)
    rows, others = [], 0
    for case in sorted(new):
        first, report = report_of(before, case, told.get(case, FAILED)), report_of(after, case, new[case])
        tie = tie_of(first)
        if tie is None:
            continue
        truth = truth_of(sealed, case)
        truth = {**truth, "accept": _twins(truth)}
        if len(tie.effects & {*truth["effects"], *truth["accept"]}) == 1:
            rows.append({"case": case, "system": truth["draw"]["system"], **_row(tie, truth, first, report)})
        else:
            others += 1
    if not rows and not others:
        raise ValueError(f"{before}: expected reports with a tie on the cases of {after}, found none")
    columns = ("case", "system", "effects", "right", "promised", "outcome", "probability")
    return Settlement(ties=pd.DataFrame(rows, columns=columns).set_index("case"), others=others)


def _twins(truth: Mapping[str, Any]) -> list[str]:
    """Exact twins of the missing effects. What is close to them in the first logs alone is wrong."""
    twins = {twin for name in truth["effects"] for twin in SYSTEMS[truth["draw"]["system"]].twins(name, ())}
    return sorted(twins & set(truth.get("accept", [])))


def _row(tie: Tie, truth: Mapping[str, Any], first: Mapping[str, Any], report: Mapping[str, Any]) -> dict[str, object]:
    (name,) = tie.effects & {*truth["effects"], *truth["accept"]}
    sure, wrong = decided(report, tie.effects), tie.effects - {name}

    def is_established(told: Mapping[str, Any]) -> bool:
        return bool(compared(truth, told).get("established")) and not tied(told, name) & wrong

    is_settled = sure == {name} or (not sure and is_established(report) and not is_established(first))
    return {
        "effects": ", ".join(sorted(tie.effects)),
        "right": name,
        "promised": tie.promised,
        "outcome": "settled" if is_settled else "wrong" if sure & wrong else "open",
        "probability": _probabilities(report).get(name, 0.0),
    }


def _verdicts(reports: Path) -> dict[str, dict[str, Any]]:
    """The hashed verdicts of reports. Raises ValueError where `run` did not write any."""
    path = reports / VERDICTS
    if not path.exists():
        raise ValueError(f"{path} is missing: expected the folder that `blind run` wrote")
    found: dict[str, dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))["reports"]
    return found
