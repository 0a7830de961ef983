"""The runs of the twins from which something is withheld: motions, loads, splits and seeds, without a simulation."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tendonlab.papers.s0 import bench, twin
from tendonlab.papers.s0.bearings import relative_load
from tendonlab.papers.s1 import twin as arm
from tendonlab.papers.s1.twin import believed, record, sessions
from tendonlab.papers.s3 import diagnosis
from tendonlab.papers.tables import table


def test_the_arm_moves_twice_at_each_load_to_fit_and_once_to_judge() -> None:
    found = sessions([2.0, 0.5, 1.0])
    assert [s.name for s in found if s.level == 1.0] == [
        "gravity-x1-a-1", "gravity-x1-a-2", "gravity-x1-a-3", "gravity-x1-b", "gravity-x1-c",
    ]  # fmt: skip
    assert [s.name for s in found if s.repeat] == ["gravity-x1-a-1", "gravity-x1-a-2", "gravity-x1-a-3"]
    assert [s.split for s in found if s.level == 0.5] == ["train", "train", "test"]
    assert len(found) == 3 + 5 + 3


def test_a_session_logs_sines_their_speeds_at_the_motors_and_gravity_times_its_level() -> None:
    device = arm.example_device()
    of = sessions([1.0])[0]
    log = record(device, of, np.random.default_rng(0))
    again = record(device, arm.Session(**{**vars(of), "level": 2.0}), np.random.default_rng(0))
    load = log[[f"external_torque_{i}" for i in range(1, 5)]].to_numpy()
    assert again[[f"external_torque_{i}" for i in range(1, 5)]].to_numpy() == pytest.approx(2.0 * load)
    motor = log[[f"motor_velocity_{i}" for i in range(1, 5)]].to_numpy()
    joint = motor * device.motor_radius @ np.linalg.inv(device.radius.T)
    time = log.index.to_numpy()[:, None]
    amplitude, turn = np.array([0.5, 0.35, 0.4, 0.5]), 2 * np.pi * np.array(of.frequency)
    assert joint == pytest.approx(amplitude * turn * np.cos(turn * time + of.phase), abs=1e-9)
    angle = amplitude * np.sin(turn * time + of.phase)
    turned = [np.sin(angle[:, 0]), np.cos(angle[:, 1]), np.sin(angle[:, 2]), np.cos(angle[:, 3])]
    assert load == pytest.approx(np.array(turned).T * arm.GRAVITY)


def test_what_is_withheld_of_the_arm_is_what_its_simulator_lacks() -> None:
    own = arm.example_device().parameters()
    reducer, radius = believed("reducer"), believed("radius")
    assert {name for name, p in reducer.items() if p.value != own[name]} <= {
        name for name in own if name.startswith("reducer_efficiency")
    }
    assert all(p.value == 1.0 for name, p in reducer.items() if name.startswith("reducer_efficiency"))
    changed = {name: p.value / own[name] for name, p in radius.items() if p.value != own[name]}
    assert changed == pytest.approx(dict.fromkeys(arm.DRIVEN_RADII[1:3], 1.02))
    for name in arm.DRIVEN_RADII:
        assert radius[name].sd == pytest.approx(0.02 * own[name])
        assert reducer[name].sd == 0.0
    for name, p in reducer.items():
        uncertain = name.startswith(("constant_loss", "viscous_loss"))
        assert p.sd == pytest.approx(0.3 * own[name] if uncertain else 0.0)
    tension = believed("tension")
    assert all(p.value == 0.0 for name, p in tension.items() if name.startswith("tension_loss"))


@pytest.mark.parametrize(
    ("case", "effect", "fitted", "judged", "given"),
    [
        ("slack", "sheath:slack", 10, 2, {"slack": True, "pretension_scale": 1.0}),
        ("pretension_loss", "sheath:pretension_loss", 8, 2, {"slack": False, "pretension_scale": 0.8}),
        ("presliding", "sheath:distributed_presliding", 12, 4, {"slack": False, "pretension_scale": 1.0}),
    ],
)
def test_cases_of_s3_repeat_what_is_fitted_with_other_noise(
    case: str, effect: str, fitted: int, judged: int, given: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(number: int, reading: float, trajectory: Any, **options: Any) -> Any:
        return SimpleNamespace(run=(number, reading, trajectory.kind, trajectory.amplitude), options=options)

    monkeypatch.setattr(diagnosis, "run_chain", run)
    found = diagnosis.withheld(case, seed=7)
    records: list[Any] = list(found.records)
    assert (found.effect, len(records), len(found.held_out)) == (effect, fitted, judged)
    assert found.friction_known == (case == "pretension_loss")
    half = fitted // 2
    assert [r.run for r in records[:half]] == [r.run for r in records[half:]]
    assert [r.options["seed"] for r in records] == list(range(7, 7 + fitted))
    later: list[Any] = list(found.held_out)
    assert [r.options["seed"] for r in later] == list(range(107, 107 + judged))
    for r in records + later:
        assert {name: r.options[name] for name in given} == given
        assert (r.options["sample_rate"], r.options["duration"]) == (100.0, 12.0)


def test_the_second_twin_of_s0_is_equation_11_at_its_limits() -> None:
    """Odd in speed; near rest the static friction alone, as the level fades as w^delta; at 1 rad/s all powers of the
    speed are one."""
    of = bench.loaded("C35P75GX", bench.LOADS[-1])
    rows = table("S0_reconstructed_parameters")
    own = rows[(rows["transmission"] == of.transmission) & (rows["set"] == "table8_set")].set_index("symbol")["value"]
    speeds = np.array([0.3, 1.0, 20.0])
    assert twin.proposed_friction(of, -speeds) == pytest.approx(-twin.proposed_friction(of, speeds))
    load, n = relative_load(of), of.ratio()
    level = own["F_c"] * (1.0 + load)
    peak = (own["F_s"] + level) * np.exp(-((1.0 / own["theta_s"]) ** own["alpha"]))
    viscous = own["F_v"] * (1.0 + 1.0 / n**2 + load ** -own["gamma"])
    assert float(twin.proposed_friction(of, 1.0)) == pytest.approx(level + peak + viscous)
    tiny = float(twin.proposed_friction(of, 1e-12))
    assert tiny == pytest.approx(own["F_s"] + level * 1e-12 ** own["delta"], rel=0.05)
