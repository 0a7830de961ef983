"""What to measure where the library explains too little."""

from __future__ import annotations

from typing import Any

from tendonlab.diagnosis.answer.explore import explore


def regime(name: str, p_value: float) -> dict[str, Any]:
    return {"coordinate": name, "range": [0.6605, 0.8886], "share": 0.8, "p_value": p_value}


def descriptions(*regimes: dict[str, Any], repeated: bool = True) -> list[str]:
    found = explore(regimes, {"joint_position": "rad", "joint_load": "N*m"}, "cable_joint", repeated=repeated)
    assert all(entry["expected_gain"] is None for entry in found)  # no simulator can play what is unknown
    return [entry["description"] for entry in found]


def test_errors_that_gather_at_a_place_are_looked_for_there() -> None:
    (words,) = descriptions(regime("joint_position", 0.002))
    assert words.startswith("slow reversals at one speed, at a joint position of 0.66 to 0.89 rad")


def test_one_motion_of_each_kind_is_proposed_and_only_for_what_is_no_accident() -> None:
    place, load = descriptions(
        regime("joint_position", 0.002), regime("motor_position", 0.01), regime("joint_load", 0.03), regime("time", 0.3)
    )
    assert "joint position" in place
    assert "payloads, at a joint load of 0.66 to 0.89 N·m" in load


def test_an_edge_that_is_noise_about_zero_reads_0_and_numbers_are_those_of_the_report() -> None:
    slow = {**regime("stiction_2_velocity", 0.002), "range": [6.7e-5, 0.0309]}
    (words,) = descriptions(slow)
    assert "at a guide 2 velocity of 0 to 0.031 and beyond" in words
    (tiny,) = descriptions({**slow, "range": [-6.7e-5, -2e-5]})
    assert "of −6.7×10⁻⁵ to −2×10⁻⁵ and beyond" in tiny


def test_without_a_clear_regime_rests_are_proposed_and_without_repeats_repeats_first() -> None:
    (rests,) = descriptions(regime("joint_position", 0.2))
    assert "rests of several lengths" in rests
    first, _ = descriptions(repeated=False)
    assert "three times" in first
