"""The map from evidence to probability: fitted on cases whose evidence is too sure, it finds by how much."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from tendonlab.blind.calibrating import Judged, calibrate, fitted, results_on
from tendonlab.blind.reliability import (
    calibration_error,
    error_beyond_chance,
    interval_of_mean,
    reliability_line,
    spread_of_error,
    too_far_off,
)
from tendonlab.diagnosis.answer.calibration import Calibration, Tempering, shipped
from tendonlab.diagnosis.answer.verdict import Verdict

VERDICTS = ("data_fault", "no_gap", "parameters_only", "effect", "unknown_effect")


def cases(count: int, *, sharpness: float, lapse: float = 0.0, missed: float = 0.0, left: float = 1e3) -> list[Judged]:
    """Cases whose log odds are `sharpness` times as large as they should be; a share of them has any verdict at all,
    and a share an effect that the evidence excludes."""
    draw = np.random.default_rng(5)
    made = []
    for _ in range(count):
        true = np.concatenate([[0.0], draw.dirichlet([0.4] * 4)])
        came = str(draw.choice(VERDICTS[1:]) if draw.random() < lapse else draw.choice(VERDICTS, p=true))
        sharp = np.where(true > 0, np.maximum(true, 1e-9) ** sharpness, 0.0)
        evidence = dict(zip(VERDICTS, (sharp / sharp.sum()).tolist(), strict=True))
        chance = draw.random()
        there = frozenset(["a:b"]) if draw.random() < chance else frozenset[str]()
        odds = sharpness * np.log(chance / (1.0 - chance))
        effects = {"a:b": float(1.0 / (1.0 + np.exp(-odds)))}
        if draw.random() < missed:
            there, effects = there | {"a:c"}, effects | {"a:c": 1e-6}
        else:
            effects |= {"a:d": 1e-6}
        told = max(evidence, key=evidence.__getitem__)
        made.append(Judged("rigid_joint", False, came, there, evidence, effects, told, left, runs=7))
    return made


@pytest.mark.parametrize("sharpness", [0.5, 1.0, 3.0])
def test_the_map_undoes_evidence_that_is_too_sure_or_not_sure_enough(sharpness: float) -> None:
    found = fitted(cases(1500, sharpness=sharpness))
    for of in (found.verdicts, found.effects):
        assert of.temperature == pytest.approx(sharpness, rel=0.15)
        assert of.lapse < 0.05


def test_probabilities_are_true_under_the_fitted_map_on_other_cases() -> None:
    drawn = cases(2400, sharpness=3.0)
    before, after = results_on(drawn[1200:], Calibration()), results_on(drawn[1200:], fitted(drawn[:1200]))
    for of in ("verdicts", "effects"):
        assert abs(before[of]["z"]) > 5.0
        assert abs(after[of]["z"]) < 2.5
        assert before[of]["calibration error beyond chance"] > 0.05
        assert after[of]["calibration error beyond chance"] < 0.02
        assert before[of]["reliability slope"] < 0.5
        assert after[of]["reliability slope"] == pytest.approx(1.0, abs=0.2)


def test_a_share_of_cases_that_nothing_predicts_is_a_lapse() -> None:
    assert fitted(cases(3000, sharpness=1.0, lapse=0.2)).verdicts.lapse == pytest.approx(0.2, abs=0.06)


def test_what_goes_wrong_near_the_noise_alone_is_no_lapse_far_from_it() -> None:
    near, far = cases(1200, sharpness=1.0, lapse=0.3, left=1.0), cases(1200, sharpness=1.0, left=50.0)
    of = fitted([*near, *far]).verdicts
    assert of.at(1.0).lapse == pytest.approx(0.3, abs=0.07)
    assert of.at(50.0).lapse < 0.02


def test_the_lapse_falls_with_the_square_of_what_tuning_leaves_over_the_noise() -> None:
    of = Tempering(lapse=0.01, near_noise=0.2, missed=0.005)
    assert [of.at(left).lapse for left in (0.3, 1.0, 2.0, 10.0)] == pytest.approx([0.21, 0.21, 0.06, 0.012])
    assert Tempering(lapse=0.9, near_noise=0.9, missed=0.01).at(1.0).lapse == pytest.approx(0.99)
    map_ = Calibration(verdicts=of, effects=of, systems=("rigid_joint",)).at(2.0)
    assert (map_.verdicts.lapse, map_.effects.lapse, map_.systems) == (pytest.approx(0.06),) * 2 + (("rigid_joint",),)


def test_effects_that_the_evidence_excludes_are_there_as_often_as_they_were() -> None:
    for missed in (0.0, 0.02):
        of = fitted(cases(1600, sharpness=1.0, missed=missed)).effects
        assert of.missed == pytest.approx(0.5 * missed, abs=0.004)  # half of them beside one that counts with them
        assert of.of_one(0.0) == pytest.approx(of.missed, abs=1e-3)


def test_the_most_probable_verdict_and_the_order_of_effects_stay() -> None:
    of = Calibration(verdicts=Tempering(temperature=4.0, lapse=0.3), effects=Tempering(temperature=0.5, lapse=0.2))
    raw = {"data_fault": 0.0, "no_gap": 1e-20, "parameters_only": 0.3, "effect": 0.4, "unknown_effect": 0.3}
    mapped = of.of_verdicts(raw)
    assert sum(mapped.values()) == pytest.approx(1.0)
    assert max(mapped, key=mapped.__getitem__) == "effect"
    assert mapped["data_fault"] == 0.0
    effects = [of.effects.of_one(p) for p in (0.0, 0.1, 0.5, 0.9, 1.0)]
    assert effects == sorted(effects)


def test_an_effect_that_is_nearly_sure_stays_so_but_for_the_lapse() -> None:
    """Between sure and unsure there are few cases to fit: the map must not fall there."""
    of = Tempering(temperature=0.7, lapse=0.1)
    assert of.of_one(1.0) == pytest.approx(0.9, abs=1e-6)
    assert of.of_one(0.9) > 0.85
    assert of.of_one(0.5) == pytest.approx(0.45)


def test_the_map_holds_on_the_rigs_that_confirmed_it() -> None:
    of = Calibration(systems=("rigid_joint",), least_runs=7)
    assert of.holds("rigid_joint", runs=7)
    assert not of.holds("rigid_joint", runs=6)
    assert not of.holds("ccsrm", runs=10)


def test_no_map_changes_nothing() -> None:
    raw = {**dict.fromkeys(VERDICTS, 0.25), "data_fault": 0.0}
    assert Calibration().of_verdicts(raw) == pytest.approx(raw)
    assert Tempering().of_one(0.37) == pytest.approx(0.37)


def test_the_shipped_map_is_read() -> None:
    for repeats in (False, True):
        of = shipped(repeats=repeats)
        assert 0.0 <= of.verdicts.lapse < 0.5
        assert of.holds("rigid_joint", runs=of.least_runs) == ("rigid_joint" in of.systems)


def test_without_cases_to_fit_the_shipped_map_stays_and_is_confirmed_by_none() -> None:
    content = calibrate()
    for name, repeats in (("with repeats", True), ("without repeats", False)):
        of = shipped(repeats=repeats)
        assert content[name]["map"] == {"verdicts": asdict(of.verdicts), "effects": asdict(of.effects)}
        assert content[name]["fitted on"]
        assert content[name]["confirmed"] == []


def test_true_probabilities_pass_and_false_ones_do_not() -> None:
    draw = np.random.default_rng(1)
    probability = draw.uniform(0.5, 1.0, 800)
    true = (draw.random(800) < probability).astype(float)
    false = (draw.random(800) < 0.5 * probability).astype(float)
    assert abs(too_far_off(probability, true)) < 2.0 < 5.0 < abs(too_far_off(probability, false))
    assert error_beyond_chance(probability, true) < 0.02 < error_beyond_chance(probability, false)
    assert reliability_line(probability, true)[0] == pytest.approx(1.0, abs=0.25)
    assert calibration_error(np.array([0.25, 0.25, 0.25, 0.25]), np.array([1.0, 0.0, 0.0, 0.0])) == 0.0


def test_the_interval_of_a_mean_holds_the_true_mean_as_often_as_it_says() -> None:
    draw = np.random.default_rng(2)
    hits = 0
    for _ in range(200):
        interval = interval_of_mean(draw.beta(4.0, 1.0, 40))  # mean 0.8
        assert interval
        hits += interval[0] <= 0.8 <= interval[1]
    assert 180 <= hits <= 198  # of 200; 190 expected, sd 3


def test_the_interval_of_a_mean_at_the_end_of_the_range_has_a_width() -> None:
    assert interval_of_mean(np.ones(10)) == pytest.approx((0.6915, 1.0), abs=1e-4)  # 0.025^(1/10)
    assert interval_of_mean(np.array([0.4])) is None


def test_the_spread_of_the_calibration_error_counts_rigs_and_not_their_effects() -> None:
    """Ten answers of one rig that come true together say as much as one."""
    draw = np.random.default_rng(3)
    came = [bool(x) for x in draw.random(150) < 0.3]
    one, ten = ([[(0.55, true)] * num for true in came] for num in (1, 10))
    assert spread_of_error(ten) == pytest.approx(spread_of_error(one))
    assert spread_of_error(one) == pytest.approx(np.sqrt(0.3 * 0.7 / 150), rel=0.1)  # of the share, in one bin


@pytest.mark.parametrize(("fitted_on", "refused"), [("test", True), ("calibration", False)])
def test_cases_that_were_drawn_to_test_are_never_fitted(tmp_path: Path, fitted_on: str, refused: bool) -> None:
    origin = f'[protocol]\nversion = 3\nsha256 = "ab"\npurpose = "{fitted_on}"\nchanged = ["system"]\n'
    draw = '[draw]\nsystem = "rigid_joint"\nrepeats = true\n'
    truth = f'verdict = "no_gap"\neffects = []\naccept = []\n{draw}{origin}'
    (tmp_path / "case-001.toml").write_text(truth, encoding="utf-8")
    (tmp_path / "case-001").mkdir()
    evidence = {"verdict": {"no_gap": 0.9, "effect": 0.1}, "effects": {"load:offset": 0.1}}
    details = {"evidence": evidence, "mean_square": {"refitted": 1.0}}
    report = {"verdict": "no_gap", "details": details, "split": {"train": ["a"]}}
    (tmp_path / "case-001" / "report.json").write_text(json.dumps(report), encoding="utf-8")
    if refused:
        with pytest.raises(ValueError, match=r"case-001.toml: this case was drawn for test; expected a series"):
            calibrate([(tmp_path, tmp_path)])
    else:
        content = calibrate([(tmp_path, tmp_path)])
        assert content["series"]["protocols"] == ["3 ab"]
        assert content["series"]["changed"] == ["system"]
        with pytest.raises(ValueError, match="this case was drawn for calibration"):
            calibrate(test=[(tmp_path, tmp_path)])


def test_a_series_without_evidence_is_no_reason_to_keep_the_shipped_map(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"reports: expected reports with evidence, found none"):
        calibrate([(tmp_path, tmp_path / "reports")])


def test_a_missing_report_is_named(tmp_path: Path) -> None:
    (tmp_path / "case-001.toml").write_text("", encoding="utf-8")
    with pytest.raises(ValueError, match=r"case-001/report.json is missing: expected a report of every case"):
        calibrate([(tmp_path, tmp_path)])


def test_a_group_keeps_its_shares_and_the_probability_of_the_group() -> None:
    of = Calibration(effects=Tempering(temperature=2.0, lapse=0.1))
    raw = Verdict("effect", dict.fromkeys(VERDICTS, 0.2), {"a:b": 0.6, "c:d": 0.3, "e:f": 0.05}, [], [["a:b", "c:d"]])
    found = of.applied(raw).effects
    assert found["a:b"] + found["c:d"] == pytest.approx(of.effects.of_one(0.9))
    assert found["a:b"] / found["c:d"] == pytest.approx(2.0)
    assert found["e:f"] == pytest.approx(of.effects.of_one(0.05))


def test_sets_share_the_probability_of_all_of_them() -> None:
    sets = [{"effects": ["a:b"], "probability": 0.7}, {"effects": ["c:d"], "probability": 0.2}]
    raw = Verdict("effect", dict.fromkeys(VERDICTS, 0.2), {}, sets, [])
    of = Calibration(effects=Tempering(temperature=2.0))
    found = [entry["probability"] for entry in of.applied(raw).sets]
    assert sum(found) == pytest.approx(of.effects.of_one(0.9))
    assert found[0] / found[1] == pytest.approx(3.5)


def test_a_set_becomes_as_much_less_likely_as_its_least_likely_effect() -> None:
    """Else an element would be more probable than all of its effects together."""
    of = Calibration(effects=Tempering(temperature=0.7, lapse=0.03))
    sets = [{"effects": ["a"], "probability": 0.9}, {"effects": ["a", "b"], "probability": 0.08}]
    raw = Verdict("effect", dict.fromkeys(VERDICTS, 0.2), {"a": 0.98, "b": 0.08}, sets, [])
    found = of.applied(raw)
    alone, both = (float(entry["probability"]) for entry in found.sets)
    assert alone + both == pytest.approx(of.effects.of_one(0.98))
    assert both == pytest.approx(found.effects["b"], rel=0.1)  # but for what makes them add up
    assert both < 0.5 * 0.08


def test_without_evidence_only_a_fault_of_the_data_is_impossible() -> None:
    raw = {"data_fault": 0.0, "no_gap": 0.0, "parameters_only": 1.0, "effect": 0.0, "unknown_effect": 0.0}
    found = Calibration(verdicts=Tempering(lapse=0.2)).of_verdicts(raw)
    assert found["data_fault"] == 0.0
    assert found["effect"] == pytest.approx(0.05, abs=1e-5)
