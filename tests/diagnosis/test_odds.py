"""The odds of effects: evidence over a temperature, which grows with what no model explains or where shapes err."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.diagnosis.search.contest import Round, probabilities
from tendonlab.diagnosis.search.trial import DETECT, Trial
from tendonlab.fitting.fitted import Fitted


def trial(effect: str, gain: float, *, square: float = 1.0) -> Trial:
    fitted: Any = SimpleNamespace(whitened_square=square)
    return Trial(effect, fitted, gain, left_out_gain=100.0, doubt=0.0, has_shape=effect != "bias")


def test_probabilities_are_the_odds_of_evidence_over_temperature() -> None:
    """Of two established effects 8 nats apart at temperature 4 the first is e² times as probable."""
    found = probabilities([trial("a", 48.0), trial("b", 40.0)], {"a", "b"}, DETECT, 4.0)
    assert sum(found.values()) == pytest.approx(1.0)
    assert found["a"] / found["b"] == pytest.approx(np.exp(2.0))
    assert found[None] / found["b"] == pytest.approx(np.exp((DETECT.evidence - 40.0) / 4.0))


def test_an_effect_that_is_not_established_ranks_three_temperatures_behind_none() -> None:
    found = probabilities([trial("a", 48.0), trial("weak", 1.0)], set(), DETECT, 4.0)
    assert found["a"] / found[None] == pytest.approx(np.exp(-3.0))
    few = (DETECT.evidence - 3.0 * 4.0) - 1.0
    assert few < 0.0  # its own gain counts where it is less
    assert probabilities([trial("weak", -9.0)], set(), DETECT, 4.0)["weak"] == pytest.approx(
        1.0 / (1.0 + np.exp((DETECT.evidence + 9.0) / 4.0))
    )


@pytest.mark.parametrize(("square", "temperature"), [(0.5, 4.0), (6.0, 24.0)])
def test_what_the_best_model_leaves_heats_the_odds(nominal: Fitted, square: float, temperature: float) -> None:
    trials = [trial("a", 60.0, square=square), trial("b", 40.0, square=square + 5.0)]
    found = Round.of(nominal, [], trials, established={"a", "b"}, bar=DETECT, accepted=trials[0], failed={}).probability
    assert np.log(found["a"] / found["b"]) == pytest.approx(20.0 / temperature)


@pytest.mark.parametrize(
    ("first", "second", "temperature"), [("a", "b", 100.0), ("a", "bias", 4.0), ("bias", "a", 4.0)]
)
def test_the_shape_of_a_law_may_err_by_a_share_of_its_gain_but_not_that_of_a_bias(
    nominal: Fitted, first: str, second: str, temperature: float
) -> None:
    gains = {first: 10_000.0, second: 9_992.0}
    trials = [trial(name, gain) for name, gain in gains.items()]
    found = Round.of(nominal, [], trials, established=set(gains), bar=DETECT, accepted=trials[0], failed={}).probability
    assert np.log(found[first] / found[second]) == pytest.approx(8.0 / temperature)


@pytest.mark.parametrize(("acts", "temperature"), [(("bushing_1", 2, 12), 500.0), (("bushing_2", 2, 12), 100.0)])
def test_the_form_of_a_variant_of_the_first_law_may_err_by_more(
    nominal: Fitted, acts: tuple[str, int, int], temperature: float
) -> None:
    """Two laws of the same element that combine in the same way and read the same differ by their form alone."""
    first = replace(trial("a", 10_000.0), acts=("bushing_1", 2, 12))
    trials = [first, replace(trial("b", 9_600.0), acts=acts)]
    found = Round.of(nominal, [], trials, established={"a", "b"}, bar=DETECT, accepted=first, failed={}).probability
    assert np.log(found["a"] / found["b"]) == pytest.approx(400.0 / temperature)
