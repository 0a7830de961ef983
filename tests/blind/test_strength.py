"""The strength that the draw promises, measured again by other means."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from tendonlab.blind.lanes import lanes_of, scene_of
from tendonlab.blind.plant import simulate
from tendonlab.blind.rig import (
    Rig,
    draw_rig,
    effect_parameters,
    full_truth,
    largest_amplitude,
    nominal_effects,
    nominal_parameters,
    nominal_values,
)
from tendonlab.blind.strength import _Tuner, tune
from tendonlab.blind.systems import SYSTEMS


def small_rig(effect: str, *, kind: str = "effect", system: str = "two_inertia") -> Rig:
    rig = draw_rig(
        np.random.default_rng(3),
        effect=effect,
        kind=kind,
        system=SYSTEMS[system],
        excitation="rich",
        num_samples=200,
    )
    return replace(rig, num_settle=50, form=0, target=2.0, noise=0.7, outputs=rig.system.output_names)


def readings(rig: Rig, values: dict[str, float], *, noisy: bool = False, with_effect: bool) -> np.ndarray:
    lanes = lanes_of([rig], [values], is_noisy=[noisy], with_effect=with_effect)
    return simulate(lanes, scene_of([rig], is_noisy=[noisy]), step=rig.sample_time / 5, stride=4).outputs


@pytest.mark.parametrize(("system", "effect"), [("two_inertia", "joint:coulomb"), ("rigid_joint", "joint:stribeck")])
def test_gap_over_noise_is_what_an_independent_fit_finds(system: str, effect: str):
    rig = small_rig(effect, system=system)
    (strength,) = tune([rig])
    truth = full_truth(rig, strength.amplitude)
    clean = readings(rig, truth, with_effect=True)
    noise = readings(rig, truth, noisy=True, with_effect=True) - clean
    floor = np.sqrt(np.mean(noise**2, axis=(1, 2)))[:, None, None]
    names = [name for name in nominal_parameters(rig) if name != "gear_ratio"]

    def residual(logs: np.ndarray) -> np.ndarray:
        values = {**{n: rig.truth[n] for n in nominal_parameters(rig)}}
        values |= {name: values[name] * np.exp(x) for name, x in zip(names, logs, strict=True)}
        return ((readings(rig, values, with_effect=False) - clean) / floor).ravel()

    fit = least_squares(residual, np.zeros(len(names)), diff_step=0.02, max_nfev=4)
    assert np.sqrt(np.mean(fit.fun**2)) == pytest.approx(2.0, rel=0.25)  # 20 % promised, and another step
    assert strength.met
    assert strength.gap_noise == pytest.approx(2.0, rel=0.2)


def test_no_effect_needs_no_amplitude():
    none, off = tune([small_rig("", kind="none"), small_rig("", kind="parameters_only")])
    assert none.amplitude == off.amplitude == 0.0
    assert none.nominal_gap_noise < 0.05  # values are stated with five digits
    assert off.nominal_gap_noise > 1.0


@pytest.mark.parametrize(("system", "effect"), [(kind, effect) for kind in SYSTEMS for effect in SYSTEMS[kind].effects])
def test_every_effect_is_what_its_name_says(system: str, effect: str):
    rig = small_rig(effect, system=system)
    amplitude = 0.5 * largest_amplitude(rig)
    added = effect_parameters(rig, amplitude)
    assert all(name.startswith(effect.partition(":")[0] + "_") for name in added)
    assert set(nominal_parameters(rig)).isdisjoint(added)
    assert effect not in nominal_effects(rig)
    truth = full_truth(rig, amplitude)
    off = full_truth(rig, 0.0)
    assert {name for name in truth if truth[name] != off.get(name, 0.0)} == set(added)


def test_stated_values_hide_the_kind():
    """Uncertainty and digits are alike in all three kinds; only gear_ratio is known exactly."""
    for kind in ("none", "parameters_only"):
        stated = nominal_values(small_rig("", kind=kind))
        for name, (value, sd) in stated.items():
            assert sd == pytest.approx(0.0 if name == "gear_ratio" else 0.12 * value, rel=5e-3)
            assert value == float(f"{value:.5g}")


def test_a_refit_that_explodes_is_none_and_spoils_no_other_rig():
    """Far too stiff a cable for the step: its rig has no readings, the other one keeps its own."""
    rigs = [small_rig("joint:coulomb"), small_rig("motor:coulomb")]
    tuner = _Tuner(rigs)
    tuner.run_truth(np.array([0.3, 0.3]))
    stiff = np.zeros_like(tuner.refit)
    stiff[0, tuner.free[0].index("cable_stiffness")] = 25.0
    found, alone = tuner._nominal(stiff), tuner._nominal(np.zeros_like(stiff))
    assert np.isnan(found[0]).all()
    np.testing.assert_array_equal(found[1], alone[1])
