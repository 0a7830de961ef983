"""What an unknown cause follows, and the experiment that tells."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from diagnosis.bowden_bench import bench
from tendonlab.diagnosis.answer.followed import Coverage, Seen, advise_unknown, descriptions, since_reversal
from tendonlab.fitting.case import Case
from tendonlab.fitting.problem import Fitter


@pytest.fixture(scope="module")
def fitter(tmp_path_factory: pytest.TempPathFactory) -> Fitter:
    return bench(tmp_path_factory.mktemp("bench"))


def runs_of(case: Case) -> list[Seen]:
    return [Seen(case.run(i, case.system, ports=True), case.experiments[i].time) for i in case.train]


def with_error(fitter: Fitter, form: Any) -> Case:
    """The bench, whose output reads more by a function of velocity and position of the sheath and of time."""
    case, prepared = fitter.case, list(fitter.case.prepared)
    for i in case.train:
        velocity, position, *_ = np.asarray(case.run(i, case.system, ports=True)["ports"])[0]
        more = form(velocity, position, case.experiments[i].time)
        prepared[i] = replace(prepared[i], measured=prepared[i].measured + more)
    return replace(case, prepared=tuple(prepared))


FORMS = {
    "sheath_position": lambda v, x, t: np.sign(v) * np.exp(-(((x - 0.5) / 0.2) ** 2)),
    "sheath_velocity": lambda v, x, t: np.sign(v) * np.exp(-((np.abs(v) / 0.3) ** 2)),
    "sheath_history": lambda v, x, t: np.sign(v) * np.exp(-since_reversal(v, x) / 0.1),
    "time": lambda v, x, t: np.sign(v) * np.exp(-t / 2.0),
}


@pytest.mark.parametrize("coordinate", FORMS)
def test_the_experiment_separates_what_the_error_follows_from_what_it_may_follow_too(
    coordinate: str, fitter: Fitter
) -> None:
    case = with_error(fitter, FORMS[coordinate])
    found = advise_unknown(case, case.replay, fitter.fit(case.system, solve=False))
    assert found[0]["separates"][0] == coordinate
    assert len(found[0]["separates"]) == 2
    assert found[0]["expected_gain"] > 3.0
    assert list(found[0]["reference"].columns) == ["t", "u", "w (deg/s)"]


def test_where_no_map_predicts_anything_the_experiment_covers_what_was_seen_least(fitter: Fitter) -> None:
    case = fitter.case
    (row,) = advise_unknown(case, case.replay, fitter.fit(case.system, solve=False))
    assert row["separates"] == []
    assert row["expected_gain"] > 1.0
    runs = runs_of(case)
    covered = Coverage.of(descriptions(case, runs), runs[:2])
    assert covered.gain(runs[2]) > covered.gain(runs[0])  # under loads that the first two runs never carry


def test_a_log_tells_of_a_map_by_as_much_as_the_determinant_says(fitter: Fitter) -> None:
    """Twice the same log tells less the second time; with nothing known before, each cell by ½ log(1 + its samples)."""
    runs = runs_of(fitter.case)
    parts = descriptions(fitter.case, runs)[:1]
    empty = Coverage(parts, np.eye(len(parts[0].weights)), 1.0)
    rows = parts[0].rows(runs[0])
    spread = np.linalg.eigvalsh(rows.T @ rows)
    assert empty.gain(runs[0]) == pytest.approx(0.5 * np.sum(np.log1p(spread)), rel=1e-9)
    assert Coverage(parts, empty.precision + rows.T @ rows, 1.0).gain(runs[0]) < 0.5 * empty.gain(runs[0])


def test_a_description_says_nothing_against_itself(fitter: Fitter) -> None:
    case = with_error(fitter, FORMS["sheath_position"])
    runs = runs_of(case)
    place = next(one for one in descriptions(case, runs) if one.coordinate == "sheath_position")
    assert place.against(place, runs[0]) == pytest.approx(0.0, abs=1e-12)


def test_history_is_the_way_since_the_last_turn_and_a_rest_is_no_turn() -> None:
    velocity = np.concatenate([np.full(10, 1.0), np.zeros(5), np.full(5, 1.0), np.full(10, -1.0)])
    position = np.cumsum(velocity)
    way = since_reversal(velocity, position)
    assert way[19] == pytest.approx(position[19] - position[0])
    assert way[20:] == pytest.approx(np.arange(10.0))
