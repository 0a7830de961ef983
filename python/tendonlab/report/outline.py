"""The sections of a report, in order: what the page shows in full and the terminal in brief."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from tendonlab.report.blocks import Block
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.sections.causes import causes
from tendonlab.report.sections.computation import computation
from tendonlab.report.sections.extent import extent
from tendonlab.report.sections.location import location
from tendonlab.report.sections.logs import problems, warnings
from tendonlab.report.sections.next_steps import next_steps


def _always(_: Diagnosis) -> bool:
    return True


def _judged(diagnosis: Diagnosis) -> bool:
    """Whether anything is said about effects."""
    return diagnosis.verdict != "data_fault"


@dataclass(frozen=True)
class Section:
    """`name`: its anchor on the page. `render` gives its blocks, `when` says whether it is shown at all."""

    name: str
    title: str
    subtitle: str
    render: Callable[[Diagnosis], Sequence[Block]]
    when: Callable[[Diagnosis], bool] = _always


SECTIONS = (
    Section("data", "Data", "what looks wrong with the logs themselves", problems, when=lambda why: bool(why.data)),
    Section("where", "Where", "which signal, element and regime carries the gap", location, when=_judged),
    Section(
        "which", "Which", "candidate effects, and the probability that each is part of the cause", causes, when=_judged
    ),
    Section("how-far", "How far", "the held-out gap, against the noise floor", extent),
    Section("next", "What next", "the measurements that would decide most", next_steps),
    Section("warnings", "Warnings", "", warnings),
    Section("computed", "How this was computed", "", computation),
)
