"""Which: the candidate effects, their combinations, and what the data cannot tell."""

from __future__ import annotations

from tendonlab.report import numbers
from tendonlab.report.blocks import Block, Candidates, Cell, Points, Table, Text
from tendonlab.report.diagnosis import Diagnosis, EffectFinding
from tendonlab.report.words import VERDICTS, capital, phrases

SHOWN = 12  # candidates in the table of the page; report.json has all
LEAST = 0.005  # probability below which a candidate without a selected effect is not worth a row of its own
_NUM_SETS = 6
_EVIDENCE = (
    "Held-out gain: how much better held-out experiments are predicted than by the refitted simulator, as log score, ± "
    "standard error, in nats. A gain of g makes the data e to the power g times more probable; about 10 decide."
)


def causes(diagnosis: Diagnosis) -> list[Block]:
    """The ranked candidates, then combinations, ties and blind spots."""
    findings = listed(diagnosis)
    if not findings:
        return [Text(text="No candidate effect was considered.")]
    blocks: list[Block] = [Candidates(findings=findings, brief=True), Text(text=_EVIDENCE, note=True)]
    if less := _less_likely(diagnosis, len(diagnosis.effects) - len(findings)):
        blocks.append(Text(text=less, note=True))
    return [*blocks, *_combinations(diagnosis), _ties(diagnosis), _blind_spots(diagnosis)]


def _less_likely(diagnosis: Diagnosis, hidden: int) -> str:
    """What the table does not show."""
    if not hidden:
        return ""
    unfitted = sum(not effect.parameters for effect in diagnosis.effects)
    without = f" {unfitted} of all candidates have no fit: the screen promised too little, or the warnings say why."
    return f"{hidden} more of low probability in report.json." + (without if unfitted else "")


def listed(diagnosis: Diagnosis) -> list[EffectFinding]:
    """The candidates worth a row: the likely ones and the selected ones."""
    likely = [e for e in diagnosis.effects if e.probability >= LEAST or e.name in diagnosis.selected]
    kept = [e for rank, e in enumerate(likely) if rank < SHOWN or e.name in diagnosis.selected]
    return kept or list(diagnosis.effects[:3])


def _combinations(diagnosis: Diagnosis) -> list[Block]:
    if len(diagnosis.sets) < 2:
        return []
    other = VERDICTS["unknown_effect"].lower()
    note = (
        "Which effects act together, if all of them are in the library. The probability that an effect outside the "
        f"library acts as well is that of “{other}” above."
    )
    rows = [
        [
            Cell(capital(phrases(entry["effects"], diagnosis.system)) if entry["effects"] else "None"),
            Cell(numbers.probability(entry["probability"]), share=entry["probability"]),
        ]
        for entry in diagnosis.sets[:_NUM_SETS]
    ]
    table = Table(columns=("Effects together", "Probability"), rows=rows)
    return [Text(title="Combinations", text=note, note=True), table]


def _ties(diagnosis: Diagnosis) -> Block:
    title = "Effects that these data cannot tell apart"
    if not diagnosis.indistinguishable:
        return Text(title=title, text="No candidates are tied.")
    groups = [capital(phrases(group, diagnosis.system, last="or")) for group in diagnosis.indistinguishable]
    return Points(title=title, items=[(group, "") for group in groups], brief=True)


def _blind_spots(diagnosis: Diagnosis) -> Block:
    title = "Effects that these data cannot show"
    if not diagnosis.invisible:
        return Text(title=title, text="None: every effect considered would have left a trace in these data.")
    names = capital(phrases(diagnosis.invisible, diagnosis.system, last="or"))
    text = f"{names} would leave no trace in these data. A low probability of such an effect means nothing."
    return Text(title=title, text=text, brief=True)
