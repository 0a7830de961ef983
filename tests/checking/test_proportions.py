"""One output of several alike in another unit, on rigs whose simulation needs no output."""

from pathlib import Path

import numpy as np
import pytest

import tendonlab as tl
from tendonlab.blind.faults import Fault
from tendonlab.blind.rig import draw_rig
from tendonlab.blind.strength import Strength
from tendonlab.blind.systems import SYSTEMS
from tendonlab.blind.write import record, write_dataset
from tendonlab.checking.free import free_case
from tendonlab.checking.proportions import _odd, _Seen, odd_proportions

STRONG = Strength(
    amplitude=3.0, gap_noise=0.0, nominal_gap_noise=0.0, floor=np.zeros(1), limited=False, met=True, separation={}
)
FORCE = 60.0 + 15.0 * np.sin(np.linspace(0.0, 40.0, 4000))


@pytest.mark.cpu(20)  # the rigs are drawn here
@pytest.mark.parametrize("factor", [1.0, 2.0, 1 / 9.81])
def test_a_cable_force_in_another_unit_is_found_beside_friction_that_the_simulator_lacks(
    factor: float, tmp_path: Path
) -> None:
    random, system = np.random.default_rng(5), SYSTEMS["cable_joint"]
    rig = draw_rig(random, effect="joint:coulomb", kind="effect", system=system, excitation="rich")
    run = record([rig], [STRONG])[0]
    fault = Fault(problem="scale", signals=("cable_force_2",), factor=factor) if factor != 1.0 else None
    write_dataset(rig, run, tmp_path / "rig", name="rig", description="", fault=fault)
    logs = tl.load(tmp_path / "rig")
    found = [(f.problem, f.signal, f.factor) for f in odd_proportions(free_case(logs, logs.system()))]
    assert found == ([("scale", "cable_force_2", pytest.approx(factor))] if fault else [])


def odd(*ratios: float, offset: float = 0.0) -> list[tuple[str | None, float | None]]:
    """Outputs that read these multiples of one simulated force, the first one beside an offset."""
    noise = np.random.default_rng(0).standard_normal((len(ratios), len(FORCE)))
    logged = [ratio * FORCE + offset * (k == 0) + noise[k] for k, ratio in enumerate(ratios)]
    found = _odd([_Seen(f"tension_{k}", FORCE, row) for k, row in enumerate(logged)])
    return [(f.signal, f.factor) for f in found]


def test_one_output_alone_is_told_by_a_ratio_of_units() -> None:
    assert odd(1.0, 0.95, 1.05) == []
    assert odd(2.0, 0.95, 1.05) == [("tension_0", 2.0)]
    assert odd(1.05, 0.52) == [("tension_1", 0.5)]
    assert odd(1.1, 1.05, 1000.0, 1.0) == [("tension_2", 1000.0)]


def test_what_parameters_or_an_offset_explain_is_no_unit() -> None:
    assert odd(1.6, 1.0, 1.0) == []  # near no ratio of units
    assert odd(2.0, 1.0, 2.0) == []  # nobody knows which are right
    assert odd(4.0, 2.0, 2.0) == []  # the others are not as predicted
    assert odd(1.0, 1.0, 1.0, offset=60.0) == []  # twice on average, but with the swing of the simulator
    assert odd(2.0) == []


def test_a_rig_whose_motor_is_commanded_is_left_alone(tmp_path: Path) -> None:
    system = SYSTEMS["rigid_joint"]
    rig = draw_rig(np.random.default_rng(5), effect="", kind="parameters_only", system=system, excitation="rich")
    write_dataset(rig, record([rig], [STRONG])[0], tmp_path / "rig", name="rig", description="")
    logs = tl.load(tmp_path / "rig")
    assert odd_proportions(free_case(logs, logs.system())) == []
