"""From replays to the numbers of the answer: levels over the floor, what effects explain, what cannot be seen."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.answer import answer
from tendonlab.diagnosis.answer.answer import _invisible, _levels, _next
from tendonlab.diagnosis.answer.by_noise import NO_NOISE, ByNoise
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.discrepancy import Patterns
from tendonlab.diagnosis.drift import Drift

FLOOR: Any = SimpleNamespace(rms=np.array([0.5, np.nan, 2.0]), repeated=False)
CASE: Any = SimpleNamespace(outputs=["a", "b", "c"], measured=[0, 2])


def replayed(*errors: float) -> Any:
    """Residuals of two experiments with these rms errors; the second output was not measured."""
    rows = np.array(errors)[:, None] * np.tile([1.0, -1.0], 10)
    return SimpleNamespace(residuals=[rows[:, :8], rows[:, 8:]])


@pytest.mark.parametrize("repeated", [False, True])
def test_levels_are_whitened_where_runs_repeat_and_plain_elsewhere(
    repeated: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    floor: Any = SimpleNamespace(rms=FLOOR.rms, repeated=repeated)
    stages = {
        name: replayed(0.5 * level, np.nan, 2.0 * level)
        for name, level in (("nominal", 5.0), ("refitted", 3.0), ("with_effect", 2.0))
    }
    nominal: Any = SimpleNamespace(mean_square=77.0)
    monkeypatch.setattr(answer, "patterns", lambda case, model: Patterns(0.25, 0.1, 6.0))
    monkeypatch.setattr(answer, "scattered", lambda case, model: 3.0)
    monkeypatch.setattr(answer, "strain", lambda case, model: 6.0)
    monkeypatch.setattr(answer, "restores_belief", lambda case, base, model: model.mean_square < base.mean_square)
    tuned = SimpleNamespace(system=None, mean_square=7.0, over_scatter=lambda groups: 10.0 * groups)
    run = SimpleNamespace(measured=np.array([np.tile([-0.4, 0.4], 10), np.full(20, np.nan), np.tile([-4.0, 4.0], 10)]))
    fitter = SimpleNamespace(case=SimpleNamespace(scatter=((), ()), train=range(5), measured=[0, 2], prepared=[run]))
    final = SimpleNamespace(system=None, mean_square=1.04, over_scatter=lambda groups: 5.0 * groups)
    search: Any = SimpleNamespace(tuned=tuned, final=final, selected=("x",), fitter=fitter)
    monkeypatch.setattr(answer, "left_by_noise", lambda *_, seed: ByNoise(1.5, 2.0))
    found = _levels(search, nominal, stages, stages, floor, None, judged=(0,))
    assert found.noise == (ByNoise(1.5, 2.0) if repeated else NO_NOISE)
    assert found.nominal == pytest.approx(77.0 if repeated else 25.0)
    assert (found.tuned, found.refitted, found.repeated) == (7.0, pytest.approx(9.0), repeated)
    assert found.explained == pytest.approx(
        5.0 / 7.5 if repeated else 5.0 / 8.0
    )  # no model need remove what noise leaves
    assert found.whitened == 1.04
    assert not found.drowned  # one output moves by less than its floor, the other by more
    assert found.patterns == (0.25, 0.1, 6.0)
    assert (found.trained, found.scattered) == (1.0 if repeated else 10.0, 0.0)
    search.selected, search.final = (), tuned
    none = _levels(search, nominal, stages, stages, floor, Drift("joint", -0.1, 0.001))
    assert (found.drifted, none.drifted) == (1.0, 0.001)
    assert (found.relieved, none.relieved) == (True, False)
    assert found.strained == none.strained == 6.0
    assert none.explained is None
    assert none.patterns == (0.25, 0.1, 6.0)
    assert (none.trained, none.scattered) == ((1.0, 0.0) if repeated else (20.0, 3.0))
    search.fitter.case.train = range(4)  # too few to tell what follows the motion where repeats say what is noise
    run.measured *= 0.1
    few = _levels(search, nominal, stages, stages, floor, None, judged=(0,))
    assert few.patterns == (Patterns() if repeated else (0.25, 0.1, 6.0))
    assert few.drowned


def test_the_gap_lists_floor_and_error_of_each_stage() -> None:
    steps = (replayed(3.0, np.nan, 4.0), replayed(1.0, np.nan, 2.0))
    judged = Judged(CASE, FLOOR, {"nominal": steps[0], "refitted": steps[1]}, steps, (0, 1), {})
    assert judged.gap() == {
        "a": {"noise_floor": 0.5, "nominal": pytest.approx(3.0), "refitted": pytest.approx(1.0)},
        "c": {"noise_floor": 2.0, "nominal": pytest.approx(4.0), "refitted": pytest.approx(2.0)},
    }
    search: Any = SimpleNamespace(path=[SimpleNamespace(added=()), SimpleNamespace(added=("x",))])
    assert judged.table_of_steps(search) == [
        {"effects": [], "rms": {"a": pytest.approx(3.0), "c": pytest.approx(4.0)}},
        {"effects": ["x"], "rms": {"a": pytest.approx(1.0), "c": pytest.approx(2.0)}},
    ]


def test_an_effect_is_invisible_that_neither_gains_nor_could_gain_a_nat() -> None:
    seen = [
        SimpleNamespace(effect=name, visibility=visibility, gain=gain, simulated=name != "never ran")
        for name, visibility, gain in [
            ("dim", 0.9, 0.5),
            ("seen", 1.1, 0.0),
            ("gains", 0.0, 1.1),
            ("chosen", 0.1, 0.1),
            ("never ran", 0.0, 0.0),
        ]
    ]
    search: Any = SimpleNamespace(rounds=[SimpleNamespace(screened=seen)], selected=("chosen",))
    assert _invisible(search) == ("dim",)
    search.rounds = []
    assert _invisible(search) == ()


def test_the_next_experiment_separates_the_first_effect_from_its_likeliest_rival_if_that_is_open(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(answer, "advise", lambda case, loop, floor, first, second: [(first, second)])
    own, rival, weak = (SimpleNamespace(effect=name, fitted=name) for name in ("own", "rival", "weak"))

    def proposed(accepted: Any, **share: float) -> Any:
        probability = {"own": 0.9, "rival": share["rival"], "weak": 0.001, None: share["none"]}
        contest = SimpleNamespace(accepted=accepted, trials=(own, weak, rival), probability=probability)
        loop: Any = None
        return _next(CASE, loop, FLOOR, SimpleNamespace(rounds=[contest], tuned="tuned"))  # type: ignore[arg-type]

    assert proposed(own, rival=0.06, none=0.03) == [("own", "rival")]
    assert proposed(own, rival=0.03, none=0.06) == [("own", "tuned")]
    assert proposed(own, rival=0.019, none=0.01) == []
    assert proposed(None, rival=0.5, none=0.5) == []
