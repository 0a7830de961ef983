"""What a search for effects ends with: of the logs, in the replay and on the runs that tell most."""

from __future__ import annotations

import logging
from dataclasses import replace
from typing import NamedTuple

from tendonlab.data import Dataset
from tendonlab.diagnosis.answer.confirm import confirmed
from tendonlab.diagnosis.apart import told_without, without_run_apart
from tendonlab.diagnosis.discrepancy import RINGS, patterns
from tendonlab.diagnosis.floor import renewed, under_noise_floor
from tendonlab.diagnosis.holding import straight_inputs
from tendonlab.diagnosis.search.select import Search, select_effects
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.diagnosis.windows import in_windows
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import with_found_resolutions
from tendonlab.fitting.problem import PLAIN, Fitter
from tendonlab.fitting.replay import is_mostly_at_its_limit, opened
from tendonlab.fitting.rough import rough_fit
from tendonlab.fitting.thinning import thinned
from tendonlab.simulation.system import System

UNREPEATED = 0.2  # sd of friction from run to run that no friction has: the closed loop itself does not repeat
NO_REPEAT = (
    "The closed loop does not repeat, as in a limit cycle whose phase is chance. So errors are those of an injection, "
    "which follows the logged motion."
)
AT_ITS_LIMIT = (
    "The controller commands its limit most of the time, where it does not react to the sensor. So errors are those of "
    "an injection, which follows the logged motion."
)
RINGING = (
    "The closed loop rings: what the best model leaves lies about one frequency. Noise that the logs do not hold may "
    "shake a lightly damped loop. So errors are those of an injection, which follows the logged motion."
)

log = logging.getLogger("tendonlab")


class Outcome(NamedTuple):
    """A finished search; the untouched simulator, fitted in its initial states alone; the logs with their controller,
    where models were weighed without; warnings; whether models were weighed as no series of simulated rigs was whose
    truth is known: in short windows, by the command of a loop that rings, without a run."""

    search: Search
    nominal: Fitted
    loop: Case | None
    warnings: tuple[str, ...] = ()
    is_untried: bool = False

    @property
    def rings(self) -> bool:
        """Whether what the last model leaves rings, where nothing repeats: with repeats the floor holds what noise
        excites."""
        fitter, final = self.search.fitter, self.search.final
        return not fitter.floor.repeated and patterns(fitter.case, final).ringing >= RINGS


def outcome_of(dataset: Dataset, system: System, shop: Workshop) -> Outcome:
    """The outcome on a rig. Its warnings say where inputs were not held between their samples (if nobody states that
    they are, they are taken as straight), and where models were weighed in short windows."""
    dataset = with_found_resolutions(dataset)
    outcome = _searched(dataset, system, shop)
    if drawn := straight_inputs(dataset, system, outcome.search, shop):
        if not drawn.is_stated_otherwise:
            dataset, outcome = drawn.dataset, _searched(drawn.dataset, system, shop)
        outcome = outcome._replace(warnings=(*outcome.warnings, drawn.words))
    if parts := in_windows(dataset, outcome.search):
        again = _searched(parts[0], system, shop)
        if again.search.selected:
            return again._replace(warnings=(*outcome.warnings, parts[1]), is_untried=True)
    return outcome


def _searched(dataset: Dataset, system: System, shop: Workshop) -> Outcome:
    """A search of the thinned logs in the loop that tells most: their controller's, or without where that is driven by
    its limit, or where all that is left of it rings."""
    few = thinned(dataset, system)
    loop, trouble = _loop(dataset, system) if few.controller is not dataset.controller else (None, ())
    few = replace(few, warnings=(*few.warnings, *trouble))
    if is_mostly_at_its_limit(few, system):
        few = _opened(few, system, AT_ITS_LIMIT)
    outcome = _weighed(few, loop, system, shop)
    if few.controller and outcome.rings and (logged := _opened(few, system, RINGING)) is not few:
        again = _weighed(logged, loop, system, shop)
        few, outcome = (few, outcome) if again.rings else (logged, again._replace(is_untried=True))
    return _without_run_apart(few, outcome, system, shop)


def _without_run_apart(few: Dataset, outcome: Outcome, system: System, shop: Workshop) -> Outcome:
    """The outcome; or that of the other experiments, where one held most of what was left and they tell more."""
    if not (apart := without_run_apart(few, outcome.search)):
        return outcome
    others, name = apart
    again = _weighed(others, outcome.loop and outcome.loop.without(name), system, shop)
    told = told_without(name, outcome.search, again.search)
    return again._replace(warnings=(told,), is_untried=True) if told else outcome


def _weighed(few: Dataset, loop: Case | None, system: System, shop: Workshop) -> Outcome:
    """A search under the noise floor that the logs show; in an injection where the closed loop does not repeat."""
    rough, fitter = _under_floor(make_case(few, system), shop)
    if fitter.floor.tau > UNREPEATED and (logged := _opened(few, system, NO_REPEAT)) is not few:
        rough, fitter = _under_floor(make_case(logged, system), shop)
    initial = [[*states, *(0.0 for _ in fitter.case.scatter)] for states in rough.initial]
    nominal = fitter.fit(  # any: there may be no unknowns
        fitter.case.system, initial=initial, known=True, solve=any(initial), tolerance=PLAIN
    )
    tuned = _tuned(fitter, rough, nominal, initial)
    fitter, tuned = renewed(fitter, tuned, shop.pool)
    search = confirmed(select_effects(fitter, tuned, shop), shop)
    log.info("selected %s", search.selected)
    return Outcome(search, nominal, loop)


def _opened(dataset: Dataset, system: System, why: str) -> Dataset:
    """The dataset without its controller, and with the warning `why`, where every log holds what that commanded; else
    the dataset itself."""
    logged = opened(dataset, system)
    return dataset if logged is dataset else replace(logged, warnings=(*logged.warnings, why))


def _tuned(fitter: Fitter, rough: Fitted, nominal: Fitted, initial: list[list[float]]) -> Fitted:
    """The refitted simulator, from where the rough fit ended: under noise that knew nothing of friction that may be
    too stiff to be simulated as exactly as the floor requires. Then from the `nominal` simulator."""
    try:
        return fitter.fit(rough.system, initial=initial)
    except NumericalError:
        return fitter.fit(nominal.system, initial=nominal.initial)


def _loop(dataset: Dataset, system: System) -> tuple[Case | None, tuple[str, ...]]:
    """The closed loop of a rig that is weighed without; a warning where the simulator cannot run in it."""
    try:
        case = make_case(dataset, system)
    except NumericalError as error:
        return None, (f"Errors are those of an injection: the simulator does not run in its closed loop ({error}).",)
    return (case if case.replay.kind == "controller" else None), ()


def _under_floor(case: Case, shop: Workshop) -> tuple[Fitted, Fitter]:
    """A rough fit, and the fitter under the noise floor that its residuals show."""
    rough = rough_fit(case, shop.cancel)
    return rough, under_noise_floor(case, rough, shop.pool, shop.cancel)
