"""The words and numbers of the report."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tendonlab.report import numbers, words
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.simulation.catalog import kinds, system_info


@pytest.mark.parametrize(
    ("kind", "name", "expected"),
    [
        ("two_inertia", "joint:stribeck", "Stribeck friction at the joint"),
        ("two_inertia", "contact:load_dependence", "load-dependent friction at the pulley contact"),
        ("two_inertia", "sensor.joint_angle:delay", "delay of the joint angle sensor"),
        ("two_inertia", "load:offset", "constant disturbance on the load"),
        ("two_inertia", "actuation:offset", "constant offset of the actuator"),
        ("cable_joint", "gear:ripple", "motion ripple in the gear"),
        ("cable_joint", "bushing_1:coulomb", "Coulomb friction in bushing 1"),
        ("cable_joint", "stiction:hold", "hold by stiction in the guides"),
        ("bowden_pair", "actuation:drive_inertia", "inertia of the drive"),
        ("ccsrm", "ends:compliance", "compliance in the cable ends"),
        ("tendon_routing", "load:scale_error", "scale error of the load"),
        ("spring_box", "spring:odd_law", "odd law in the spring"),
        ("two_inertia", "a wrong mass", "a wrong mass"),
    ],
)
def test_effects_in_words(kind: str, name: str, expected: str) -> None:
    assert words.phrase(name, kind) == expected


def test_every_effect_of_a_system_has_a_phrase_of_its_own() -> None:
    for kind in kinds():
        info = system_info(kind)
        phrases = [effect.phrase for effect in info.effects]
        assert len(set(phrases)) == len(phrases), kind
        assert not any("_" in phrase or "  " in phrase for phrase in phrases)
        assert all(effect.phrase == f"{effect.noun} {info.element(effect.element).place}" for effect in info.effects)


def test_elements_in_words() -> None:
    assert words.element_words("contact", "two_inertia") == "pulley contact"
    assert words.element_words("contact", "two_inertia", article=True) == "the pulley contact"
    assert words.element_words("bushing_1", "cable_joint", article=True) == "bushing 1"
    assert words.element_words("sensor.joint_angle", "two_inertia") == "joint angle sensor"
    assert words.element_words("spring_box", "unknown", article=True) == "the spring box"


def test_small_words() -> None:
    assert words.words("joint_stribeck_velocity") == "joint Stribeck velocity"
    assert words.parameter_words("joint_stribeck_velocity", element="joint") == "Stribeck velocity"
    assert words.capital("joint") == "Joint"
    for name in ("joint:stribeck is off", "dataset.toml, key format", "angle_offset: odd"):
        assert words.capital(name) == name
    assert words.capital("backlash: play") == "Backlash: play"
    assert [words.listing(items) for items in (["a"], ["a", "b"], ["a", "b", "c"], [])] == [
        "a",
        "a and b",
        "a, b and c",
        "",
    ]
    units = {"joint_angle": "rad", "cable_position": "m"}
    shown = [words.unit_of(name, units) for name in ("joint_angle", "joint_velocity", "cable_speed", "time", "odd")]
    assert shown == ["rad", "rad/s", "m/s", "s", ""]


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (0.0502, "0.0502"),
        (0.05, "0.05"),
        (1234.0, "1230"),
        (-0.0, "0"),
        (-2.5, "−2.5"),
        (1e-6, "1×10⁻⁶"),
        (0.00108, "0.00108"),
        (0.000108, "1.08×10⁻⁴"),
        (2.5e7, "2.5×10⁷"),
        (0.99999, "1"),
        (99999.0, "1×10⁵"),
        (float("nan"), "–"),
        (None, "–"),
    ],
)
def test_numbers(value: float | None, expected: str) -> None:
    assert numbers.number(value) == expected


def test_one_of_a_kind_is_singular() -> None:
    assert [numbers.counted(num, "run") for num in (0, 1, 2)] == ["0 runs", "1 run", "2 runs"]


def test_shares_and_probabilities() -> None:
    assert numbers.percent(0.91, [0.88, 0.94]) == "91 % (88–94 %)"
    assert numbers.percent(0.6, [-0.05, 0.7]) == "60 % (−5 to 70 %)"
    assert [numbers.percent(value) for value in (0.996, 1.0, -0.001, float("nan"))] == ["99.6 %", "100 %", "0 %", "–"]
    assert [numbers.probability(value) for value in (1.0, 0.934, 0.001, 0.0)] == ["> 0.99", "0.93", "< 0.01", "0.00"]


def test_an_edge_of_a_region_that_is_noise_about_zero_reads_0() -> None:
    assert numbers.region([6.7e-5, 0.309]) == "0 to 0.309"
    assert numbers.region([-0.012, 1.8e-17]) == "−0.012 to 0"
    assert numbers.region([0.004, 0.309]) == "0.004 to 0.309"
    assert numbers.region([0.0, 0.0]) == "0 to 0"
    assert numbers.region(None) == ""


@pytest.mark.parametrize(
    ("name", "kind", "expected"),
    [
        ("joint_velocity", "two_inertia", "joint velocity"),
        ("contact_load", "two_inertia", "pulley contact load"),
        ("stiction_2_velocity", "cable_joint", "guide 2 velocity"),
        ("gear_2_velocity", "tendon_routing", "gear 2 velocity"),
        ("bushing_1_position", "cable_joint", "bushing 1 position"),
        ("end_11_load", "ccsrm", "cable end 11 load"),
        ("time", "ccsrm", "time"),
        ("cable_speed", "another", "cable speed"),
    ],
)
def test_coordinates_in_words(name: str, kind: str, expected: str) -> None:
    assert words.coordinate_words(name, kind) == expected


def test_units() -> None:
    assert numbers.unit_text("kg*m^2") == "kg·m²"
    assert numbers.unit_text("N*m*s/rad") == "N·m·s/rad"
    assert numbers.unit_text("1") == ""
    assert numbers.prefixed([0.031], "rad") == (pytest.approx(1e3), "mrad")
    assert numbers.prefixed([2.0], "N*m") == (1.0, "N·m")
    assert numbers.prefixed([2e-5], "kg*m^2") == (1.0, "kg·m²")


def test_sentence_of_each_verdict(diagnosis: Diagnosis) -> None:
    expected = {
        "effect": "An unmodelled effect explains the gap: Stribeck friction at the joint. These data cannot tell it "
        "from presliding friction at the joint. Adding it shrinks the held-out gap by 91 % (88–94 %). Probability that "
        "one of these explanations is the whole one: 0.93, not yet calibrated.",
        "no_gap": "There is no gap to explain: the simulator as it stands predicts to the noise floor. Probability of "
        "this verdict: 0.97.",
        "parameters_only": "Parameter values were off, and no missing effect can be shown: the refitted simulator errs "
        "by 23 times the noise floor, and no effect of the library lowers that reliably. Re-identifying them shrinks "
        "the held-out gap by 94 % (91–96 %). Probability of this verdict: 0.90, not yet calibrated.",
        "unknown_effect": "The library explains only a part of the gap. Presliding friction at the joint and "
        "load-dependent friction at the joint are established and explain 71 % of the excess error; the rest is "
        "unknown. Probability of this verdict: 0.88, not yet calibrated.",
        "data_fault": "The logs cannot be right: all inertial and gravity torques come out negative: −1.03 of what is "
        "stated. Nothing is said about effects. Probability of this verdict: > 0.99, not yet calibrated.",
    }
    assert diagnosis.sentence == expected[diagnosis.verdict]


def test_no_gap_above_the_floor_is_not_said_to_lie_on_it(with_effect: Diagnosis) -> None:
    probability = dict.fromkeys(with_effect.verdict_probability, 0.0) | {"no_gap": 0.8}
    nothing = replace(with_effect, verdict="no_gap", selected=(), verdict_probability=probability)

    def gap(floors: float) -> dict[str, float]:
        return {"noise_floor": 1e-4, "nominal": floors * 1e-4, "refitted": floors * 1e-4, "with_effect": floors * 1e-4}

    near, above = {"joint_angle": gap(1.05)}, {"joint_angle": gap(1.3), "torque": gap(1.1)}
    assert "predicts to the noise floor" in replace(nothing, gap=near).sentence
    assert "errs by 1.2 times the noise floor, and neither tuning nor" in replace(nothing, gap=above).sentence
    tuned = replace(nothing, verdict="parameters_only", verdict_probability=probability)
    assert "and no effect is missing." in replace(tuned, gap=near).sentence
    assert "the refitted simulator errs by 1.2 times the noise floor" in replace(tuned, gap=above).sentence


def test_the_sentence_names_friction_that_changed_over_the_session(with_effect: Diagnosis) -> None:
    nothing = replace(with_effect, verdict="unknown_effect", selected=())
    assert nothing.sentence.startswith("A gap remains after tuning that no effect of the library explains.")
    drift = {"element": "contact", "change": -0.072, "chance": 2e-4}
    warmed = replace(nothing, details=nothing.details | {"drift": drift})
    expected = "An effect is missing that the library lacks: the friction of the pulley contact fell by 7 % over"
    assert warmed.sentence.startswith(expected)


def test_what_may_imitate_the_unknown_is_not_called_established(with_effect: Diagnosis) -> None:
    doubtful = tuple(replace(finding, probability=0.1) for finding in with_effect.effects)
    partly = replace(with_effect, verdict="unknown_effect", explained=0.32)
    assert "Stribeck friction at the joint is established and explains 32 % of" in partly.sentence
    assert "and held-out experiments are at the noise floor" in replace(partly, explained=None).sentence
    hardly = "A gap remains after tuning that no effect of the library explains. Stribeck friction at the joint is"
    for explained, share in ((0.0, "nothing"), (0.01, "1 %")):
        told = replace(partly, explained=explained).sentence
        assert told.startswith(hardly)
        assert f"but explains {share} of the excess error" in told
    assert replace(partly, effects=doubtful).sentence.startswith(
        "The library explains only a part of the gap. Stribeck friction at the joint helps on the training experiments "
        "and explains 32 % of the excess error; it may only imitate what is unknown, so compare the fitted values "
        "with what you know of the rig."
    )


def test_sentence_of_two_effects_quotes_their_set(with_effect: Diagnosis) -> None:
    nothing = {"from_nominal": None, "from_refitted": None}
    both = replace(with_effect, selected=("joint:stribeck", "joint:presliding"), calibrated=True, shrinkage=nothing)
    assert both.sentence == (
        "Two unmodelled effects explain the gap: Stribeck friction at the joint and presliding friction at the joint. "
        "Probability that this is the whole explanation: 0.04."
    )
    assert "explanation: 0.21" in replace(both, sets=()).sentence  # the less certain of the two


def test_an_effect_that_held_out_experiments_do_not_need_explains_no_gap(with_effect: Diagnosis) -> None:
    shown = replace(with_effect, explained=None, indistinguishable=())
    assert shown.sentence.startswith(
        "The simulator lacks an effect: Stribeck friction at the joint. The training experiments show it; the held-out "
        "ones are at the noise floor without it as well. Probability"
    )
    both = replace(shown, selected=("joint:stribeck", "joint:presliding"))
    assert both.sentence.startswith("The simulator lacks two effects: ")


def test_twins_of_a_selected_effect_are_named_and_count_with_it(with_effect: Diagnosis) -> None:
    first, second, twin = "joint:stribeck", "sensor.joint_angle:delay", "actuation:delay"
    shares = (((first, second), 0.5), ((first, twin), 0.45), ((first,), 0.02))
    tied = replace(
        with_effect,
        selected=(first, second),
        indistinguishable=((second, twin),),
        sets=tuple({"effects": list(names), "probability": p} for names, p in shares),
        verdict_probability={**with_effect.verdict_probability, "effect": 0.98},
    )
    assert "cannot tell delay of the joint angle sensor from delay of the actuator." in tied.sentence
    assert "is the whole one: 0.95" in tied.sentence


def test_the_sentence_is_never_surer_than_its_verdict(with_effect: Diagnosis) -> None:
    doubt = {"data_fault": 0.0, "no_gap": 0.0, "parameters_only": 0.0, "effect": 0.7, "unknown_effect": 0.3}
    assert "is the whole one: 0.70" in replace(with_effect, verdict_probability=doubt).sentence  # its set alone: 0.93


def test_an_effect_that_does_not_help_is_not_said_to_shrink_the_gap(with_effect: Diagnosis) -> None:
    def told(value: float) -> str:
        shrinkage = {**with_effect.shrinkage, "from_refitted": {"value": value, "ci95": [-0.4, 0.24]}}
        return replace(with_effect, shrinkage=shrinkage).sentence

    assert "Adding it does not shrink the held-out gap." in told(-0.01)
    assert "Adding it makes held-out runs worse: their gap becomes 1.3 times as large." in told(-0.31)
    useless = replace(with_effect, verdict="unknown_effect", explained=0.0).sentence
    assert "is established but explains nothing of the excess error on held-out experiments" in useless


@pytest.mark.parametrize(
    ("nats", "told"),
    [(35.2, "expected evidence 35 nats"), (7.3e5, "expected evidence over 100 nats"), (float("nan"), ""), (None, "")],
)
def test_gains_in_words(nats: float | None, told: str) -> None:
    assert words.gain_words(nats) == told


@pytest.mark.parametrize(
    ("names", "told"),
    [
        (["slack"], "shows whether there is slack"),
        (["slack", "backlash"], "separates slack from backlash"),
        (["slack", "backlash", "delay"], "separates slack, backlash and delay"),
    ],
)
def test_what_an_experiment_decides(names: list[str], told: str) -> None:
    assert words.separation(names) == told


def test_a_narrow_span_takes_the_digits_that_tell_its_ends_apart() -> None:
    assert numbers.span((-0.38712, -0.38668)) == "−0.3871 to −0.3867"
    assert numbers.span((0.5, 0.5)) == "0.5 to 0.5"
    assert numbers.span((1.0, 1.0 + 1e-9)) == "1 to 1"  # beyond six digits nothing is claimed
    assert numbers.span((float("nan"), 1.0)) == "– to 1"


def test_a_value_has_the_digits_of_its_interval() -> None:
    assert numbers.estimate(14.013, (14.01, 14.02)) == ("14.01", "14.01 to 14.02")
    assert numbers.estimate(0.1234, (0.11, 0.13)) == ("0.123", "0.11 to 0.13")
    assert numbers.estimate(0.1234, None) == ("0.123", "")
    assert numbers.estimate(None, (None, 1.0), 2) == ("–", "")


def test_what_effects_leave_above_the_floor_is_told(with_effect: Diagnosis) -> None:
    gap = {"joint_angle": {"noise_floor": 1.0, "nominal": 90.0, "refitted": 80.0, "with_effect": 8.3}}
    told = replace(with_effect, gap=gap, indistinguishable=()).sentence
    assert "What is left is 8.3 times the noise floor: another form of this effect, or a smaller effect, may" in told
    assert "Probability that this is the main explanation" in told
    gap["joint_angle"]["with_effect"] = 1.4
    told = replace(with_effect, gap=gap, indistinguishable=()).sentence
    assert "left" not in told
    assert "Probability that this is the whole explanation" in told
