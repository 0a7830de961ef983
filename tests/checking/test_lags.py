"""Lags of the outputs: the step of all unknowns together against one dense least-squares problem, and the weight."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from checking.pendulum import CONSTANT, COULOMB, GRAVITY, INERTIA, MOTIONS, VISCOUS, Motion, late_run, record
from tendonlab.checking.check import check
from tendonlab.checking.clocks import SCANNED
from tendonlab.checking.equation import Equation
from tendonlab.checking.lags import _by_place, _by_prescribed, _mended, _saved, _spoilt, _steps, _weights, lags
from tendonlab.checking.logs import read_logs
from tendonlab.checking.regression import FREEDOM, Fit, Unknown
from tendonlab.checking.terms import Terms


def test_the_step_is_that_of_all_unknowns_at_once() -> None:
    """Two shared unknowns, two of each of three experiments: eliminated one by one, and solved as one matrix."""
    rng = np.random.default_rng(0)
    run = np.repeat([0, 1, 2], [40, 50, 60])
    residual, columns = rng.standard_normal((2, 150)), rng.standard_normal((2, 2, 150))
    own, own_belief = rng.standard_normal((2, 2, 150)), np.array([4.0, 9.0])
    unknowns = (Unknown("a", sd=0.5), Unknown("b", sd=0.2, logarithm=True))
    at, x = Terms(residual, columns, unknowns, np.array([2.0, 3.0])), np.array([0.1, -0.3])
    level, share = np.sqrt(np.mean(np.square(residual / at.size[:, None]), axis=1)), np.array([0.5, 0.2])
    weight = (FREEDOM + 1) / (FREEDOM + (residual / at.size[:, None] / level[:, None]) ** 2)
    fit = Fit(0.0, x, np.ones(2), level, residual, weight, 0.0)
    step, sd = _steps(at, fit, own, own_belief, run, share, num=3)

    root = np.sqrt(weight * share[:, None]) / level[:, None] / at.size[:, None]
    rows = [(columns[0] * root).ravel(), (columns[1] * np.exp(x[1]) * root).ravel()]
    rows += [(own[k] * root * (run == i)).ravel() for i in range(3) for k in range(2)]
    matrix = np.array(rows).T
    belief = np.array([1 / 0.5**2, 1 / 0.2**2, *([4.0, 9.0] * 3)])
    start = np.array([*x, *[0.0] * 6])
    information = matrix.T @ matrix + np.diag(belief)
    best = -np.linalg.solve(information, matrix.T @ (residual * root).ravel() + belief * start)
    np.testing.assert_allclose(step, best[2:].reshape(3, 2).T, rtol=1e-8)
    variance = np.diag(np.linalg.inv(information))[2:]
    np.testing.assert_allclose(sd, np.sqrt(variance).reshape(3, 2).T, rtol=1e-8)


def test_the_weight_of_a_lag_is_the_rms_of_the_equation_that_it_changes_most() -> None:
    slopes = np.zeros((2, 2, 6))
    slopes[0, 1] = [3.0, -3.0, 3.0, 0.0, 0.0, 0.0]
    slopes[0, 0] = [1.0, 1.0, 1.0, 2.0, 2.0, 2.0]
    slopes[1, 0] = [0.0, 0.0, 0.0, 4.0, 0.0, 0.0]
    weight = _weights(slopes, np.array([0, 0, 0, 1, 1, 1]), 2)
    np.testing.assert_allclose(weight, [[3.0, 2.0], [0.0, np.sqrt(16.0 / 3.0)]])


@pytest.mark.parametrize("late", [0.012, 0.06])
def test_lags_come_out_with_their_sd_and_in_their_experiment(late: float, tmp_path: Path) -> None:
    """Friction that the equation lacks shifts a lag by a few milliseconds, more than the sd of the noise alone."""
    rig = late_run(record(), "sweep", late).write(tmp_path)
    logs = read_logs(rig, rig.system().info)
    assert logs is not None
    found = lags(Equation(rig, rig.system()), logs)
    assert found.channels == ("joint_angle",)
    by_name = dict(zip([e.name for e in rig.experiments], found.seconds[0], strict=True))
    assert by_name.pop("sweep") == pytest.approx(late, abs=0.003)
    assert list(by_name.values()) == pytest.approx([0.0] * 3, abs=0.003)
    assert np.all((found.sd > 1e-6) & (found.sd < 0.005))
    assert 0.0 < found.level < 0.1
    kept = logs.regular(100)
    assert 50 < len(kept) <= 100
    assert logs.clear[kept].all()


def test_one_quick_run_that_is_late_does_not_set_the_lag_that_slow_ones_share(tmp_path: Path) -> None:
    """Its lag is known far better than theirs."""
    slow: dict[str, Motion] = {f"slow {k}": lambda t, k=k: 0.8 * np.sin((0.6 + 0.05 * k) * t) for k in range(4)}
    rig = late_run(record(motions={**slow, "quick": MOTIONS["quick"]}), "quick", 0.02).write(tmp_path)
    logs = read_logs(rig, rig.system().info)
    assert logs is not None
    found = lags(Equation(rig, rig.system()), logs)
    assert found.sd[0, -1] < 0.2 * np.min(found.sd[0, :-1])
    assert found.gain[-1] > 10.0 * np.max(found.gain[:-1])


def test_friction_of_its_own_saves_what_it_explains() -> None:
    """Of an effort that is dry and viscous friction nearly all, of one across them nothing."""
    rng = np.random.default_rng(0)
    speed = np.sin(np.linspace(0.0, 20.0, 400))
    columns, noise = np.stack([np.sign(speed), speed], axis=1), rng.standard_normal(400)
    friction = 3.0 * np.sign(speed) + 2.0 * speed + noise
    alone = np.sum(np.log1p(friction**2)) - np.sum(np.log1p(noise**2))
    assert _saved(friction, columns) == pytest.approx(alone, rel=0.02)
    across = 3.0 * np.cos(np.linspace(0.0, 20.0, 400)) + noise
    assert _saved(across, columns) < 0.1 * np.sum(np.log1p(across**2))


def test_dry_friction_along_a_prescribed_motion_saves_what_it_explains() -> None:
    """Where the part began is free as well. A lag, which follows the velocity, is explained a little."""
    rng = np.random.default_rng(0)
    run = np.repeat([0, 1], 400)
    velocity, noise = np.tile(np.sin(np.linspace(0.0, 20.0, 400)), 2), rng.standard_normal(800)
    logs: Any = SimpleNamespace(run=run, driving={"actuator_velocity": np.stack([velocity] * 3)})
    equation: Any = SimpleNamespace(prescribed=("actuator_velocity",))
    share = np.array([0.5])
    cold, late = 5.0 * np.sign(velocity) - 8.0 + noise, 5.0 * np.cos(np.linspace(0.0, 40.0, 800)) + noise
    surprise = 0.5 * (np.sum(np.log1p(cold[:400] ** 2)) - np.sum(np.log1p(noise[:400] ** 2)))
    assert _by_prescribed(equation, logs, cold[None], 0, share) == pytest.approx(surprise, rel=0.02)
    assert _by_prescribed(equation, logs, late[None], 0, share) < 0.1 * surprise
    assert _by_prescribed(SimpleNamespace(prescribed=()), logs, cold[None], 0, share) == 0.0  # type: ignore[arg-type]


def test_a_cold_run_is_not_late(tmp_path: Path) -> None:
    """Twice the friction in one run makes that run lag in a scan; a late run lags beyond what its friction explains."""
    logs = record(motions={"cold": MOTIONS["reversals"], **MOTIONS})
    time, angle, current = logs.runs["cold"]
    speed = np.gradient(np.interp(time, time[::5], angle[::5]), time)
    cold = replace(logs, runs={**logs.runs, "cold": (time, angle, current + 0.3 * np.tanh(speed / 0.02))})
    for rig, is_late in ((cold, False), (late_run(logs, "cold", 0.1), True)):
        data = rig.write(tmp_path / str(is_late))
        found = read_logs(data, data.system().info)
        assert found is not None
        scanned = lags(Equation(data, data.system()), found).scanned
        assert bool(scanned[0] > SCANNED) == is_late


def test_a_run_in_presliding_leads_no_other(tmp_path: Path) -> None:
    """Bristles that bend 10 mrad hold a motion of 15 mrad: their torque comes late, as if the angle led."""
    logs = record()
    time = logs.runs["quick"][0]
    angle = 0.015 * np.sin(2 * np.pi * 1.3 * time)
    speed, acceleration = (np.gradient(of, time) for of in (angle, np.gradient(angle, time)))
    bent = np.zeros(len(time))
    for k, moved in enumerate(np.diff(angle), start=1):
        bent[k] = np.clip(bent[k - 1] + moved / 0.01, -1.0, 1.0)
    effort = INERTIA * acceleration + VISCOUS * speed + GRAVITY * np.sin(angle) + COULOMB * bent
    rng = np.random.default_rng(3)
    micro = (time, angle + 2e-5 * rng.standard_normal(len(time)), effort / CONSTANT)
    data = replace(logs, runs={**logs.runs, "micro": micro}).write(tmp_path)
    found = read_logs(data, data.system().info)
    assert found is not None
    late = lags(Equation(data, data.system()), found)
    assert late.scanned[-1] == 0.0
    assert late.gain[-1] == 0.0


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("seed", range(4))
def test_a_run_that_never_slides_lags_no_other(seed: int, tmp_path: Path) -> None:
    """At most single samples of it can be judged: its lag is not known, and the others are judged as without it."""
    rig = record(motions={**MOTIONS, "still": lambda t: 3e-4 * np.sin(2.0 * t)}, seed=seed).write(tmp_path)
    found = check(rig)
    assert not any(f.experiment == "still" and f.problem == "clock" for f in found.findings)
    assert not found.blocks


@pytest.mark.parametrize(
    ("own", "mended"),
    [
        ([[21.0, 1.0, 3.5], [19.7, 1.5, 2.95]], [False, False, False]),  # a hidden resonance: no error falls by much
        ([[20.0, 1.0, 2.8], [20.0, 1.5, 3.0]], [False, False, True]),
        ([[15.0, 1.0, 4.0], [20.0, 9.0, 4.0]], [True, True, True]),  # one late sensor had spoilt the others
    ],
)
def test_lags_of_a_late_run_mend_an_equation(own: list[list[float]], mended: list[bool]) -> None:
    """Two equations, three experiments of a sample each."""
    common: Any = SimpleNamespace(residual=np.array([[20.0, 1.0, 3.0], [20.0, 1.5, 3.0]]))
    with_lags: Any = SimpleNamespace(residual=np.array(own))
    assert list(_mended(with_lags, common, np.arange(3), 3)) == mended


def test_what_ripples_with_the_angle_in_all_experiments_is_no_lag_of_one() -> None:
    """A map learnt from the others predicts the torque of a cogging motor, not that of a late run."""
    rng, run = np.random.default_rng(4), np.repeat([0, 1, 2, 3], 2000)
    angle = np.concatenate([rng.uniform(-9.0, 9.0, 6000), np.linspace(0.0, 6.0, 2000)])
    equation: Any = SimpleNamespace(moved=("a",))
    logs: Any = SimpleNamespace(run=run, moving={"a": np.stack([angle, np.ones_like(angle)])})
    noise, ripple = 0.3 * rng.standard_normal(8000), np.sin(7.0 * angle)
    everywhere, alone = (noise + ripple)[None], (noise + ripple * (run == 3))[None]
    assert _by_place(equation, logs, everywhere, 3, np.array([1.0])) > 0.5 * float(np.sum(np.log1p(ripple[6000:] ** 2)))
    assert _by_place(equation, logs, alone, 3, np.array([1.0])) < 20.0


def test_a_lag_that_spoils_an_equation_is_none() -> None:
    before, run = np.ones((2, 300)), np.repeat([0, 1, 2], 100)
    logs: Any = SimpleNamespace(run=run)
    after = before * np.where(run == 1, 0.5, 1.0)
    assert not _spoilt((logs, before), (logs, after), 1)
    after[1, run == 1] = 1.3
    assert _spoilt((logs, before), (logs, after), 1)
    assert not _spoilt((logs, before), (logs, after), 0)
