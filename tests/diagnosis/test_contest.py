"""What is established: bars and the share of the error that an effect must remove, on stated numbers."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.diagnosis.search import contest
from tendonlab.diagnosis.search.contest import _worth_adding, probabilities
from tendonlab.diagnosis.search.refit import _goal, _needed, strained
from tendonlab.diagnosis.search.screen import _residuals_with, _score, _starts, _unit
from tendonlab.diagnosis.search.screen import _Score as Score
from tendonlab.diagnosis.search.trial import (
    DETECT,
    Bar,
    Trial,
    bar_for_further_effect,
    explains_enough,
    is_no_shape,
)
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.priors import AMPLITUDE_SD
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.prepare import Replay


def trial(
    effect: str, gain: float, *, left_out: float = 100.0, doubt: float = 0.0, lost: float = 0.0, **fitted: Any
) -> Any:
    return Trial(effect, SimpleNamespace(**fitted), gain, left_out, doubt, lost)  # type: ignore[arg-type]


INJECTION = Replay("injection")


def fitter_of(*, repeated: bool, bodies: int = 1, replay: Replay = INJECTION) -> Any:
    prepared = [SimpleNamespace(core=SimpleNamespace(position=bodies * [0.0]))]
    case = SimpleNamespace(prepared=prepared, replay=replay)
    return SimpleNamespace(floor=SimpleNamespace(repeated=repeated), case=case)


@pytest.mark.parametrize(
    ("bar", "evidence", "left_out", "doubt", "passed"),
    [
        (DETECT, 10.1, 3.1, 50.0, True),
        (DETECT, 9.9, 3.1, 0.0, False),
        (DETECT, 10.1, 2.9, 0.0, False),
        (Bar(30.0, 9.0, doubted=True), 31.0, 9.5, 8.0, True),
        (Bar(30.0, 9.0, doubted=True), 31.0, 9.5, 9.6, False),
        (Bar(30.0, 9.0, doubted=True), 31.0, 8.5, 0.0, False),
    ],
)
def test_a_bar_asks_for_evidence_and_for_left_out_experiments_beyond_doubt(
    bar: Bar, evidence: float, left_out: float, doubt: float, passed: bool
) -> None:
    assert bar.passed(trial("a", evidence, left_out=left_out, doubt=doubt)) == passed


def test_the_bar_of_a_further_effect_is_higher_where_runs_repeat() -> None:
    assert bar_for_further_effect(fitter_of(repeated=True)) == Bar(30.0, 9.0, doubted=True)
    assert bar_for_further_effect(fitter_of(repeated=False)) == Bar(10.0, 3.0, doubted=True)


@pytest.mark.parametrize(
    ("gain", "largest", "left", "no_shape"),
    [
        (90.0, 8_900.0, 2.7, True),  # one per cent of what the first effect gained
        (90.0, 9_100.0, 2.7, False),
        (110.0, 1e6, 1.9, True),  # or a weak effect behind a dominant one, which leaves little
        (90.0, 1e6, 1.9, False),
        (900.0, 8_900.0, 2.85, False),  # less than a tenth of what is left
        (900.0, 8_900.0, 2.75, True),
    ],
)
def test_a_further_effect_is_no_error_of_a_shape_where_it_gains_much_or_leaves_little(
    gain: float, largest: float, left: float, no_shape: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contest, "predicts_better", lambda *_: True)
    base: Any = SimpleNamespace(mean_square=3.0, runs=range(7), added=("first",))
    trials = [trial("a", gain, mean_square=left), trial("b", 0.6 * gain, mean_square=2.95)]
    assert is_no_shape(base, trials, largest) == no_shape
    fitter = fitter_of(repeated=True)
    assert _worth_adding(fitter, base, trials, further=True, largest_gain=largest) == no_shape
    assert _worth_adding(fitter, base, trials, further=False, largest_gain=largest)


LAW = SimpleNamespace(parameters=(), element="joint", roles=0, sees=0)
SYSTEM = SimpleNamespace(info=SimpleNamespace(effect=lambda _: LAW))
EMPTY: dict[str, Any] = {"free": (), "x": (), "system": SYSTEM}  # a model without free parameters


def test_a_trial_gains_what_its_model_has_over_the_one_it_extends() -> None:
    """Rows of the base count as those of the extended model; doubt is that of the gains of the experiments."""
    scores = np.array([5.0, 1.0, 2.0])
    base = SimpleNamespace(evidence=-50.0, left_out=scores, counted=lambda shares: counted.append(shares) or base)
    base.free, base.x = (), ()
    counted: list[Any] = []
    fitted = SimpleNamespace(
        evidence=-20.0,
        left_out=scores + np.array([10.0, -1.0, 4.0]),
        shares=(0.5,),
        by_experiment=lambda gains: gains[:3],
        **EMPTY,
    )
    made = Trial.of("a", fitted, base)  # type: ignore[arg-type]
    assert (made.evidence_gain, made.left_out_gain, counted) == (30.0, 13.0, [(0.5,)])
    assert made.doubt == 5.0  # five times the loss of one nat
    assert made.lost == pytest.approx(1.0 / 14.0)


@pytest.mark.parametrize(
    ("rivals", "left", "enough"),
    [
        ([], 6.8, True),  # alone: a third of 9.0 must go
        ([], 6.9, False),
        ([40.0], 6.8, True),
        ([60.0], 6.0, False),  # a rival gains half as much: half must go
        ([60.0], 5.4, True),
        ([98.0], 6.8, True),  # says the same as the first
    ],
)
def test_without_repeats_an_effect_must_remove_much_of_what_is_left(
    rivals: list[float], left: float, enough: bool
) -> None:
    base: Any = SimpleNamespace(mean_square=10.0)
    trials = [trial("a", 100.0, mean_square=left), *(trial("b", gain, mean_square=9.0) for gain in rivals)]
    assert explains_enough(base, trials) == enough


@pytest.mark.parametrize(
    ("base", "first", "gain", "lost", "further", "better", "worth"),
    [
        (1.2, 1.17, 50.0, 0.1, False, True, False),  # near the floor an effect must matter
        (1.2, 1.10, 11.0, 0.01, False, True, True),
        (1.2, 1.10, 11.0, 0.01, False, False, False),
        (1.2, 1.10, 11.0, 0.1, False, True, False),  # and help in each experiment
        (1.2, 1.17, 50.0, 0.01, False, True, True),  # or tell clearly
        (1.2, 1.17, 29.0, 0.01, False, True, False),
        (2.4, 1.4, 500.0, 0.1, False, True, False),  # not far above it an effect must help in each experiment
        (2.4, 1.4, 500.0, 0.01, False, False, True),
        (5.0, 4.9, 11.0, 0.1, False, False, True),  # far from the floor the first effect needs no halves
        (5.0, 4.5, 50.0, 0.1, True, False, False),
        (5.0, 4.5, 50.0, 0.1, True, True, True),
    ],
)
def test_near_the_floor_and_beyond_the_first_effect_halves_decide(
    base: float,
    first: float,
    gain: float,
    lost: float,
    further: bool,
    better: bool,
    worth: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(contest, "predicts_better", lambda *_: better)
    of: Any = SimpleNamespace(mean_square=base, runs=range(7), added=())
    leader = trial("a", gain, lost=lost, mean_square=first)
    assert _worth_adding(fitter_of(repeated=True), of, [leader], further=further) == worth


@pytest.mark.parametrize(("num", "worth"), [(4, False), (5, True)])
def test_that_an_effect_helps_in_each_of_few_experiments_says_little(
    num: int, worth: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contest, "predicts_better", lambda *_: True)
    of: Any = SimpleNamespace(mean_square=1.2, runs=range(num), added=())
    leader = trial("a", 50.0, lost=0.0, mean_square=1.17)
    assert _worth_adding(fitter_of(repeated=True), of, [leader], further=False) == worth


def beside(effect: str, gain: float, left: float) -> Any:
    """A trial beside friction of the joint."""
    system = SimpleNamespace(info=tl.system_info("two_inertia"))
    return replace(trial(effect, gain, mean_square=left, system=system), has_shape=not effect.endswith("bias"))


@pytest.mark.parametrize(
    ("effect", "gain", "left", "worth"),
    [
        ("joint:presliding", 90.0, 1.17, False),
        ("joint:presliding", 110.0, 1.17, True),
        ("joint:stribeck", 500.0, 1.13, False),  # whatever it gains: 5.8 % of what is left
        ("joint:stribeck", 50.0, 1.125, True),
        ("motor:stribeck", 40.0, 1.17, True),
        ("sensor.joint_angle:bias", 40.0, 1.17, True),
    ],
)
def test_near_the_floor_friction_beside_friction_may_be_an_error_of_its_shape(
    effect: str, gain: float, left: float, worth: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Viscous friction of another form looked like 475 nats of Stribeck friction."""
    monkeypatch.setattr(contest, "predicts_better", lambda *_: True)
    of: Any = SimpleNamespace(mean_square=1.2, runs=range(7), added=("joint:viscous",))
    fitter = fitter_of(repeated=True)
    assert _worth_adding(fitter, of, [beside(effect, gain, left)], further=True, largest_gain=50.0) == worth


@pytest.mark.parametrize(
    ("effect", "left", "worth"),
    [
        ("joint:stribeck", 2.1, False),
        ("joint:stribeck", 1.9, True),
        ("joint:asymmetry", 2.1, True),  # no level of its own
        ("motor:stribeck", 2.1, True),
    ],
)
def test_without_repeats_a_second_level_of_friction_must_remove_half_of_the_rest(
    effect: str, left: float, worth: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dry friction of another form than the library's looks like two levels."""
    monkeypatch.setattr(contest, "predicts_better", lambda *_: True)
    monkeypatch.setattr(contest, "may_be_noise", lambda *_: True)
    of: Any = SimpleNamespace(mean_square=3.0, runs=range(7), added=("joint:coulomb",))
    fitter = fitter_of(repeated=False)
    assert _worth_adding(fitter, of, [beside(effect, 200.0, left)], further=True) == worth


@pytest.mark.parametrize(
    ("repeated", "further", "near", "gain", "first"),
    [
        (True, False, 2.0, 300.0, "c"),
        (True, False, 2.0, 190.0, "a"),  # less than a fifth of what the first one gains
        (True, False, 1.52, 300.0, "a"),  # it removes less than a tenth of what is left
        (False, False, 2.0, 300.0, "a"),
        (True, True, 2.0, 300.0, "a"),
        (True, False, 3.0, 300.0, "a"),
    ],
)
def test_of_two_missing_effects_the_one_that_helps_in_each_experiment_comes_first(
    repeated: bool, further: bool, near: float, gain: float, first: str
) -> None:
    """Not far above a floor from repeats: there an effect that costs single experiments is not established."""
    of: Any = SimpleNamespace(mean_square=near)
    trials = [
        trial("a", 1000.0, left_out=1000.0, lost=0.07, mean_square=1.2),
        trial("b", 900.0, left_out=900.0, lost=0.03, mean_square=1.2),
        trial("c", gain, left_out=gain, mean_square=1.5),
        trial("d", 0.9 * gain, left_out=0.9 * gain, mean_square=1.5),
    ]
    found = contest._steadier_first(fitter_of(repeated=repeated), of, trials, further=further)
    assert found[0].effect == first
    assert sorted(t.effect for t in found) == ["a", "b", "c", "d"]


@pytest.mark.parametrize(
    ("bodies", "replay", "worth"),
    [
        (1, INJECTION, True),
        (2, INJECTION, False),
        (2, Replay("controller"), True),
        (2, Replay("controller", feeds_noise=True), False),
    ],
)
def test_near_the_floor_evidence_alone_says_little_where_noise_is_carried_into_several_bodies(
    bodies: int, replay: Replay, worth: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contest, "predicts_better", lambda *_: True)
    system = SimpleNamespace(info=tl.system_info("two_inertia"))
    of: Any = SimpleNamespace(mean_square=1.2, cost=1000.0, runs=range(7), system=system, added=())
    fitter = fitter_of(repeated=True, bodies=bodies, replay=replay)

    def is_worth(effect: str) -> bool:
        return _worth_adding(fitter, of, [trial(effect, 50.0, lost=0.0, mean_square=1.17)], further=False)

    assert is_worth("joint:presliding") == is_worth("sensor.joint_angle:delay") == worth
    assert is_worth("sensor.joint_angle:bias")  # noise imitates no constant
    assert contest._least_gain(fitter, of, DETECT) == (contest.CLEAR.evidence if worth else 50.0)


@pytest.mark.parametrize(("noise", "better", "worth"), [(True, True, True), (True, False, False), (False, True, False)])
def test_without_repeats_little_is_enough_where_what_is_left_may_be_noise(
    noise: bool, better: bool, worth: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(contest, "predicts_better", lambda *_: better)
    monkeypatch.setattr(contest, "may_be_noise", lambda *_: noise)
    of: Any = SimpleNamespace(mean_square=6.6, runs=range(7), added=())
    trials = [trial("a", 50.0, mean_square=4.9), trial("b", 49.0, mean_square=5.0)]
    assert _worth_adding(fitter_of(repeated=False), of, trials, further=False) == worth


def test_where_nothing_is_left_nothing_explains_enough() -> None:
    """Half of what a model leaves below the floor is no bar."""
    base: Any = SimpleNamespace(mean_square=0.9)
    assert not explains_enough(base, [trial("a", 100.0, mean_square=0.8)])


def test_halves_are_predicted_better_only_beyond_doubt(monkeypatch: pytest.MonkeyPatch) -> None:
    from tendonlab.diagnosis.search import halves

    scores = {"base": np.array([1.0, 2.0]), "better": np.array([9.0, 9.0]), "mixed": np.array([9.0, -7.0])}
    monkeypatch.setattr(halves, "_scores", lambda fitter, model, odd: scores[model.name])
    base, better, mixed = (SimpleNamespace(name=n, shares=None, counted=lambda s: base) for n in scores)
    assert halves.predicts_better(fitter_of(repeated=True), base, better)  # type: ignore[arg-type]
    assert not halves.predicts_better(fitter_of(repeated=True), base, mixed)  # type: ignore[arg-type]
    assert not halves.predicts_better(fitter_of(repeated=True), better, base)  # type: ignore[arg-type]


def evident(evidence: float, **more: Any) -> Any:
    model = SimpleNamespace(evidence=evidence, **more)
    model.counted = lambda: model
    return model


def test_a_sketch_is_finished_where_it_can_reach_half_of_the_rivals_gain() -> None:
    base = evident(-100.0, cost=90.0, runs=[SimpleNamespace(residual=np.zeros(50))] * 2)
    repeated, alone = fitter_of(repeated=True), fitter_of(repeated=False)
    assert _needed(base, None, -60.0) == pytest.approx(0.5 * 40.0)
    assert _needed(base, evident(-30.0), -60.0) == pytest.approx(20.0)  # 50 nats behind the best
    assert _needed(base, evident(20.0), -60.0) == pytest.approx(70.0)
    assert _goal(repeated, base, 20.0) == pytest.approx(90.0 - 20.0)
    assert _goal(alone, base, 20.0) == pytest.approx(90.0 * np.exp(-2.0 * 20.0 / 100))
    assert 1e300 < _goal(alone, base, -1e9) < np.inf  # a rival far behind the base sets no goal


def test_a_parameter_three_sd_from_its_prior_is_strained_if_it_was_stated() -> None:
    def base(x: float) -> Any:
        return SimpleNamespace(free=[SimpleNamespace(name="inertia", mean=1.0, sd=0.5)], x=[x])

    def fitter(name: str) -> Any:
        return SimpleNamespace(case=SimpleNamespace(dataset=SimpleNamespace(parameters={name: None})))

    assert not strained(fitter("inertia"), base(2.4))
    assert not strained(fitter("inertia"), base(-0.4))
    assert strained(fitter("inertia"), base(2.6))
    assert strained(fitter("inertia"), base(-0.6))
    assert not strained(fitter("mass"), base(2.6))


def test_fits_start_from_the_best_score_and_from_the_best_of_another_shape() -> None:
    scores = [
        Score(9.0, {"a": 1.0, "s": 2.0}, 0.0),
        Score(8.0, {"a": 3.0, "s": 2.0}, 0.0),
        Score(7.0, {"a": 1.0, "s": 5.0}, 0.0),
    ]
    assert _starts(scores, "s") == ({"a": 1.0, "s": 2.0}, {"a": 1.0, "s": 5.0})
    assert _starts(scores, None) == ({"a": 1.0, "s": 2.0},)
    assert _starts(scores[:2], "s") == ({"a": 1.0, "s": 2.0},)


def test_the_gain_of_a_candidate_is_that_of_least_squares_with_the_free_parameters(
    fitter: Fitter, nominal: Fitted
) -> None:
    """An offset of the command, nearly linear: its column and those of the free parameters in one dense problem."""
    (name,) = nominal.system.info.effect("actuation:offset").parameters
    p = nominal.system.info.parameter(name)
    unit, amplitude = _unit(fitter.case, p), 0.1
    values = {name: amplitude * unit}
    (residuals,) = _residuals_with(fitter, nominal, "actuation:offset", [values])
    assert not isinstance(residuals, str)
    found = _score(fitter.case, nominal, p, amplitude, values, residuals)

    moved = nominal.system.with_effects({"actuation:offset": values})
    rows, residual = [], np.concatenate([b.residual for b in nominal.blocks])
    for t, i in enumerate(fitter.case.train):
        outputs = fitter.case.run(i, moved, nominal.initial[t])["outputs"]
        here = [b for b in nominal.blocks if b.experiment == t]
        changed = nominal.split(t, fitter.whitening[i].residual(outputs))
        for block, new in zip(here, changed, strict=True):
            rows.append(np.column_stack([(new - block.residual) / amplitude, block.jacobian]))
    belief = np.diag([1.0 / AMPLITUDE_SD, *(1.0 / f.sd for f in nominal.free)])
    matrix = np.concatenate([*rows, belief])
    target = np.concatenate([-residual, np.zeros(len(belief))])

    def misfit(columns: np.ndarray) -> tuple[np.ndarray, float]:
        x = np.linalg.lstsq(columns, target, rcond=None)[0]
        return x, 0.5 * float(np.sum(np.square(columns @ x - target)))

    (best, with_effect), (_, without) = misfit(matrix), misfit(matrix[:, 1:])
    assert found.gain == pytest.approx(without - with_effect, rel=1e-6)
    assert found.start[name] == pytest.approx(best[0] * unit, rel=1e-6)
    information = np.linalg.inv(np.linalg.inv(matrix.T @ matrix)[:1, :1])[0, 0] - AMPLITUDE_SD**-2.0
    assert found.visibility == pytest.approx(0.5 * information, rel=1e-6)  # of an effect of one unit


def test_gains_over_a_model_without_evidence_are_finite() -> None:
    """Where derivatives explode, the model without the effect has no evidence; probabilities stay numbers."""
    scores = np.array([1.0, 2.0])
    base = SimpleNamespace(evidence=-np.inf, left_out=-np.inf * scores, counted=lambda shares: base, **EMPTY)
    fitted = SimpleNamespace(evidence=5.0, left_out=scores, shares=None, by_experiment=lambda gains: gains, **EMPTY)
    made = Trial.of("a", fitted, base)  # type: ignore[arg-type]
    assert made.evidence_gain == 1e9
    assert made.left_out_gain == 2e9
    share = probabilities([made], {"a"}, DETECT, 4.0)
    assert share["a"] == pytest.approx(1.0)


def test_near_the_floor_an_effect_must_gain_more() -> None:
    def least(mean_square: float, cost: float) -> float:
        base: Any = SimpleNamespace(mean_square=mean_square, cost=cost, runs=range(7))
        return contest._least_gain(fitter_of(repeated=True), base, DETECT)

    assert least(1.2, 1000.0) == contest.CLEAR.evidence > DETECT.evidence
    assert least(1.2, 400.0) == pytest.approx(20.0)  # a twentieth of the cost matters
    assert least(1.4, 1000.0) == DETECT.evidence
