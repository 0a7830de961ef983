"""What a reader must know before any number: said in the first lines of a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from tendonlab.diagnosis.answer import heldout
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.answer.outlier_run import OutlierRun
from tendonlab.diagnosis.beliefs import pulled, strain
from tendonlab.diagnosis.drift import Drift
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import Floor
from tendonlab.report.numbers import number, unit_text
from tendonlab.report.words import capital, changed_friction, words

WORSE = 1.05  # ratio of held-out mean squares, above the floor, that is no accident of rounding
PULLED = 4.0  # stated standard deviations from the stated value


def caveats(
    final: Fitted,
    shown: Judged,
    drift: Drift | None = None,
    outlier: OutlierRun | None = None,
    *,
    relieved: Fitted | None = None,
) -> tuple[str, ...]:
    """A parameter that only the effects bring near its stated value, one that is far from there, a change that made
    held-out errors worse, a floor above its signal, friction that changed over the session, a run that differs from all
    others. `relieved`: the model without the effects, where these bring its parameters back to what was stated, and the
    held-out error hardly speaks for them."""
    return (
        *_relieved(shown.case, relieved, final),
        *_pulled(shown.case, final),
        *_worse(shown.stages, shown.floor, final.added),
        *_drowned(shown.case, shown.floor, shown.experiments),
        *_drifted(shown.case, drift),
        *_differs(outlier),
    )


def _relieved(case: Case, tuned: Fitted | None, final: Fitted) -> list[str]:
    far = max(pulled(case, tuned), key=lambda of: of.away, default=None) if tuned else None
    if far is None or far.away < PULLED:
        return []
    added = " and ".join(final.added)
    return [
        f"Without {added}, {words(far.name)} was fitted {far.away:.0f} standard deviations from its stated value; with "
        f"{added}, no parameter further than {strain(case, final):.1f} from its own. What was stated speaks for "
        f"{added} where the held-out error does not."
    ]


def _pulled(case: Case, final: Fitted) -> list[str]:
    said = []
    for of in pulled(case, final):
        if of.away > PULLED:
            fitted = f"{number(of.value)} {unit_text(final.system.unit(of.name))}".rstrip()
            said.append(
                f"{capital(words(of.name))} was fitted at {fitted}: {of.away:.0f} standard deviations from the stated "
                f"{number(of.stated)} ± {number(of.sd, 2)}{', in its logarithm' if of.by_factor else ''}."
            )
    return said


def _worse(stages: Mapping[str, Replayed], floor: Floor, added: Sequence[str]) -> list[str]:
    error = {stage: float(np.sqrt(heldout.level(of, floor))) for stage, of in stages.items()}
    steps = [("nominal", "refitted", "Tuning the parameters")]
    steps += [("refitted", "with_effect", f"Adding {' and '.join(added)}")] if added else []
    whole = f"; with {' and '.join(added)}, {number(error['with_effect'])}" if added else ""
    return [
        f"{change} made the held-out error larger: {number(error[before])} noise floors before, "
        f"{number(error[after])} after{whole if before == 'nominal' else ''}."
        for before, after, change in steps
        if error[after] ** 2 > WORSE * max(1.0, error[before] ** 2)
    ]


def drowned(case: Case, floor: Floor, judged: Sequence[int]) -> dict[int, float]:
    """The outputs whose noise floor exceeds their motion in the experiments `judged`, with the rms of that motion."""
    swings = {}
    for c in case.measured:
        records = [case.prepared[i].measured[c] for i in judged]
        swing = float(np.sqrt(np.mean([np.nanvar(row) for row in records if np.isfinite(row).any()] or [np.nan])))
        if floor.rms[c] > swing:
            swings[c] = swing
    return swings


def _drowned(case: Case, floor: Floor, judged: Sequence[int]) -> list[str]:
    return [
        f"The noise floor of {case.outputs[c]} ({number(floor.rms[c], 2)}) exceeds its motion (rms "
        f"{number(swing, 2)}), so this output supports no conclusion."
        for c, swing in drowned(case, floor, judged).items()
    ]


def _differs(outlier: OutlierRun | None) -> list[str]:
    if outlier is None:
        return []
    error, rest = np.sqrt(outlier.level), np.sqrt(outlier.others)
    return [
        f"Of the training runs, {outlier.name} alone leaves an error of {error:.2g} noise floors; the others leave "
        f"{rest:.2g}. The verdict does not count {outlier.name}. Where a mechanism stops may depend on noise alone, or "
        "something happened in that run: look at it."
    ]


def _drifted(case: Case, drift: Drift | None) -> list[str]:
    if drift is None or not drift.tells:
        return []
    change = changed_friction(drift.element, drift.change, case.system.kind)
    return [
        f"{capital(change)} over the session, and no effect of the library changes over a session: look for warming, "
        "wear, lost pretension, or a condition that changed with the order of the runs. In a random order the chance "
        f"of such a trend would be {drift.chance:.1g}."
    ]
