"""Whether an input that is said to be held between its samples was smooth: a torque that was measured, or computed
without steps. Held, it comes half a sample late, which no effect of the library mends."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

from tendonlab.data import Dataset
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case, make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.problem import Fitter
from tendonlab.fitting.rough import ROUGH
from tendonlab.fitting.thinning import thinned
from tendonlab.simulation.prepare import Prepared
from tendonlab.simulation.system import System

LEFT = 0.5  # share of what lies above the sensors' noise that straight lines may leave, to be believed
EXPLAINED = 1.3  # mean square, in units of that noise, below which held samples explain the logs

DRAWN = (
    "{} is taken as straight between its samples. Held, it leaves {:.3g} times the mean square error. State hold = "
    "false, or hold = true if it is a computer's command."
)
DOUBTED = (
    "{} is stated as held between its samples (hold = true). Held, it leaves {:.3g} times the mean square error that "
    "straight lines between the samples leave. State hold = false if it was measured, or is no computer's command."
)


@dataclass(frozen=True)
class Straight:
    """The `dataset` with its held `inputs` straight between their samples, and the share of the mean square error that
    this leaves."""

    dataset: Dataset
    left: float
    inputs: tuple[str, ...]

    @property
    def is_stated_otherwise(self) -> bool:
        """Whether the user states that one of them is held."""
        return any(self.dataset.signals[name].hold_stated for name in self.inputs)

    @property
    def words(self) -> str:
        """The warning that says so."""
        names = " and ".join(self.inputs)
        return (DOUBTED if self.is_stated_otherwise else DRAWN).format(names, 1.0 / self.left)


def straight_inputs(dataset: Dataset, system: System, search: Search, shop: Workshop) -> Straight | None:
    """Of an open loop: its inputs straight between their samples, where the final model then leaves less than half of
    what it leaves above the sensors' noise; else None."""
    names = tuple(_held(dataset, system))
    if not names or dataset.controller is not None or system.info.sampled:
        return None
    drawn = _straight(dataset, names)
    try:
        held = _under_white(search.fitter.case, search.final, shop, solve=False)
        if held.mean_square < EXPLAINED:
            return None
        case = make_case(thinned(drawn, system), system)
        left = _under_white(case, search.final, shop, solve=False)
        if left.mean_square > held.mean_square:  # as the model is, which was fitted to held samples
            return None
        held, left = _under_white(search.fitter.case, held, shop), _under_white(case, left, shop)
    except NumericalError:
        return None
    if held.mean_square < EXPLAINED:
        return None
    more, less = held.mean_square - 1.0, left.mean_square - 1.0
    return Straight(drawn, left.mean_square / held.mean_square, names) if less < LEFT * more else None


def _held(dataset: Dataset, system: System) -> Iterable[str]:
    """Names of the held inputs that drive it; a switch is none."""
    drives = {given.name for given in system.info.inputs if given.dimension != "ratio"}
    return (name for name, spec in dataset.signals.items() if spec.role == "input" and spec.hold and name in drives)


def _straight(dataset: Dataset, names: Iterable[str]) -> Dataset:
    free = dict.fromkeys(names, False)
    signals = {name: replace(spec, hold=free.get(name, spec.hold)) for name, spec in dataset.signals.items()}
    runs = tuple(replace(e, holds=e.holds | free) for e in dataset.experiments)
    return replace(dataset, signals=signals, experiments=runs)


def _under_white(case: Case, model: Fitted, shop: Workshop, *, solve: bool = True) -> Fitted:
    """The model under the sensors' noise alone, fitted where asked to `solve`."""
    fitter = Fitter(replace(case, scatter=()), white(case.noise), shop.cancel)
    initial = [own[: len(ready.initial)] for own, ready in zip(model.initial, _training(case), strict=True)]
    return fitter.fit(model.system, added=model.added, initial=initial, max_iterations=ROUGH, solve=solve)


def _training(case: Case) -> list[Prepared]:
    return [case.prepared[i] for i in case.train]
