"""The identification of S3 on a record that obeys its law exactly: slopes, stages, starts, and what a number does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from tendonlab.errors import ParameterError
from tendonlab.papers.s3 import fit
from tendonlab.papers.s3.compiled import NAMES
from tendonlab.papers.s3.fit import Objective, _fastest, _Search, fit_gradient, fit_nelder_mead, profile, weakness
from tendonlab.papers.s3.groups import Record, law_record, to_dataset
from tendonlab.papers.s3.rig import FrictionParameters, assumed_rig, paper_parameters
from tendonlab.papers.s3.shapes import paper_shape
from tendonlab.papers.s3.trajectories import Trajectory

TIME = np.arange(0.0, 10.0, 0.02)
SPEED = 6.0  # deg/s, the largest
TRUE = paper_parameters()
NOISE = 0.05


def record(number: int = 6, reading: float = 54.0, *, noise: float = NOISE) -> Record:
    """A sine of torque and speed through sheaths whose output obeys the law."""
    log = pd.DataFrame(
        {"tau_in": 15.0 * np.sin(0.2 * np.pi * TIME), "tau_out": 0.0, "v": SPEED * np.cos(0.2 * np.pi * TIME)},
        index=pd.Index(TIME, name="t"),
    )
    trajectory = Trajectory("sine", 15.0, 10.0)
    plain = Record(
        name=f"run {number}", shape=paper_shape(number), load_in=reading, load_out=reading, trajectory=trajectory,
        log=log, group=number,
    )  # fmt: skip
    return law_record(plain, TRUE, noise_sd=noise, seed=number)


RECORDS = (record(), record(2, 40.0))


def soft(**changes: float) -> FrictionParameters:
    """The paper's numbers with a gate that has a slope."""
    p = TRUE.with_values({"v_thres": 1.0, "v_s": 2.0, **changes})
    return replace(p, s_v=5.0 / p.v_thres**2)


def search(*free: str) -> _Search:
    objective = Objective(RECORDS)
    return _Search(objective, free, fit._bounds(_fastest(RECORDS, TRUE)))


def test_the_objective_is_the_mean_square_over_all_samples() -> None:
    """Each record's own error comes from the model written in Python."""
    p = soft()
    errors = [np.square(r.log["tau_out"].to_numpy() - r.predict(p).tau_out) for r in RECORDS]
    assert Objective(RECORDS)(p) == pytest.approx(np.concatenate(errors).mean(), rel=1e-9)
    assert Objective(RECORDS)(TRUE) == pytest.approx(NOISE**2, rel=0.15)
    with pytest.raises(ParameterError, match="number of records"):
        Objective([])


@pytest.mark.parametrize("free", [("mu_d", "mu_s", "v_s", "v_thres"), ("mu_d", "v_thres"), ("mu_d",), ("v_s",)])
def test_slopes_by_the_logarithms_are_differences(free: tuple[str, ...]) -> None:
    """Steepness follows the threshold, and the static coefficient the dynamic one unless it is free."""
    of, p = search(*free), soft()
    x, exact = of._logs(p), of._slopes(p)
    for k, column in enumerate(exact.T):
        step = 1e-6 * np.eye(len(x))[k]
        up, down = (of.objective.residual(of.moved(p, x + s * step)) for s in (1.0, -1.0))
        assert column == pytest.approx((up - down) / 2e-6, rel=1e-4, abs=1e-4 * np.abs(column).max())


def test_a_gate_keeps_its_shape_where_the_threshold_moves() -> None:
    p = soft()
    moved = search("mu_d", "v_thres").moved(p, np.log([0.1, 0.5]))
    assert (moved.mu_d, moved.v_thres) == pytest.approx((0.1, 0.5))
    assert moved.s_v * moved.v_thres**2 == pytest.approx(p.s_v * p.v_thres**2)
    assert moved.mu_s / moved.mu_d == pytest.approx(p.mu_s / p.mu_d)
    both = search("mu_d", "mu_s").moved(p, np.log([0.1, 0.3]))
    assert (both.mu_s, both.s_v) == pytest.approx((0.3, p.s_v))


def test_a_stage_ends_where_the_slope_of_the_error_is_zero() -> None:
    of = search("mu_d", "v_thres")
    found = of.stage(soft(mu_d=1.3 * TRUE.mu_d))
    gradient = of._slopes(found).T @ of.objective.residual(found)
    there = of._slopes(soft()).T @ of.objective.residual(soft(mu_d=1.3 * TRUE.mu_d))
    assert np.abs(gradient).max() < 1e-2 * np.abs(there).max()
    assert of.objective(found) < of.objective(soft())


def test_polishing_finds_a_threshold_that_is_five_per_cent_off() -> None:
    of = search("mu_d", "v_thres")
    for share in (0.95, 1.05):
        off = TRUE.with_values({"v_thres": share * TRUE.v_thres, "mu_d": 1.02 * TRUE.mu_d})
        found = of.polished(off)
        assert of.objective(off) > 1.1 * of.objective(TRUE)
        assert of.objective(found) < 1.02 * of.objective(TRUE)
        assert found.mu_d == pytest.approx(TRUE.mu_d, rel=0.01)


def test_polishing_scans_the_threshold_within_ten_per_cent_in_even_steps() -> None:
    """The other numbers stay, and the gate keeps its shape; then a simplex of one per cent."""
    tried: list[FrictionParameters] = []

    def objective(p: FrictionParameters) -> float:
        tried.append(p)
        return abs(p.v_thres / TRUE.v_thres - 1.04)

    of = replace(search("v_thres", "mu_d"), objective=objective)  # type: ignore[arg-type]
    found = of.polished(TRUE)
    scan = tried[:62]
    assert [p.v_thres / TRUE.v_thres for p in scan] == pytest.approx([1.0, *np.linspace(0.9, 1.1, 61)])
    assert {(p.mu_d, p.mu_s, p.v_s) for p in scan} == {(TRUE.mu_d, TRUE.mu_s, TRUE.v_s)}
    assert [p.s_v * p.v_thres**2 for p in scan] == pytest.approx([TRUE.s_v * TRUE.v_thres**2] * 62)
    corners = [(p.v_thres / (1.04 * TRUE.v_thres), p.mu_d / TRUE.mu_d) for p in tried[62:65]]
    assert np.array(corners) == pytest.approx(np.exp([[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]]), rel=2e-3)
    assert found.v_thres == pytest.approx(1.04 * TRUE.v_thres, rel=1e-3)
    kept = replace(search("mu_d"), objective=objective).polished(TRUE)  # type: ignore[arg-type]
    assert kept.v_thres == TRUE.v_thres


def test_the_gate_hardens_by_three_and_the_best_start_is_kept() -> None:
    found = fit_gradient(RECORDS, num_starts=3, free=("mu_d", "v_thres"))
    stages = found.path[found.path["start"] == 1].iloc[:6]
    assert stages["steepness"].tolist() == pytest.approx([5.0, 15.0, 45.0, 135.0, 405.0, 1000.0])
    assert (found.path["s_v"] * found.path["v_thres"] ** 2).to_numpy() == pytest.approx(found.path["steepness"])
    assert len(found.path) == 3 * 6 + 1  # the last one is polished
    assert found.mse == found.path["mse"].iloc[-1] <= found.path["mse"][found.path["steepness"] == 1000.0].min()
    assert found.p.mu_d == pytest.approx(TRUE.mu_d, rel=0.02)
    assert found.p.v_thres == pytest.approx(TRUE.v_thres, rel=0.02)


def test_further_starts_lie_among_the_speeds_of_the_records() -> None:
    fastest = _fastest(RECORDS, TRUE)
    assert fastest == pytest.approx(SPEED)  # the paper's numbers are in deg/s
    first, *others = fit._starts(TRUE, fastest, 4)
    assert first is TRUE
    assert [p.v_thres for p in others] == pytest.approx(SPEED * np.array([0.02, np.sqrt(0.006), 0.3]))
    assert [p.v_s for p in others] == pytest.approx(3.0 * np.array([p.v_thres for p in others]))
    bounds = fit._bounds(fastest)
    assert bounds["v_s"] == pytest.approx((0.006, 60.0))
    assert bounds["v_thres"] == pytest.approx((0.006, 6.0))


@pytest.mark.parametrize(("free", "said"), [((), "expected some of"), (("mu_d", "s_v"), "expected some of mu_d")])
def test_what_cannot_be_free_is_refused(free: tuple[str, ...], said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        fit_gradient(RECORDS, free=free)


def test_the_simplex_starts_at_the_papers_numbers_and_then_around_them() -> None:
    found = fit_nelder_mead(RECORDS, num_starts=3, max_iterations=25, seed=3)
    assert found.path.index.tolist() == [0, 1, 2]
    assert found.mse == found.path["mse"].min()
    assert found.mse <= Objective(RECORDS)(TRUE)
    assert found.path["mse"].iloc[0] == found.mse  # it starts at the truth
    tight = fit_nelder_mead(RECORDS, start=TRUE, num_starts=2, spread=0.0, max_iterations=1).path
    gates = tight["s_v"] * tight["v_thres"] ** 2
    assert gates.iloc[0] == pytest.approx(TRUE.s_v * TRUE.v_thres**2, rel=0.3)
    assert gates.iloc[1] == pytest.approx(5.0, rel=0.3)
    with pytest.raises(ParameterError, match="num_starts = 0"):
        fit_nelder_mead(RECORDS, num_starts=0)


def test_a_number_is_identified_where_a_fifth_of_it_matters() -> None:
    found, objective = weakness(RECORDS, TRUE), Objective(RECORDS)
    base = objective(TRUE)
    for name in NAMES:
        value = getattr(TRUE, name)
        less, more = (objective(TRUE.with_values({name: share * value})) - base for share in (0.8, 1.2))
        assert tuple(found.loc[name, ["value", "rise_less", "rise_more"]]) == pytest.approx((value, less, more))
        assert found.loc[name, "identified"] == (less > 0.05 * base and more > 0.05 * base)
    assert found.loc["mu_d", "identified"]
    assert not found.loc["s_v", "identified"]  # a gate this steep is a step


def test_a_profile_is_least_at_the_truth() -> None:
    values = TRUE.mu_d * np.linspace(0.8, 1.2, 9)
    found = profile(RECORDS, TRUE, "mu_d", values.tolist())
    assert found.idxmin() == pytest.approx(TRUE.mu_d)
    assert found.to_numpy()[0] == pytest.approx(Objective(RECORDS)(TRUE.with_values({"mu_d": values[0]})))
    with pytest.raises(ParameterError, match="name = 'mu'"):
        profile(RECORDS, TRUE, "mu", [0.1])


@pytest.mark.parametrize(("known", "viscous"), [(False, False), (True, False), (False, True)])
def test_records_become_a_dataset_with_what_an_earlier_fit_left_open(known: bool, viscous: bool) -> None:
    held_out = record(7, 30.0)
    dataset = to_dataset(RECORDS, [held_out], TRUE, friction_known=known, viscous=viscous)
    si, rig, first = TRUE.system_parameters(), assumed_rig(), RECORDS[0]
    free = {"friction_coefficient": 0.0 if known else 0.03, "threshold_velocity": 0.03}
    for name, share in free.items():
        stated = dataset.parameters[name]
        assert (stated.value, stated.sd) == pytest.approx((si[name], share * si[name]))
    geometry = {"input_radius": rig.r_in, "output_radius": rig.r_out, "sheath_length": rig.L, "cable_stiffness": rig.EA}
    geometry |= {"pretension": first.pretension, "wrap_angle": first.shape.wrap_angle}
    for name, value in geometry.items():
        assert (dataset.parameters[name].value, dataset.parameters[name].sd) == (value, 0.0)
    assert ("sheath_viscous" in dataset.parameters) == viscous
    assert dataset.nominal_effects == (("sheath:capstan", "sheath:viscous") if viscous else ("sheath:capstan",))
    assert {name: s.role for name, s in dataset.signals.items()} == {
        "input_torque": "input", "input_velocity": "input", "output_torque": "output",
    }  # fmt: skip
    assert [e.split for e in dataset.experiments] == ["train", "train", "test"]
    last = dataset.experiments[-1]
    assert last.data["input_velocity"].to_numpy() == pytest.approx(np.pi / 180 * held_out.log["v"].to_numpy())
    assert last.conditions == {
        "pretension": held_out.pretension,
        "wrap_angle": held_out.shape.wrap_angle,
        "curvature_skew": held_out.shape.skew,
    }
    assert last.repeat == held_out.name
