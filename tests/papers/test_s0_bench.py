"""S0's bench: what is refused, options, and limits that can be worked out by hand."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from tendonlab import _core
from tendonlab.errors import ParameterError
from tendonlab.papers import s0
from tendonlab.papers.s0 import bearings, drive, fits, runs, twin
from tendonlab.procedures import steady_segment, wavelet_denoise

X = s0.configuration("C25P104GX-D2M")


def test_reactions_hold_the_shaft_in_balance() -> None:
    """Forces and moments about A vanish in both planes, for every configuration."""
    for name in s0.configurations():
        of = s0.configuration(name)
        for pull_axis in ("z", "y"):
            r = s0.pulley_reactions(of, pretension=13.0, axis=pull_axis)
            pull = s0.cable_pull(of, 13.0)
            down, along = (pull, 0.0) if pull_axis == "y" else (0.0, pull)
            p = of.pulley
            assert r.A_y + r.B_y == pytest.approx(p.weight + of.external.weight + down, rel=1e-12)
            assert r.A_z + r.B_z == pytest.approx(along, rel=1e-12, abs=1e-12)
            moment = p.gravity * p.weight + (p.disc or 0.0) * of.external.weight + p.cable * down
            assert p.bearing * r.B_y == pytest.approx(moment, rel=1e-12)
            assert p.bearing * r.B_z == pytest.approx(p.cable * along, rel=1e-12, abs=1e-12)


def test_a_cable_that_pulls_down_adds_linearly() -> None:
    """Preload raises the relative load in proportion; across the weights it adds in quadrature, less at first."""
    down = [s0.relative_load(X, pretension=t, cable_axis="y") for t in (0.0, 5.0, 10.0)]
    assert down[1] - down[0] == pytest.approx(down[2] - down[1], rel=1e-12)
    assert s0.relative_load(X, pretension=5.0) < down[1]


def test_the_crossed_cable_loads_the_shaft_less() -> None:
    """By 6 %, and by more the nearer the shafts (S0 section 3.1)."""
    parallel = s0.configuration("C25P104GP-D2M")
    assert s0.cable_pull(X, 1.0) / s0.cable_pull(parallel, 1.0) == pytest.approx(0.936, abs=5e-4)
    near = s0.cable_pull(X, 1.0, centres=0.1) / s0.cable_pull(parallel, 1.0, centres=0.1)
    assert near < 0.9
    assert s0.cable_pull(X, 1.0, cable_diameter=True) < s0.cable_pull(X, 1.0)


def test_a_rigid_drive_in_a_steady_run_needs_the_factor_of_eq_8() -> None:
    still = {"ratio": 4.16, "inertias": (1e-4, 6.5e-5, 4e-3, 3.8e-3), "viscous": (7e-4, 7e-4)}
    steady = s0.motor_torque(speed=50.0, acceleration=0.0, friction=0.1, **still)
    assert steady == pytest.approx(7e-4 * s0.viscous_factor(4.16) * 50.0 + 0.1, rel=1e-14)


def test_the_printed_exponent_is_an_option() -> None:
    """S0 prints delta where alpha is meant."""
    model = s0.reconstructed("C35P75GX")
    same = s0.Proposed(**{**vars(model), "alpha": model.delta})
    w = np.array([2.0, 16.0, 60.0])
    printed = model.torque(w, load=2.0, ratio=2.1, exponent="printed")
    assert printed == pytest.approx(same.torque(w, load=2.0, ratio=2.1), rel=1e-14)
    assert np.all(np.abs(printed - model.torque(w, load=2.0, ratio=2.1)) > 1e-3)


def test_tables_6_and_7_do_not_break_a_dynamic_model() -> None:
    """F_s near 0: warned of, and the level is held up; the end is the steady torque."""
    printed = s0.printed_lugre("C35P75GX")
    time = np.linspace(0.0, 1.0, 401)
    with pytest.warns(UserWarning, match="no stiction"):
        z, torque = s0.dynamic_lugre(
            time,
            velocity=30.0 * time,
            curve=printed.curve,
            bristle=_core.friction.Presliding(bristle_stiffness=50.0, bristle_damping=0.0),
            viscous=printed.F_v,
        )
    assert np.all(np.isfinite(z))
    assert torque[-1] == pytest.approx(float(printed.torque(30.0)), rel=1e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        curve = s0.Lugre(F_c=0.1, F_s=0.15, theta_s=5.0, F_v=0.0).curve
        bristle = _core.friction.Presliding(bristle_stiffness=50.0, bristle_damping=0.05)
        s0.dynamic_lugre(time, velocity=time, curve=curve, bristle=bristle, viscous=0.0)


@pytest.mark.parametrize("speed", [105.0, 20.0, -40.0])
def test_every_run_starts_at_the_same_place_and_takes_the_same_cable(speed: float) -> None:
    run = s0.simulate_run(X, speed=speed)
    angle = run["input_angle"].to_numpy()
    assert angle[0] == pytest.approx(0.0, abs=5 * runs.ANGLE_NOISE)
    assert angle[-1] == pytest.approx(np.sign(speed) * runs.TRAVEL, abs=0.02)


def test_calibration_and_creep_of_the_cells_are_taken_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run of 40 s without noise: creep alone would add a third of a per cent from its first to its last seconds."""
    monkeypatch.setattr(runs, "FORCE_NOISE", 0.0)
    run = s0.simulate_run(X, speed=5.0, seed=2)
    torque = s0.torque_of(run)
    assert torque[38000] == pytest.approx(torque[1000], rel=1e-9)
    creeping = s0.torque_of(run, cells=tuple(replace(cell, creep=0.0) for cell in runs.CELLS))
    assert creeping[38000] / creeping[1000] - 1 == pytest.approx(3.9e-3, rel=0.1)  # 0.5 % (e^(-1/20) - e^(-38/20))
    raw = runs.LEVER * (run["reading_1"] + run["reading_2"]).to_numpy()
    assert abs(raw[20000] / torque[20000] - 1) > 0.01


def test_the_wavelet_depth_is_capped_with_a_warning() -> None:
    """At 105 rad/s a run has fewer than the 7168 samples that ten levels of db4 need; eight still take most of the
    noise."""
    run = s0.simulate_run(X, speed=105.0)
    time, angle = run.index.to_numpy(dtype=float), run["input_angle"].to_numpy()
    with pytest.warns(UserWarning, match="2315 samples allow 8 levels"):
        denoised = wavelet_denoise(angle)
    kept = steady_segment(time, angle)
    line = np.polynomial.Polynomial.fit(time[kept], denoised[kept], 1)
    assert np.std(denoised[kept] - line(time[kept])) < 0.3 * runs.ANGLE_NOISE


def test_no_speed_comes_twice_in_a_row() -> None:
    order = s0.schedule(np.array([-50.0, 50.0, 100.0]), num_runs=20, seed=1)
    assert np.all(np.diff(order) != 0)
    assert [np.sum(order == v) for v in (-50.0, 50.0, 100.0)] == [20, 20, 20]


def test_maps_are_odd_and_repeat_with_their_seed() -> None:
    points = s0.twin_map(X, seed=7)
    assert points.equals(s0.twin_map(X, seed=7))
    assert len(points) == 2 * len(twin.SPEEDS)
    assert twin.friction(X, -twin.SPEEDS) == pytest.approx(-twin.friction(X, twin.SPEEDS), rel=1e-15)


def test_what_makes_no_sense_is_refused() -> None:
    for broken, said in (
        (lambda: s0.relative_load(X, scope="bearings"), "scope = 'bearings': expected one of pulley, transmission"),
        (lambda: s0.relative_load(X, cable_axis="x"), "cable_axis = 'x': expected one of z, y"),
        (lambda: s0.relative_load(X, disc="F"), "disc = 'F': expected one of E, end"),
        (lambda: s0.cable_pull(X, -1.0), "pretension = -1.0: expected a value in"),
        (lambda: s0.cable_pull(X, np.nan), "pretension = nan: expected a value in"),
        (lambda: s0.cable_pull(X, 1.0, centres=0.06), "centres = 0.06: expected more than"),
        (lambda: s0.torsional_stiffness(X, load_torque=20.0, pretension=100.0), "pretension = 100.0: expected more"),
        (lambda: s0.simulate_run(X, speed=0.0), "travel = 200.0: expected more than"),
        (lambda: s0.simulate_run(X, speed=105.0, travel=1.0), "travel = 1.0: expected more than 22"),
        (lambda: s0.reconstructed("C35P75GX", "table9"), "set = 'table9': expected one of table8_set"),
        (lambda: s0.printed_lugre("C35"), "transmission = 'C35': expected one of C25P104GX, C35P75GX"),
        (lambda: s0.fit_static_lugre(np.ones(5), np.ones(4)), "torque has 4 points: expected 5"),
        (lambda: fits.fit_proposed(np.ones(5), np.ones(5), np.ones(4), ratio=2.0), "torque has 4 points: expected 5"),
        (lambda: s0.reconstructed("C35P75GX").law(2.0, exponent="beta"), "exponent = 'beta': expected alpha or"),
    ):
        with pytest.raises(ParameterError) as refused:
            broken()
        assert said in str(refused.value)


def test_the_scopes_of_own_weight() -> None:
    """Own weight of both shafts as the reference: smaller by the share of the pulley's."""
    both = bearings.reactions(X.pulley).total + bearings.reactions(X.capstan).total
    share = bearings.reactions(X.pulley).total / both
    assert s0.relative_load(X, scope="transmission") == pytest.approx(share * s0.relative_load(X), rel=1e-14)


def test_stiffness_without_torque_is_that_of_two_free_spans() -> None:
    """k = 2 r² EA / L: wraps carry no change of tension."""
    k = s0.torsional_stiffness(X, load_torque=0.0, pretension=50.0)
    span = np.sqrt(0.15**2 - 0.0645**2)
    assert k == pytest.approx(2 * 0.052**2 * drive.AXIAL_STIFFNESS / span, rel=1e-12)
