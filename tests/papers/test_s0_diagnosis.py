"""S0's own gap on its twin: the load withheld, found by the library, and how far it goes."""

from functools import cache

import numpy as np
import pytest

import tendonlab as tl
from diagnoses import diagnose
from tendonlab.papers import s0
from tendonlab.papers.s0 import experiments


@cache
def rig(transmission: str) -> tl.Dataset:
    return s0.load_dataset(transmission)


@pytest.mark.parametrize("transmission", s0.TRANSMISSIONS)
def test_the_withheld_load_is_the_cause_that_is_found(transmission: str) -> None:
    """The law of the library adds as much at every speed, the twin mostly near 16 rad/s: so part of the gap must stay,
    and the verdict must say so."""
    why = diagnose(rig(transmission))
    assert why.selected == ("contact:load_dependence",)
    assert (why.effects[0].element, why.effects[0].effect) == ("contact", "load_dependence")
    assert why.effects[0].probability > 0.8
    assert why.verdict == "unknown_effect"
    low, high = why.shrinkage["from_refitted"]["ci95"]
    assert 0 < low < why.shrinkage["from_refitted"]["value"] < high < 0.5


@pytest.mark.parametrize("transmission", s0.TRANSMISSIONS)
def test_residuals_go_with_load_more_than_with_speed_or_direction(transmission: str) -> None:
    found = experiments.partial_correlations(rig(transmission), s0.printed_lugre(transmission)).abs()
    assert found["relative load"] > 0.4
    assert found["relative load"] > 5 * found[["speed", "direction"]].max()


@pytest.mark.parametrize("transmission", s0.TRANSMISSIONS)
def test_the_papers_model_predicts_maps_held_out_better_and_a_fading_one_better_still(transmission: str) -> None:
    """By at least a tenth of the RMS; the second gap is larger than the first."""
    of, ratio = rig(transmission), s0.configuration(transmission).ratio()
    speed, load, torque = experiments.training_points(of)
    fitted = s0.fit_proposed(speed, load, torque, ratio=ratio, starts=6).model
    fading = s0.fit_decay(fitted, speed, load, torque, ratio=ratio).model
    rms = experiments.held_out(
        of,
        {
            "lugre": lambda w, _: s0.printed_lugre(transmission).torque(w),
            "eq. 11": lambda w, x: fitted.torque(w, load=x, ratio=ratio),
            "fading": lambda w, x: fading.torque(w, load=x, ratio=ratio),
        },
    )["rms"]
    assert rms["eq. 11"] < 0.9 * rms["lugre"]
    assert rms["fading"] < 0.5 * rms["eq. 11"]


def test_where_load_does_not_matter_it_is_not_named() -> None:
    """The same maps with friction that is the LuGre curve itself: no gap, and no effect selected."""
    from dataclasses import replace

    of, rng = rig("C35P75GX"), np.random.default_rng(5)
    model = s0.printed_lugre("C35P75GX")

    def without_load(experiment: tl.Experiment) -> tl.Experiment:
        torque = model.torque(experiment.data["speed"].to_numpy())
        data = experiment.data.assign(friction_torque=torque + 2e-3 * rng.normal(size=len(torque)))
        return replace(experiment, data=data)

    signals = {**of.signals, "friction_torque": replace(of.signals["friction_torque"], noise_sd=2e-3)}
    blind = replace(of, experiments=tuple(without_load(e) for e in of), signals=signals)
    why = diagnose(blind)
    assert why.selected == ()
    assert why.verdict in ("no_gap", "parameters_only")
