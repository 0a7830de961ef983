"""What the models, fits and procedures of S2 promise, on synthetic logs."""

import numpy as np
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers import s2
from tendonlab.procedures import lowpass, remove_mean

RIG = s2.constants()
GEAR = {"alpha": RIG.alpha, "beta": RIG.beta}


def test_the_table_of_differences_holds() -> None:
    found = s2.differences(RIG)
    assert found["within"].all(), found[~found["within"]]
    assert (found["status"] == "paper").sum() == 16  # Table I
    of_fits = found[found.index.str.startswith("Table II:")]
    assert len(of_fits) == 20
    assert (of_fits["status"] == "twin").all()


def gear_fit(seed: int) -> s2.Estimate:
    points = s2.gear_points(RIG, seed=seed)
    return s2.fit_gear_friction(points["speed"], points["torque_mean"], points["torque_std"])


def test_gear_friction_is_found_and_its_intervals_cover() -> None:
    """Alpha within 6 %, beta within 15 %, and 90 of 100 intervals (3 less or more) hold the truth."""
    fits = [gear_fit(seed) for seed in range(100)]
    covered = {name: sum(fit.covers(GEAR)[name] for fit in fits) for name in GEAR}
    assert min(covered.values()) >= 87
    for name, share in (("alpha", 0.06), ("beta", 0.15)):
        errors = np.array([fit[name] / GEAR[name] - 1.0 for fit in fits])
        assert np.mean(np.abs(errors) < share) >= 0.95
        assert abs(np.mean(errors)) < 2.5 * np.std(errors) / 10.0  # no bias


def test_viscous_friction_is_taken_off_first() -> None:
    points = s2.gear_points(RIG)
    loaded = points["torque_mean"] + RIG.c_m * points["speed"]
    plain = s2.fit_gear_friction(points["speed"], points["torque_mean"], points["torque_std"])
    found = s2.fit_gear_friction(points["speed"], loaded, points["torque_std"], c_m=RIG.c_m)
    assert found.values == pytest.approx(plain.values, rel=1e-5)


def test_the_cable_is_found_and_its_interval_covers() -> None:
    """K within 0.5 %, c within 5 %, NRMSE below 2 %; half widths of the order of Table II."""
    covered = np.zeros(3)
    for seed in range(40):
        ramps = s2.cable_ramps(RIG, seed=seed)
        fit = s2.fit_cable(ramps["elongation"], ramps["rate"], ramps["force"], contiguous=False, seed=seed)
        assert fit["K"] == pytest.approx(RIG.K, rel=0.005)
        assert fit["c"] == pytest.approx(RIG.c, rel=0.05)
        assert fit.validation_error is not None
        assert fit.validation_error < 0.02
        assert 50.0 < fit.half_widths["K"] < 200.0
        assert 300.0 < fit.half_widths["c"] < 900.0
        assert fit.warnings == ()
        covered += list(fit.covers({"F_0": 200.0, "K": RIG.K, "c": RIG.c}).values())
    assert np.all(covered >= 34)  # of 40 at 95 %: fewer has probability 1e-3


def test_one_speed_cannot_tell_damping_from_the_offset() -> None:
    ramps = s2.cable_ramps(RIG).iloc[:4000]
    fit = s2.fit_cable(ramps["elongation"], ramps["rate"], ramps["force"])
    assert len(fit.warnings) == 1
    assert fit.warnings[0].startswith("rate: 1 speed in one direction")
    assert fit.condition is not None
    assert fit.condition > 1e6
    assert fit.half_widths["c"] > RIG.c  # and the interval says so
    assert fit["K"] == pytest.approx(RIG.K, rel=0.005)


@pytest.mark.parametrize("cable", [1, 2])
def test_the_bushings_are_found(cable: int) -> None:
    """All eight within 2.5 half widths, which are of the order of those printed in Table II."""
    truth = RIG.bushings[cable - 1]
    for seed in range(3):
        loop = s2.bushing_loop(RIG, cable=cable, seed=seed)
        assert len(loop) == 7225
        fit = s2.fit_bushing(loop["theta"], loop["velocity"], loop["force"], tension=RIG.T)
        for name, width in fit.half_widths.items():
            assert abs(fit[name] - truth[name]) < 2.5 * width, name
            expected = {"a": 0.10, "b": 0.0035, "c": 0.002 if (cable, name) == (2, "c2") else 0.001}[name[0]]
            assert 0.5 * expected < width < 2.0 * expected, name


def test_coarse_force_sensors_average_out() -> None:
    """5 N of resolution: the intervals of Table II, 0.05 N, come from averaging."""
    loop = s2.bushing_loop(RIG, quantize=5.0)
    fit = s2.fit_bushing(loop["theta"], loop["velocity"], loop["force"], tension=RIG.T)
    assert fit["a1"] == pytest.approx(60.60, abs=0.5)
    assert fit["b11"] == pytest.approx(-0.7088, abs=0.02)


def test_filtered_samples_repeat_one_another() -> None:
    """Behind a filter of 1 Hz the naive intervals are too narrow; samples at 2.5 Hz give honest ones."""
    loop = s2.bushing_loop(RIG)
    smooth = {name: lowpass(loop[name], cutoff=1.0, sample_rate=100.0) for name in loop}
    away = np.abs(smooth["velocity"]) > 0.038  # 1 s around reversals is left out
    naive, honest = (
        s2.fit_bushing(*(smooth[name][away][::step] for name in ("theta", "velocity", "force")), tension=RIG.T)
        for step in (1, 40)
    )
    widths = np.array([honest.half_widths[name] / naive.half_widths[name] for name in naive.half_widths])
    assert np.all(widths > 4.0)  # sqrt(40) = 6.3 where every sample counts as one
    outside = [abs(honest[n] - RIG.bushings[0][n]) > 2.5 * w for n, w in honest.half_widths.items()]
    assert sum(outside) == 0


def test_the_static_force_difference() -> None:
    """F_r1 - F_r2 that holds the level joint at rest: 22.70 N."""
    assert s2.equations.holding_difference(RIG, 0.0) == pytest.approx(22.70, abs=0.005)


def test_small_angles_are_a_capstan() -> None:
    """Eq. 10 to first order in theta: mu T theta."""
    from tendonlab import friction

    for law in (friction.BushingSine(sine_coefficient=0.3), friction.BushingCapstan(capstan_coefficient=0.3)):
        assert law.force(velocity=1.0, wrap_angle=1e-4, load=200.0) == pytest.approx(0.3 * 200.0 * 1e-4, rel=1e-4)


def test_feed_forward_keeps_the_sense_of_the_reference() -> None:
    plan = s2.reference()
    found = s2.feedforward(RIG, plan)
    real = s2.simulate(RIG, plan, sense="hold")
    expected = real["F_act_1"] - real["F_r_1"]
    moved = np.abs(plan.angle - real["theta"].to_numpy()).max() * RIG.T  # slope of eq. 11 by theta is below T
    assert np.abs(found["F_a_1"] - expected).max() < 2.0 * moved


def test_the_reference_sense_makes_the_shift_vanish() -> None:
    """The source's reason why T_shift does no harm."""
    plan = s2.reference()
    real, known = (s2.simulate(RIG, plan, sense=sense)["F_act_1"] for sense in ("hold", "reference"))
    shifts = s2.force_shift(plan.time, known, real)["shift"]
    assert np.all(np.abs(shifts) < 1e-9)
    assert np.abs(known - real).max() < 1e-9


def test_smooth_friction_lies_between_the_senses() -> None:
    plan = s2.reference(end=15.0)
    plain, smooth = (s2.simulate(RIG, plan, sense=sense) for sense in ("instantaneous", "smooth"))
    resting = s2.shifted(plan) & (plan.time > 12.0) & (plan.time < 13.0)
    theta = plain["theta"].to_numpy()[resting]
    both = [s2.equations.bushing_force(RIG.bushings[0], theta, way, RIG.T) for way in (1.0, -1.0)]
    friction = (smooth["F_act_1"] - smooth["F_r_1"]).to_numpy()[resting]
    assert friction == pytest.approx(0.5 * (both[0] + both[1]), abs=1.0)


def test_a_controller_follows_the_reference() -> None:
    plan = s2.reference()
    run = s2.simulate(RIG, plan, controller=s2.PID(), ripple=0.1, sense="hold")
    open_loop = s2.simulate(RIG, plan, ripple=0.1, sense="hold")
    error, loose = (np.abs(one["theta"].to_numpy() - plan.angle).max() for one in (run, open_loop))
    assert error < 0.5 * loose
    assert error < 2e-3


def test_the_band_holds_what_it_promises() -> None:
    """The band of a bushing's force from a fit: of fresh samples 95 of 100 lie inside."""
    loop = s2.bushing_loop(RIG)
    fit = s2.fit_bushing(loop["theta"], loop["velocity"], loop["force"], tension=RIG.T)
    theta, sense = loop["theta"].to_numpy(), np.sign(loop["velocity"].to_numpy())
    moving = sense != 0
    low, high = s2.force_band(
        fit.values, fit.covariance, theta[moving], sense[moving], tension=RIG.T, noise_sd=fit.residual_sd
    )
    again = s2.bushing_loop(RIG, seed=1)["force"].to_numpy()[moving]
    assert np.mean((again > low) & (again < high)) == pytest.approx(0.95, abs=0.01)
    narrow = s2.force_band(fit.values, fit.covariance, theta[moving], sense[moving], tension=RIG.T)
    assert np.all(narrow[1] - narrow[0] < 0.15 * (high - low))


def test_what_is_wrong_is_named() -> None:
    with pytest.raises(ParameterError, match="viscous_reading = 'D': expected one of A, B, C"):
        s2.constants(viscous_reading="D")
    with pytest.raises(ParameterError, match="coriolis = 'none': expected one of corrected, printed"):
        s2.equations.joint_rate(RIG, 0.0, 0.0, 0.0, coriolis="none")
    with pytest.raises(ParameterError, match="sense = 'always': expected one of instantaneous"):
        s2.simulate(RIG, s2.reference(end=2.0), sense="always")  # type: ignore[arg-type]
    with pytest.raises(ParameterError, match=r"move of 0\.01 rad: expected at least 0\.045 rad to reach 0\.06 rad/s"):
        s2.reference((0.0, 0.01))
    with pytest.raises(ParameterError, match=r"torque_std = 0\.0: expected positive spreads"):
        s2.fit_gear_friction([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [0.0, 1.0, 1.0])
    with pytest.raises(ParameterError, match="force: 0 samples above 200 N; expected 10 or more"):
        s2.fit_cable(np.zeros(20), np.zeros(20), np.full(20, 100.0))
    with pytest.raises(ParameterError, match=r"velocity: 0 samples of sense -1; expected 20 or more"):
        s2.fit_bushing(np.linspace(0.0, 1.0, 50), np.ones(50), np.ones(50), tension=200.0)


def test_a_path_that_grows_with_the_angle_is_no_friction() -> None:
    """A path error stretches both cables alike in both senses of motion, and hardly moves the joint: by what its slope
    takes from the pull, path sin(theta) (F_1 + F_2), over the stiffness 2 K r² cos²(theta)."""
    plan = s2.reference()
    plain, longer = (s2.simulate(RIG, plan, path_error=path) for path in (0.0, 3e-4))
    assert 2e-5 < np.abs(plain["theta"] - longer["theta"]).max() < 6e-5
    added = sum(longer[f"F_act_{i}"] - plain[f"F_act_{i}"] for i in (1, 2)).to_numpy() / 2.0
    theta, cruise = plain["theta"].to_numpy(), plan.cruise()
    wanted = RIG.K * 3e-4 * (1.0 - np.cos(theta))
    assert added[cruise] == pytest.approx(wanted[cruise], abs=0.4)  # N: 0.3 N of damping by the rate of the path


def test_three_readings_of_a_misprinted_unit() -> None:
    """Reading A asks 4.84 N*m and 47 A of the motor at 48 V / k_m; B and C are of the size of a bearing's."""
    a, b, c = (s2.constants(viscous_reading=reading).c_m for reading in "ABC")
    top = 48.0 / RIG.k_m
    assert a * top == pytest.approx(4.84, abs=0.005)
    assert a * top / RIG.k_m == pytest.approx(47.0, abs=0.5)
    assert b == pytest.approx(9.854e-5, rel=1e-4)
    assert c == pytest.approx(1.0319e-5, rel=1e-12)


@pytest.mark.cpu(15)
def test_the_bench_finds_the_slopes_of_the_bushings_and_loses_their_level() -> None:
    """Fig. 11 by PID, 5 N sensors and a 1 Hz filter. Removing the mean of the force takes one number from both a of a
    cable, the mean of its branches over the sweep: 5 and 16 N. Slopes, edges and a_1 - a_2 remain, and the intervals of
    slopes and edges cover."""
    slopes = ("b11", "b12", "b21", "b22", "c1", "c2")
    covered, errors = [], []
    for seed in range(12):
        for cable, loop in s2.bushing_bench(RIG, seed=seed).items():
            fit = s2.fit_bushing(loop["theta"], loop["velocity"], loop["force"], tension=RIG.T)
            true = RIG.bushings[cable - 1]
            covered += [abs(fit[name] - true[name]) <= fit.half_widths[name] for name in slopes]
            errors.append([cable, fit["a1"] - true["a1"], fit["a2"] - true["a2"]])
    assert 0.89 <= np.mean(covered) <= 0.99
    by_cable = {cable: np.array([e[1:] for e in errors if e[0] == cable]) for cable in (1, 2)}
    np.testing.assert_allclose(by_cable[1].mean(axis=0), 4.3, atol=0.3)
    np.testing.assert_allclose(by_cable[2].mean(axis=0), 16.1, atol=0.3)
    for shift in by_cable.values():
        np.testing.assert_allclose(shift[:, 0], shift[:, 1], atol=0.6)


def test_a_signal_without_its_mean() -> None:
    np.testing.assert_allclose(remove_mean([1.0, 2.0, 6.0]), [-2.0, -1.0, 3.0])
    with pytest.raises(ParameterError, match="values"):
        remove_mean([1.0, np.nan])
