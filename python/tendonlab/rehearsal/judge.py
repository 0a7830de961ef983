"""What a diagnosis said of a simulated rig, beside what was withheld."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tendonlab.report.diagnosis import Diagnosis

OUTCOMES = {
    "found": "found",
    "tied": "found in a group that the data cannot tell apart",
    "other": "taken for another effect",
    "nothing": "taken for nothing, or for wrong parameters",
    "unknown": "taken for an unknown effect",
    "data_fault": "taken for a fault of the logs",
    "failed": "the diagnosis failed",
}
LIKELY = 0.5  # probability that an effect needs to be found where the verdict is that something unknown is there
CLEAN = ("no_gap", "parameters_only")


def judged(why: Diagnosis, effect: str) -> dict[str, Any]:
    """The outcome for a rig from which `effect` was withheld ("": nothing was).

    `outcome`: a key of OUTCOMES. `named`: the effects that were selected. `on_truth`: the probability given to the
    truth, that of its indistinguishable group summed. `stated`, `right`: the probability of the answer that was given,
    and whether the answer is true."""
    named = list(why.selected)
    groups = [group for group in why.indistinguishable if effect in group]
    group = {effect, *(name for g in groups for name in g)} if effect else set()
    probability = {entry.name: float(entry.probability) for entry in why.effects}
    clean = sum(float(why.verdict_probability[verdict]) for verdict in CLEAN)
    on_truth = min(1.0, sum(probability.get(name, 0.0) for name in group)) if effect else clean
    outcome = _outcome(why.verdict, named, effect, group)
    if outcome in ("found", "tied") and why.verdict == "unknown_effect" and on_truth < LIKELY:
        outcome = "unknown"
    right = outcome in ("found", "tied") if effect else outcome == "nothing"
    if named:
        stated = on_truth if right and effect else max(probability.get(name, 0.0) for name in named)
    else:
        stated = clean if outcome == "nothing" else float(why.verdict_probability[why.verdict])
    return {
        "outcome": outcome,
        "verdict": why.verdict,
        "named": named,
        "on_truth": on_truth,
        "stated": min(1.0, stated),
        "right": right,
    }


def _outcome(verdict: str, named: list[str], effect: str, group: set[str]) -> str:
    if effect and effect in named:
        return "found"
    if group & set(named):
        return "tied"
    if named:
        return "other"
    if verdict in CLEAN:
        return "nothing"
    return "data_fault" if verdict == "data_fault" else "unknown"
