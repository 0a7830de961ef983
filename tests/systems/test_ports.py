"""What every port of every system shows: its velocity is the rate of its position."""

import numpy as np
import pytest

from examples import T, example
from integrate.rig import run
from tendonlab.papers import s2
from tendonlab.simulation.catalog import kinds, system_info
from tendonlab.simulation.system import System

OTHERWISE = {("cable_joint", "gear"): 80.0}  # the gear turns 80 times as slowly as the motor, whose speed it brakes
MOVING = {
    "rigid_joint": 1, "servo_pendulum": 1, "two_inertia": 4, "friction_map": 0, "tendon_routing": 10, "cable_joint": 10,
    "bowden_pair": 2, "ccsrm": 2, "ccsrm_tensions": 1,
}  # fmt: skip


@pytest.mark.parametrize("kind", kinds())
def test_the_velocity_of_a_port_is_the_rate_of_its_position(kind: str) -> None:
    """Where a port has a position; differences over two samples of 5 ms err by a few per cent of the largest speed."""
    of, info = example(kind), system_info(kind)
    system = System(kind=kind, parameters=of.parameters, effects=(*info.default_nominal_effects, *of.effects))
    found = run(system, T, of.inputs, kind=of.between, ports=True, tolerance=1e-8)
    moving = 0
    for name, (velocity, position, _, _) in found.ports.items():
        if not np.any(position):
            continue
        rate = OTHERWISE.get((kind, name), 1.0) * np.gradient(position, T)
        error = np.abs(rate - velocity)[1:-1]
        assert np.median(error) < 0.025 * np.abs(velocity).max(), name
        moving += 1
    assert moving == MOVING[kind]


def test_guides_stand_where_the_joint_pulls_their_cables() -> None:
    """Forwards and backwards by the sine of the joint's angle over its arm."""
    of = example("cable_joint")
    info = system_info("cable_joint")
    system = System(kind="cable_joint", parameters=of.parameters, effects=info.default_nominal_effects)
    found = run(system, T, of.inputs, ports=True, position=[0.5])
    reach = s2.parameters(s2.constants())["anchor_distance"] * np.sin(found["joint_angle"])
    assert np.abs(reach).max() > 0.01
    for name, way in (("bushing_1", 1.0), ("bushing_2", -1.0), ("stiction_1", 1.0), ("stiction_2", -1.0)):
        assert found.ports[name][1] == pytest.approx(way * reach, abs=1e-9)
