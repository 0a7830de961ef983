"""Refits of candidates: which of two fits is kept, where fits start, and when a sketch is finished."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.diagnosis.search import refit as refits
from tendonlab.diagnosis.search.refit import SKETCH, _annealed, more_evident, restarted
from tendonlab.diagnosis.search.screen import Screened
from tendonlab.errors import NumericalError
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter


def with_evidence(fitted: Fitted, evidence: float) -> Fitted:
    """The same fit with its evidence already computed, as cached_property stores it."""
    made = replace(fitted)
    made.__dict__["evidence"] = evidence
    return made


@pytest.mark.parametrize(
    ("evidences", "expected"), [((5.0, math.inf), 5.0), ((5.0, math.nan), 5.0), ((3.0, 4.0), 4.0), ((4.0, 3.0), 4.0)]
)
def test_a_fit_whose_derivatives_exploded_outbids_nothing(
    nominal: Fitted, evidences: tuple[float, ...], expected: float
) -> None:
    best = None
    for evidence in evidences:
        best = more_evident(best, with_evidence(nominal, evidence))
    assert best is not None
    assert best.evidence == expected


def test_where_no_fit_succeeds_the_reason_is_told(nominal: Fitted, monkeypatch: pytest.MonkeyPatch) -> None:
    """The last fit's, that of derivatives that exploded, or the screen's where that had the candidate fail already."""
    nothing: Any = None
    monkeypatch.setattr(refits, "strained", lambda *_: False)
    outcomes: list[Any] = [NumericalError("a"), NumericalError("b"), NumericalError("c")]
    monkeypatch.setattr(refits, "_fit", lambda *_, **__: raised(outcomes.pop(0)))
    with pytest.raises(NumericalError, match=r"^c$"):
        refits.refit(nothing, nothing, Screened("x", 1.0, ({}, {}), 1.0), pace=0.0)
    assert not outcomes
    outcomes = [(with_evidence(nominal, math.nan), None)] * 2
    with pytest.raises(NumericalError, match="derivatives"):
        refits.refit(nothing, nothing, Screened("x", 1.0, ({},), 1.0), pace=0.0)


def raised(outcome: Any) -> Any:
    """The outcome of a fit: itself, or raised."""
    if isinstance(outcome, Exception):
        raise outcome
    return outcome


def test_exact_twins_end_with_one_evidence(fitter: Fitter, nominal: Fitted) -> None:
    """A delay of the joint's sensor from a poor place, beside one that was fitted; and a better fit stays as it is."""
    name = "sensor.joint_angle:delay"
    added = nominal.system.with_effects({name: {"delay": 1e-3}})
    leader = fitter.settled(fitter.fit(added, added=(name,)))
    astray = added.with_parameters({"joint_inertia": 3.0 * added.parameters["joint_inertia"]})
    poor = fitter.fit(astray, added=(name,), solve=False)
    found = restarted(fitter, nominal, leader, poor)
    best = leader.counted().evidence
    assert poor.counted().evidence < best - 1.0
    assert found.counted().evidence == pytest.approx(best, abs=0.1)
    assert restarted(fitter, nominal, poor, leader).counted().evidence >= best


def test_a_leader_that_replaced_a_whole_friction_shares_what_it_still_has(fitter: Fitter, nominal: Fitted) -> None:
    """Parameters of the friction that it replaced are not there to be taken over."""
    lacking = fitter.case.system.with_parameters(nominal.system.parameters)
    rest = {k: v for k, v in lacking.parameters.items() if k != "joint_coulomb"}
    bare = replace(lacking, parameters=rest, effects=tuple(e for e in lacking.effects if e != "joint:coulomb"))
    leader = replace(nominal, system=bare)
    assert restarted(fitter, nominal, leader, nominal).counted().evidence >= nominal.counted().evidence


class Fits:
    """A fitter that notes what it is asked for; its fits have the costs and misfits that are stated in turn."""

    def __init__(self, *fits: Any, repeated: bool = True) -> None:
        self.fits, self.asked = list(fits), list[dict[str, Any]]()
        self.levels = list[float]()
        self.floor = SimpleNamespace(repeated=repeated)
        self.case = SimpleNamespace(dataset=SimpleNamespace(parameters={"inertia": None, "friction": None}))

    def fit(self, system: Any, **asked: Any) -> Any:
        self.asked.append({"system": system, **asked})
        found = self.fits.pop(0)
        if isinstance(found, Exception):
            raise found
        return found

    def under(self, level: float) -> Fits:
        self.levels.append(level)
        return self

    def releveled(self, fit: Any) -> Any:
        return ("sketch", fit)

    def settled(self, fit: Any) -> Any:
        return ("settled", fit)


def fit_of(misfit: float = 1.0, *, cost: float = 1.0, gain: float = 0.0, converged: bool = True) -> Any:
    fit = SimpleNamespace(
        whitened_square=misfit, cost=cost, converged=converged, system="fitted", initial=((misfit,),), evidence=gain
    )
    fit.mean_square = misfit
    fit.counted = lambda: fit
    return fit


class Rig:
    """A simulator that notes the values it is given."""

    def __init__(self, *names: str) -> None:
        self.parameters: Any = dict.fromkeys(names, 9.0)

    def with_parameters(self, values: dict[str, float]) -> Any:
        return values


def tuned() -> Any:
    free = [
        SimpleNamespace(name=name, mean=mean, value=lambda x: 10.0 * x)
        for name, mean in [("inertia", 0.2), ("friction", 0.3), ("added", 0.4)]
    ]
    base = SimpleNamespace(free=free, added=("a",), initial=((0.0,),), system="base", cost=100.0, evidence=0.0)
    base.counted = lambda: base
    return base


def test_the_start_from_believed_values_leaves_out_what_was_tuned(monkeypatch: pytest.MonkeyPatch) -> None:
    posed: dict[str, Any] = {}
    monkeypatch.setattr(refits, "pose", lambda case, floor, system, added: posed.update(system=system, added=added))
    monkeypatch.setattr(
        refits, "annealed", lambda problem, cancel: SimpleNamespace(system="annealed", initial=((1.0,),))
    )
    rig: Any = Rig("inertia", "added")  # no friction: what was tuned of it is left out
    fits: Any = Fits()
    fits.floor = fits.cancel = None
    assert _annealed(fits, tuned(), rig, ("a", "b")) == ("annealed", ((1.0,),))
    assert posed == {"system": {"inertia": 2.0}, "added": ("a", "b")}


@pytest.mark.parametrize(
    ("cost", "gain", "is_whole", "num_fits"), [(51.0, 4.0, False, 1), (49.0, 4.0, True, 1), (51.0, 6.0, True, 2)]
)
def test_a_fit_that_misses_its_goal_is_a_sketch_unless_it_gains_half_of_what_a_rival_does(
    cost: float, gain: float, is_whole: bool, num_fits: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(refits, "_goal", lambda *_: 50.0)
    started: Any = ("with b", ((3.0,),))
    monkeypatch.setattr(refits, "followed", lambda *_: started)
    fits = [fit_of(cost=cost, gain=gain), fit_of(cost=10.0, gain=9.0)][:num_fits]
    fitter: Any = Fits(*fits)
    fitter.releveled = lambda fit: fit
    worth, whole = refits._fit(fitter, tuned(), "b", {}, None, pace=10.0)
    assert (worth, whole) == (fits[-1], fits[-1] if is_whole else None)
    assert len(fitter.asked) == num_fits
    assert all(asked.get("goal") is None for asked in fitter.asked[1:])
    assert (fitter.asked[0]["added"], fitter.asked[0]["initial"]) == (("a", "b"), started[1])
    assert (fitter.asked[0]["goal"], fitter.asked[0]["goal_within"]) == (50.0, SKETCH)


@pytest.mark.parametrize(
    ("worths", "whole", "settled"),
    [([1.0, 2.0], [True, True], 2.0), ([2.0, 1.0], [True, True], 2.0), ([2.0, 1.0], [False, True], None),
     ([1.0, 2.0], [False, True], 2.0)],
)  # fmt: skip
def test_only_the_best_start_is_settled(
    worths: list[float], whole: list[bool], settled: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    fits = [SimpleNamespace(evidence=worth, mean_square=1.0) for worth in worths]
    for fit in fits:
        fit.counted = lambda fit=fit: fit
    tries = iter(zip(fits, whole, strict=True))

    def tried(*_: Any, **__: Any) -> Any:
        fit, is_whole = next(tries)
        return fit, fit if is_whole else None

    monkeypatch.setattr(refits, "_fit", tried)
    monkeypatch.setattr(refits, "strained", lambda *_: False)
    fitter: Any = SimpleNamespace(settled=lambda fit: SimpleNamespace(evidence=10.0 + fit.evidence))
    found: Any = refits.refit(fitter, fit_of(), Screened("b", 1.0, ({}, {}), 1.0), pace=0.0)
    assert found.evidence == (10.0 + settled if settled is not None else fits[0].evidence)


@pytest.mark.parametrize(
    ("pulled", "simulated", "before", "left", "nominal"),
    [(True, True, 9.0, 5.0, [False, False, True]), (True, True, 9.0, 1.2, [False, False]),
     (True, True, 1.2, 1.1, [False, False, True]), (False, True, 9.0, 5.0, [False, False]),
     (True, False, 9.0, 5.0, [True]), (False, False, 9.0, 5.0, [True])],
)  # fmt: skip
def test_a_candidate_is_fitted_from_each_start_and_from_nominal_values_where_tuning_strained_them(
    pulled: bool, simulated: bool, before: float, left: float, nominal: list[bool], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unless a fit comes near the floor, where the base was not; a candidate that was never simulated has no other
    start."""
    tried = []

    def fit(*given: Any, from_nominal: bool = False, **_: Any) -> Any:
        tried.append(from_nominal)
        return fit_of(left, gain=float(len(tried))), None

    monkeypatch.setattr(refits, "_fit", fit)
    monkeypatch.setattr(refits, "strained", lambda *_: pulled)
    monkeypatch.setattr(refits, "more_evident", lambda best, new: new)
    nothing: Any = None
    base = fit_of(before)
    found = refits.refit(nothing, base, Screened("b", 1.0, ({}, {}), 1.0, "" if simulated else "stopped"), pace=0.0)
    assert tried == nominal
    assert found is not None


@pytest.mark.parametrize("fails", [True, False])
def test_where_settling_fails_the_fit_before_counts(fails: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    fit = fit_of(gain=1.0)
    monkeypatch.setattr(refits, "_fit", lambda *_, **__: (fit, fit))
    monkeypatch.setattr(refits, "strained", lambda *_: False)
    exploded = SimpleNamespace(evidence=-math.inf)
    fitter: Any = SimpleNamespace(settled=lambda _: raised(NumericalError("diverged") if fails else exploded))
    assert refits.refit(fitter, fit_of(), Screened("b", 1.0, ({},), 1.0), pace=0.0) is fit


@pytest.mark.parametrize("poor", [False, True])
def test_a_candidate_that_promises_little_there_is_not_fitted_from_nominal_values(
    poor: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    tried = []

    def fit(*given: Any, from_nominal: bool = False, **_: Any) -> Any:
        tried.append(from_nominal)
        return fit_of(5.0, gain=1.0), None

    monkeypatch.setattr(refits, "_fit", fit)
    monkeypatch.setattr(refits, "strained", lambda *_: True)
    monkeypatch.setattr(refits, "more_evident", lambda best, new: new)
    nothing: Any = None
    base = fit_of(9.0)
    refits.refit(nothing, base, Screened("b", 1.0, ({},), 1.0, poor_when_believed=poor), pace=0.0)
    assert tried == ([False] if poor else [False, True])


@pytest.mark.parametrize(("gains", "tried"), [([-5.0, 40.0], [0.2, 0.02]), ([1.0], [0.2])])
def test_a_fit_that_leads_away_from_its_base_begins_again_with_little_of_the_effect(
    gains: list[float], tried: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """More parameters need not fit worse."""
    started = []

    def fit(_fitter: Any, _base: Any, _effect: str, start: Any, *_: Any, **__: Any) -> Any:
        started.append(start["joint_static_excess"])
        assert start["joint_stribeck_velocity"] == 0.1
        return fit_of(gain=gains[len(started) - 1]), None

    monkeypatch.setattr(refits, "_fit", fit)
    monkeypatch.setattr(refits, "strained", lambda *_: False)
    base: Any = fit_of()
    base.system = SimpleNamespace(info=tl.system_info("rigid_joint"))
    starts = ({"joint_static_excess": 0.2, "joint_stribeck_velocity": 0.1},)
    nothing: Any = None
    found = refits.refit(nothing, base, Screened("joint:stribeck", 1.0, starts, 1.0), pace=0.0)
    assert started == pytest.approx(tried)
    assert found.evidence == gains[-1]
