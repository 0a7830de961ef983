"""The check of a dataset's logs: before anything is believed about effects."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from tendonlab.checking.aligned import confirmed
from tendonlab.checking.clocks import clock_findings, striking_findings
from tendonlab.checking.copies import copy_findings
from tendonlab.checking.dead import dead_outputs
from tendonlab.checking.driven import free_runs
from tendonlab.checking.equation import Equation
from tendonlab.checking.exchanged import exchanged
from tendonlab.checking.finding import PROBLEMS, Check, Finding
from tendonlab.checking.free import free_case
from tendonlab.checking.lags import lags
from tendonlab.checking.logs import Logs, read_logs
from tendonlab.checking.odd import odd_channels, odd_clocks, owned
from tendonlab.checking.odd_units import odd_units
from tendonlab.checking.proportions import odd_proportions
from tendonlab.checking.replayed import late_by_replay
from tendonlab.checking.samples import sample_findings
from tendonlab.checking.scales import wrong_factors
from tendonlab.checking.silent import all_at_rest, silent_inputs
from tendonlab.checking.spikes import Marks, marks
from tendonlab.checking.stamps import strange_steps
from tendonlab.checking.tensions import pushing_cables
from tendonlab.data import Dataset, NominalParameter, require_dataset, simulator_of
from tendonlab.simulation.system import System
from tendonlab.threads import with_one_blas_thread

EXPLAINED = 0.5  # level of the residual beyond which the equation explains too little to tell a lag
UNMOVED = "Signs, scales and lags could not be checked: no position that the system knows was measured in motion."
UNTIMED = "Signs, scales and lags could not be checked: {kind} has steady points, no time."
UNDRIVEN = "Lags could not be checked: the motor is off, and free motion is alike at any time."
UNEXPLAINED = (
    "Lags could not be checked: no lag brings these logs close to the simulator's equations. The check ignores effects "
    "with memory, such as presliding. Parameters far off or a missing effect may be the cause as well."
)


@with_one_blas_thread
def check(dataset: Dataset, *, system: System | None = None) -> Check:
    """Say what looks wrong with the logs of `dataset` themselves: signs, scales and units, lags, stamps, outliers,
    limits, copies. `system`: the simulator (the dataset's own unless given), whose equation of motion must hold.

    Experiments that look late are simulated, and so are rigs whose motor is not commanded: that takes seconds. How it
    works: docs/method.md."""
    require_dataset(dataset)
    system = simulator_of(dataset, system)
    marked = {} if system.info.steady else marks(dataset)
    found, notes = [*copy_findings(dataset), *sample_findings(dataset, marked)], []
    first = [*pushing_cables(dataset, system)]
    first += [] if system.info.steady else [*odd_clocks(dataset), *dead_outputs(dataset, system)]
    if first:  # all else is judged once these are corrected
        found += first
    elif system.info.steady:
        notes.append(UNTIMED.format(kind=system.kind))
    elif (logs := read_logs(dataset, system.info, marked)) is None:
        found += all_at_rest(dataset, system)
        notes.append(UNMOVED)
    else:
        more, notes = _by_the_equation(Equation(dataset, system), logs, marked)
        found += more
    found.sort(key=lambda f: (not f.blocks, PROBLEMS.index(f.problem)))
    return Check(dataset=dataset.name, findings=tuple(found), notes=tuple(notes))


@with_one_blas_thread
def late_experiments(dataset: Dataset, system: System) -> tuple[Finding, ...]:
    """The experiments alone whose outputs lag the inputs otherwise than in the others, by the equation of `system`: a
    large effect hides a lag, and a simulator that has the effect shows the lag. How large the effect is, the late
    experiment may have misled: that stays free."""
    if system.info.steady or (logs := read_logs(dataset, system.info, marked := marks(dataset))) is None:
        return ()
    own = [name for effect in system.effects for name in system.info.effect(effect).parameters]
    amplitudes = [name for name in own if name in system.parameters and system.info.parameter(name).amplitude]
    added = {name: NominalParameter(value=system.parameters[name]) for name in amplitudes}
    free = replace(dataset, parameters={**added, **dataset.parameters})
    late, _ = _clocks(Equation(free, system), logs, marked, simulated=False)
    return tuple(finding for finding in confirmed(late, dataset, system) if finding.blocks)


def _by_the_equation(equation: Equation, logs: Logs, marked: Marks) -> tuple[list[Finding], list[str]]:
    steps = strange_steps(equation, logs)
    if any(f.blocks for f in steps):
        return steps, []
    wrong = odd_units(equation, logs) or exchanged(equation, logs, marked)
    wrong = wrong or owned(wrong_factors(equation, logs), equation, logs, marked)
    wrong = wrong or odd_channels(equation, logs, marked)
    beside = None if wrong else free_case(equation.dataset, equation.system)
    wrong = wrong or odd_proportions(beside) or list(silent_inputs(equation, logs))
    if wrong:  # lags are judged once these are corrected
        return [*steps, *wrong], []
    alone = confirmed(late_by_replay(beside), equation.dataset, equation.system)
    if any(f.blocks for f in alone):
        return [*steps, *alone], []
    late, notes = _clocks(equation, logs, marked)
    return [*steps, *late], notes


def _clocks(
    equation: Equation, logs: Logs, marked: Marks, *, simulated: bool = True
) -> tuple[list[Finding], list[str]]:
    """Lags, of the experiments that a motor drives; where `simulated`, as a simulation confirms them."""
    if off := free_runs(equation, logs):
        driven = tuple(e for k, e in enumerate(equation.dataset) if k not in off)
        equation = Equation(replace(equation.dataset, experiments=driven), equation.system)
        left = read_logs(equation.dataset, equation.system.info, marked) if driven else None
        if left is None:
            return [], [UNDRIVEN]
        logs = left
    dataset, late = equation.dataset, lags(equation, logs)
    if late.level > EXPLAINED:
        return [], [UNEXPLAINED]
    step = float(np.median([np.median(np.diff(e.time)) for e in dataset.experiments]))
    given = late, [e.name for e in dataset.experiments], dataset.inputs, step
    if not simulated:
        return clock_findings(*given), []
    found = confirmed(clock_findings(*given), dataset, equation.system)
    if any(f.blocks for f in found):
        return found, []
    judged = {f.experiment for f in found}
    striking = [f for f in striking_findings(*given) if f.experiment not in judged]
    striking = confirmed(striking, dataset, equation.system, if_unable=False)
    return [*(f for f in striking if f.blocks), *found], []
