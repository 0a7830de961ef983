"""The forward model of S3 and its twin: sample periods, the compiled system, the chain, the data set."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import solve_ivp

from tendonlab.errors import DatasetError, NumericalError, ParameterError
from tendonlab.papers.s3 import (
    Chain,
    Record,
    Shape,
    Trajectory,
    TransmissionCoefficients,
    assumed_rig,
    bowden_pair,
    cable_pretension,
    free_body,
    generate_dataset,
    paper_parameters,
    paper_shape,
    predict,
    run_chain,
    sliding_regression,
    table_1,
    weakness,
)
from tendonlab.papers.s3.chain import ChainEquations
from tendonlab.papers.s3.rig import DEGREE

SOFT = replace(paper_parameters(), s_v=2.0)
SHAPE = Shape.even(3.6, length=0.8)


def drive(rate: float, seconds: float = 4.0) -> tuple[np.ndarray, np.ndarray]:
    t = np.arange(round(seconds * rate)) / rate
    return 12.0 * np.sin(2.0 * np.pi * 0.25 * t), 3.0 * np.cos(2.0 * np.pi * 0.25 * t)


def test_a_gate_means_the_same_at_another_sample_rate() -> None:
    """A soft gate leaks: over five periods of the loop it keeps (1 - h)^5. The rest is due to the coarser steps."""
    fast, slow = (
        predict(*drive(rate), shape=SHAPE, T_s=264.8, p=SOFT, dt=1.0 / rate, y0=1.0).tau_out for rate in (1000.0, 200.0)
    )
    naive = predict(*drive(200.0), shape=SHAPE, T_s=264.8, p=SOFT, dt=0.005, gate_period=0.005, y0=1.0).tau_out
    error, mistake = (np.max(np.abs(other - fast[::5])) for other in (slow, naive))
    assert error < 0.5
    assert mistake > 2.0 * error


def test_a_held_output_does_not_drift() -> None:
    tau, v = np.linspace(0.0, 5.0, 5000), np.full(5000, 0.1)
    found = predict(tau, v, shape=SHAPE, T_s=264.8, p=paper_parameters(), dt=1e-3, y0=1.25)
    assert np.all(found.tau_out == 1.25)
    assert len(found.jumps) == 0


def test_jumps_where_the_gate_opens_are_told() -> None:
    v = np.concatenate([np.full(10, 0.1), np.full(10, 5.0)])
    found = predict(np.full(20, 10.0), v, shape=SHAPE, T_s=264.8, p=paper_parameters(), dt=1e-3)
    offset = TransmissionCoefficients.of(SHAPE, mu=0.056, T_s=264.8, r_in=0.05, r_out=0.05).offset
    np.testing.assert_allclose(found.jumps, [10.0 + offset], rtol=1e-6)


def test_a_gate_with_hysteresis_does_not_chatter() -> None:
    """Noise about the threshold: with a release at 0.8 of it the gate opens once."""
    rng = np.random.default_rng(0)
    v = np.linspace(0.5, 1.3, 400) + rng.normal(0.0, 0.03, 400)
    opened = {}
    for release in (1.0, 0.8):
        gate = predict(
            np.full(400, 9.0), v, shape=SHAPE, T_s=264.8, p=paper_parameters(), dt=1e-3, release=release
        ).gate
        opened[release] = int(np.sum((gate[1:] >= 0.5) & (gate[:-1] < 0.5)))
    assert opened[0.8] == 1
    assert opened[1.0] > 3


def test_units_of_velocity_are_converted() -> None:
    tau, v = drive(1000.0)
    degrees = predict(tau, v, shape=SHAPE, T_s=264.8, p=SOFT, dt=1e-3).tau_out
    radians = predict(tau, v * DEGREE, shape=SHAPE, T_s=264.8, p=SOFT, dt=1e-3, velocity_unit="rad/s").tau_out
    np.testing.assert_allclose(radians, degrees, rtol=1e-12, atol=1e-12)
    assert paper_parameters().in_unit("rad/s").s_v == pytest.approx(4.213e6, rel=1e-3)


def made_record(rate: float, shape: Shape = SHAPE) -> Record:
    tau, v = drive(rate)
    log = pd.DataFrame({"tau_in": tau, "v": v, "tau_out": tau}, index=pd.Index(np.arange(len(tau)) / rate, name="t"))
    return Record(
        name="made", shape=shape, load_in=54.0, load_out=54.0, trajectory=Trajectory("sine", 12.0, 4.0), log=log
    )


@pytest.mark.parametrize("rate", [200.0, 1000.0])
def test_the_compiled_system_is_the_same_law(rate: float) -> None:
    """One text, two doors: by the shape's samples, and by its wrap angle alone."""
    record = made_record(rate)
    inputs = pd.DataFrame({"input_torque": record.log["tau_in"], "input_velocity": DEGREE * record.log["v"]})
    run = bowden_pair(SOFT, record=record).simulate(inputs).outputs["output_torque"]
    middle = float(record.log["tau_in"].iloc[0])  # the system starts from the middle of the loop
    np.testing.assert_allclose(run, record.predict(SOFT, y0=middle).tau_out, rtol=0.0, atol=1e-11)


def test_a_skewed_sheath_is_the_same_in_the_system_and_in_the_statics() -> None:
    record = made_record(1000.0, Shape.skewed(3.6, length=0.8, skew=0.7, num_samples=20001))
    inputs = pd.DataFrame({"input_torque": record.log["tau_in"], "input_velocity": DEGREE * record.log["v"]})
    assert record.shape.skew == pytest.approx(0.7, abs=1e-8)
    known = bowden_pair(SOFT, record=record)
    plain = replace(record, shape=SHAPE)
    missed = bowden_pair(SOFT, record=plain).with_effects({"sheath:curvature_skew": {"curvature_skew": 0.7}})
    for system in (known, missed):
        run = system.simulate(inputs).outputs["output_torque"]
        np.testing.assert_allclose(run, record.predict(SOFT).tau_out, rtol=0.0, atol=1e-8)  # the shape is sampled


@pytest.mark.parametrize("bend", ["last fifth", "first tenth", "two bends"])
def test_of_any_shape_its_turn_and_its_unevenness_are_enough(bend: str) -> None:
    """However a sheath is bent, the loop follows from two numbers of it: to 0.05 % here, where the turn alone misses by
    2 to 10 %."""
    u = np.linspace(0.0, 1.0, 2001)
    turned = {
        "last fifth": np.clip((u - 0.8) / 0.2, 0.0, 1.0),
        "first tenth": np.clip(u / 0.1, 0.0, 1.0),
        "two bends": 0.3 * np.clip((u - 0.2) / 0.1, 0.0, 1.0) + 0.7 * np.clip((u - 0.7) / 0.1, 0.0, 1.0),
    }[bend]
    exact = made_record(200.0, Shape(0.8 * u, 3.6 * turned))
    frame = {"input_torque": np.full(3, 10.0), "input_velocity": np.ones(3)}
    inputs = pd.DataFrame(frame, index=pd.Index([0.0, 1.0, 2.0], name="t"))
    wanted = TransmissionCoefficients.of(exact.shape, mu=0.056, T_s=264.77955, r_in=0.05, r_out=0.05)
    output = wanted.K_in * 10.0 + wanted.offset

    def found(record: Record) -> float:
        return float(bowden_pair(paper_parameters(), record=record).simulate(inputs).outputs["output_torque"].iloc[-1])

    assert found(exact) == pytest.approx(output, rel=5e-4)
    assert abs(found(made_record(200.0)) / output - 1.0) > 0.01


def test_slack_and_lost_pretension_do_what_they_say() -> None:
    """Sliding fast: the offset grows by |tau|/(2 r T_s) above 1, and with the pretension that is left."""
    record = made_record(200.0)
    tau, ones = np.array([10.0, 20.0, 40.0]), np.ones(3)
    inputs = pd.DataFrame({"input_torque": tau, "input_velocity": ones}, index=pd.Index([0.0, 1.0, 2.0], name="t"))
    plain, limit = bowden_pair(paper_parameters(), record=record), 2.0 * 0.05 * record.pretension

    def friction(system: object) -> np.ndarray:
        return np.asarray(tau - system.simulate(inputs).outputs["output_torque"].to_numpy())  # type: ignore[attr-defined]

    base = friction(plain)
    slack = friction(plain.with_effects({"sheath:slack": {"slack": 1.0}}))
    np.testing.assert_allclose(slack, base * np.maximum(1.0, tau / limit), rtol=1e-12)
    less = {"sheath:pretension_loss": {"pretension_loss": 0.2}}
    np.testing.assert_allclose(friction(plain.with_effects(less)), 0.8 * base, rtol=1e-12)
    both = friction(plain.with_effects({**less, "sheath:slack": {"slack": 1.0}}))
    np.testing.assert_allclose(both, 0.8 * base * np.maximum(1.0, tau / (0.8 * limit)), rtol=1e-12)


T = np.linspace(0.0, 1.0, 401)
RIPPLED = 20.0 * np.sin(2.0 * np.pi * T) + 6.0 * np.sin(14.0 * np.pi * T)
LEVEL = -TransmissionCoefficients.of(SHAPE, mu=0.056, T_s=264.77955, r_in=0.05, r_out=0.05).offset


def spread(rise: float, **effects: dict[str, float]) -> np.ndarray:
    """The output under a rippled torque, whatever the velocity says, of one level at all speeds."""
    inputs = pd.DataFrame({"input_torque": RIPPLED, "input_velocity": np.cos(T)}, index=pd.Index(T, name="t"))
    same = replace(paper_parameters(), mu_s=paper_parameters().mu_d)
    added = {"distributed_presliding": {"turnover_rise": rise, "distributed_share": 1.0}, **effects}
    system = bowden_pair(same, record=made_record(200.0))
    system = system.with_effects({f"sheath:{name}": values for name, values in added.items()})
    return system.simulate(inputs).outputs["output_torque"].to_numpy()


def play(torque: np.ndarray) -> np.ndarray:
    held, found = 0.0, []
    for each in torque:
        held = min(max(held, each - LEVEL), each + LEVEL)
        found.append(held)
    return np.array(found)


def test_spread_presliding_with_a_sharp_corner_is_a_play_in_torque() -> None:
    """The output is held until the friction has turned over; what has no edge is a part of the torque that is held."""
    np.testing.assert_allclose(spread(1e-9), play(RIPPLED), rtol=0.0, atol=1e-7)
    viscous = spread(1e-9, viscous={"viscous": 2.0})
    np.testing.assert_allclose(viscous, play(RIPPLED - 2.0 * np.cos(T)), rtol=0.0, atol=1e-7)


def test_the_corner_is_that_of_a_bristle_before_an_elastic_load() -> None:
    """Friction z of a Dahl bristle, dz = (1 - s z) dx, and a load of stiffness K that moves by dx = dy/K."""
    rise, z, y, expected = 0.8, 0.0, 0.0, []
    fine = np.interp(np.linspace(0.0, 1.0, 400 * 2000 + 1), T, RIPPLED)
    for torque, before in zip(fine[1:], fine[:-1], strict=True):
        sense = 1.0 if torque > before else -1.0
        dy = (torque - before) / (1.0 + LEVEL * (1.0 - sense * z) / rise)
        z, y = z + (sense - z) * sense * dy / rise, y + dy
        expected.append(y)
    np.testing.assert_allclose(spread(rise)[1:], np.array(expected)[1999::2000], rtol=0.0, atol=5e-3)


def test_cables_that_stretch_slide_more_slowly() -> None:
    """A drive that moves as fast as its cables stretch, L tau'/(2 EA r²), slides nothing and holds the output."""
    record, rig = made_record(200.0), assumed_rig()
    tau = np.linspace(0.0, 20.0, 401)
    rate = 20.0 * rig.L / (2.0 * rig.EA * rig.r_in**2)
    inputs = pd.DataFrame(
        {"input_torque": tau, "input_velocity": np.full(401, 3.0 * rate)}, index=pd.Index(T, name="t")
    )
    plain = bowden_pair(paper_parameters(), record=record)
    held = plain.with_effects({"cable:compliance": {"stretch_share": 3.0}}).simulate(inputs).outputs["output_torque"]
    assert np.max(np.abs(held)) < 1e-6
    assert plain.simulate(inputs).outputs["output_torque"].iloc[-1] > 10.0


def test_pretension_and_free_body() -> None:
    assert free_body(529.5591) == pytest.approx((264.77955, 264.77955), rel=1e-12)
    assert cable_pretension(54.0) == pytest.approx(264.77955, rel=1e-12)
    assert sum(free_body(500.0, guide_force=20.0)) + 20.0 == pytest.approx(500.0)


def test_the_jacobian_of_the_chain_is_that_of_its_rate() -> None:
    rng = np.random.default_rng(1)
    for switch in ({}, {"slack": True}, {"tension_drop": True}):
        chain = Chain(shape=Shape.skewed(5.0, length=0.8, skew=0.9), pretension=100.0, num_nodes=4, **switch)
        of = ChainEquations.of(chain, Trajectory("sine", 15.0, 10.0))
        y = rng.normal(0.0, 1e-3, of.size)
        exact = of.jacobian(0.3, y)
        for k in range(of.size):
            step = np.zeros(of.size)
            step[k] = 1e-8
            numeric = (of.rate(0.3, y + step) - of.rate(0.3, y - step)) / 2e-8
            np.testing.assert_allclose(exact[:, k], numeric, rtol=1e-5, atol=1e-5 * np.max(np.abs(exact)))


def test_two_steppers_agree_on_the_chain() -> None:
    chain, torque = Chain(shape=paper_shape(6), pretension=cable_pretension(54.0)), Trajectory("sine", 15.0, 4.0)
    log = chain.simulate(torque, duration=4.0, seed=None)
    of, time = ChainEquations.of(chain, torque), log.index.to_numpy()
    run = solve_ivp(
        of.rate, (0.0, time[-1]), np.zeros(of.size), method="BDF", t_eval=time, rtol=1e-6, atol=1e-9, max_step=0.02,
        jac=of.jacobian,
    )  # fmt: skip
    assert np.max(np.abs(log["tau_out"] - of.stretching[-1] @ run.y)) < 2e-3  # of 15 N·m, at the tolerance of the twin
    assert np.max(np.abs(log["v"] - run.y[1] / DEGREE)) < 0.02


def test_a_chain_that_cannot_be_integrated_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    chain, torque = Chain(shape=paper_shape(6), pretension=200.0), Trajectory("sine", 15.0, 4.0)
    assert len(chain.simulate(torque, duration=0.005)) == 1
    monkeypatch.setattr("tendonlab.papers.s3.chain.MOST_STEPS", 2)
    with pytest.raises(NumericalError, match="could not be integrated under"):
        chain.simulate(torque, duration=1.0)


def test_the_chain_s_friction_adds_up_to_the_model_s_offset() -> None:
    chain = Chain(shape=paper_shape(4), pretension=200.0)
    law = TransmissionCoefficients.of(paper_shape(4), mu=0.056, T_s=200.0, r_in=0.05, r_out=0.05)
    assert np.sum(ChainEquations.of(chain, Trajectory("sine", 1.0, 1.0)).level) == pytest.approx(-law.offset, rel=1e-12)


@pytest.mark.parametrize("skew", [-0.9, 0.0, 0.9])
def test_a_chain_whose_tensions_fall_has_the_gain_and_the_offset_of_its_shape(skew: float) -> None:
    """Eq. 18 while it slides, less what its viscous nodes, its drive and the load take, 0.6 N·m·s/rad at most."""
    shape, T_s = Shape.skewed(6.57, length=0.8, skew=skew), cable_pretension(54.0)
    chain = Chain(shape=shape, pretension=T_s, tension_drop=True)
    log = chain.simulate(Trajectory("sine", 22.0, 10.0), duration=3.0, sample_rate=50.0, seed=None).loc[1.5:2.2]
    law = TransmissionCoefficients.of(shape, mu=0.056, T_s=T_s, r_in=0.05, r_out=0.05)
    lost = (law.output_torque(log["tau_in"].to_numpy()) - log["tau_out"].to_numpy()) / (DEGREE * log["v"].to_numpy())
    assert lost == pytest.approx(np.full(len(log), 0.5), abs=0.1)
    assert abs(law.offset + 8.15 + 0.5 * skew) < 0.1  # N·m: so the shapes are far apart


def test_a_group_has_the_four_trajectories_of_table_1() -> None:
    records = generate_dataset([(8, 30.0)], duration=1.0)
    assert [record.trajectory for record in records] == list(table_1())
    assert [round(t.period) for t in table_1()] == [5, 7, 10, 10]
    assert {record.pretension for record in records} == {cable_pretension(30.0)}


def test_repeats_differ_by_noise_alone() -> None:
    one, other, exact = (run_chain(8, 30.0, table_1()[0], duration=1.0, seed=seed) for seed in (1, 2, None))
    assert not one.log["tau_out"].equals(other.log["tau_out"])
    spread = np.std([one.log["tau_out"] - exact.log["tau_out"], other.log["tau_out"] - exact.log["tau_out"]])
    assert spread == pytest.approx(0.15, rel=0.15)


def test_data_tell_two_of_the_five_numbers() -> None:
    p = paper_parameters()
    record = run_chain(6, 54.0, Trajectory("sine", 15.0, 10.0))
    log = record.log.assign(
        tau_out=record.predict(p).tau_out + np.random.default_rng(3).normal(0.0, 0.15, len(record.log))
    )
    told = weakness([replace(record, log=log)], p)
    assert list(told.index[told["identified"]]) == ["mu_d", "v_thres"]


def test_bad_input_is_named() -> None:
    with pytest.raises(ParameterError, match="velocity_unit = 'rpm': expected one of deg/s, rad/s"):
        replace(paper_parameters(), velocity_unit="rpm")
    with pytest.raises(ParameterError, match="kind = 'square'"):
        Trajectory("square", 1.0, 1.0)
    with pytest.raises(ParameterError, match=r"dt = 0\.0"):
        predict(np.zeros(2), np.zeros(2), shape=SHAPE, T_s=1.0, p=SOFT, dt=0.0)
    with pytest.raises(ParameterError, match="turning"):
        Shape(np.array([0.0, 1.0]), np.array([0.0, -1.0]))
    with pytest.raises(ParameterError, match="shape = 11: expected 1"):
        paper_shape(11)
    with pytest.raises(ParameterError, match="pretension_profile = 'flat'"):
        TransmissionCoefficients.of(SHAPE, mu=0.1, T_s=1.0, r_in=0.1, r_out=0.1, pretension_profile="flat")
    with pytest.raises(DatasetError, match="fewer than 20 samples"):
        sliding_regression(made_record(200.0), v_thres=10.0)


def test_where_a_cable_is_loose_each_node_loses_its_share_of_its_own_torque() -> None:
    """Torques of the stretches from 30 to 6 N·m: the first nodes are loose, the last keep the friction of the law."""
    chain = Chain(shape=paper_shape(3), pretension=100.0, slack=True, num_nodes=4)
    of = ChainEquations.of(chain, Trajectory("sine", 15.0, 10.0))
    torque = np.array([30.0, 24.0, 18.0, 4.0, 2.0])
    position = -np.concatenate([[0.0], np.cumsum(torque)]) / of.stiffness
    y = np.zeros(of.size)
    y[0], y[2:6], y[-2] = position[0], position[1:5], position[5]
    e, level, _, _ = of.nodes(y)
    np.testing.assert_allclose(e, torque)
    np.testing.assert_allclose(level, np.maximum(of.level, torque[:-1] * of.share))
    assert np.any(level > of.level)
    assert np.any(level == of.level)
