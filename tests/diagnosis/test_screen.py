"""The screen of candidates: most promising first, started at a shape of its grid."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import tendonlab as tl
from tendonlab import _core
from tendonlab.blind.rig import draw_rig
from tendonlab.blind.strength import Strength
from tendonlab.blind.systems import SYSTEMS
from tendonlab.blind.write import record, write_dataset
from tendonlab.diagnosis.search import screen
from tendonlab.diagnosis.search.workshop import Workshop
from tendonlab.fitting.case import make_case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import white
from tendonlab.fitting.priors import start_of
from tendonlab.fitting.problem import Fitter
from tendonlab.papers import s2
from tendonlab.simulation.catalog import MEMORY, REFINES


def test_candidates_come_most_promising_first(fitter: Fitter, nominal: Fitted) -> None:
    library = ("joint:asymmetry", "joint:stribeck", "actuation:offset")
    with ThreadPoolExecutor(1) as pool:
        workshop = Workshop(pool, _core.Cancel(), progress=False, library=library)
        gains = [one.gain for one in workshop.screen_all(fitter, nominal, "")]
    assert gains == sorted(gains, reverse=True)
    assert gains[0] > gains[-1]


def test_fits_start_at_a_multiple_of_the_typical_shape(
    fitter: Fitter, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(screen, "SHAPES", (3.0,))
    (start,) = screen.screen(fitter, nominal, "joint:stribeck").starts
    typical = start_of(nominal.system, "joint:stribeck", fitter.case.scales)
    assert start["joint_stribeck_velocity"] == pytest.approx(3.0 * typical["joint_stribeck_velocity"])


@pytest.mark.parametrize("best", [0, 1, 3])
def test_a_delay_starts_where_a_simulation_gains_most(
    best: int, fitter: Fitter, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its promise stays that of the slopes: a delay that no start gains from is not dropped unseen."""
    promised = screen.screen(fitter, nominal, "actuation:delay").gain
    asked: list[dict[str, float]] = []

    def simulated(_: Fitter, __: Fitted, ___: str, tried: list[dict[str, float]]) -> list[float]:
        asked.extend(tried)
        return [1.0 if place == best else -np.inf for place in range(len(tried))]

    monkeypatch.setattr(screen, "expected_gains", simulated)
    found = screen.screen(fitter, nominal, "actuation:delay")
    assert len(asked) == len(screen.DELAYS)
    assert found.starts == (asked[best],)
    assert found.gain == promised


@pytest.mark.cpu(20)  # a rig is drawn here
def test_a_long_delay_starts_near_where_it_is(tmp_path: Path) -> None:
    """Where a sheath's friction jumps, the slope at no delay tells nothing of 60 ms."""
    rig = draw_rig(
        np.random.default_rng(3), effect="", kind="parameters_only", system=SYSTEMS["bowden_pair"], excitation="rich"
    )
    still = Strength(
        amplitude=0.0, gap_noise=0.0, nominal_gap_noise=0.0, floor=np.zeros(1), limited=False, met=True, separation={}
    )
    write_dataset(rig, record([rig], [still])[0], tmp_path / "rig", name="rig", description="")
    dataset = tl.load(tmp_path / "rig")
    late = [_later(experiment, "output_torque", 0.06) for experiment in dataset.experiments]
    case = make_case(replace(dataset, experiments=tuple(late)))
    fitter = Fitter(case, white([20.0 * sd for sd in case.noise]), _core.Cancel())
    (start,) = screen.screen(fitter, fitter.fit(case.system), "sensor.output_torque:delay").starts
    assert start["sensor.output_torque_delay"] == pytest.approx(0.06, rel=0.3)


def _later(experiment: tl.Experiment, name: str, delay: float) -> tl.Experiment:
    time, signal = experiment.data.index.to_numpy(), experiment.data[name].to_numpy()
    return replace(experiment, data=experiment.data.assign(**{name: np.interp(time - delay, time, signal)}))


def test_a_whole_friction_is_always_refitted_from_several_first_shapes() -> None:
    """No gain is expected of it, so it counts as much as any model can gain."""
    info = tl.system_info("friction_map")
    effect = "contact:static_lugre"
    rows = [info.parameter(name) for name in info.effect(effect).parameters]
    amplitudes = [p.name for p in rows if p.amplitude]
    first = next(p.name for p in rows if p.purpose == "shape")
    effects = ("contact:load_and_ratio",)
    system = tl.System(
        kind="friction_map", parameters=dict.fromkeys(info.effect(effects[0]).parameters, 0.5), effects=effects
    )
    scale = SimpleNamespace(of=lambda dimension: 2.0)
    case: Any = SimpleNamespace(scales={"contact": scale})
    base: Any = SimpleNamespace(system=system, cost=123.0)
    found = screen._whole(case, base, effect, rows)
    assert (found.effect, found.gain, found.visibility, found.simulated) == (effect, 123.0, 123.0, True)
    typical = start_of(system, effect, case.scales)
    assert [start[first] / typical[first] for start in found.starts] == pytest.approx([0.3, 1.0, 3.0])
    for start in found.starts:
        for name in amplitudes:
            assert start[name] == pytest.approx(2.0 * info.parameter(name).typical)


def test_a_candidate_that_no_simulation_bears_starts_at_half_its_typical_size(
    fitter: Fitter, nominal: Fitted, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(screen, "_residuals_with", lambda fitter, base, effect, tried: ["no" for _ in tried])
    found = screen.screen(fitter, nominal, "actuation:offset")
    assert (found.gain, found.visibility, found.simulated) == (0.0, 0.0, False)
    p = nominal.system.info.parameter("actuation_offset")
    assert found.starts == ({"actuation_offset": pytest.approx(0.5 * screen._unit(fitter.case, p))},)


def test_no_effect_of_a_motor_is_a_candidate_where_the_nuts_move_as_prescribed(tmp_path: Path) -> None:
    """The motor of S2 idles there; gear and guides move."""
    case = make_case(s2.write_dataset(tmp_path, s2.constants()), tolerance=1e-5)
    assert case.idle == {"motor", "winding"}
    base: Any = SimpleNamespace(system=case.system, added=())
    elements = {name.partition(":")[0] for name in screen.candidates(case, base)}
    assert "motor" not in elements
    assert {"joint", "gear", "cable", "bushing_1"} <= elements


def test_nothing_idles_where_a_motor_drives(twin_case: Any) -> None:
    assert twin_case.idle == frozenset()


def test_stribeck_friction_joins_any_dry_friction_but_bristles_need_a_level() -> None:
    """The branches of a bushing are dry friction; no bristle could carry them."""
    info = tl.system_info("cable_joint")
    branches: Any = SimpleNamespace(info=info, effects=("bushing_1:bushing_branches",))
    bare: Any = SimpleNamespace(info=info, effects=("joint:viscous",))
    stribeck = info.effect("bushing_1:stribeck")
    assert screen.can_be_added(stribeck, branches)
    assert not screen.can_be_added(stribeck, bare)
    bristle: Any = SimpleNamespace(name="bushing_1:bristle", element="bushing_1", needs=(), roles=MEMORY | REFINES)
    assert not screen.can_be_added(bristle, branches)
    level: Any = SimpleNamespace(info=info, effects=("bushing_1:coulomb",))
    assert screen.can_be_added(bristle, level)
