"""What a simulation records: only the outputs and the quantities of ports that are asked for."""

import numpy as np
import pytest

from examples import T, example
from integrate.rig import FRICTION, NOMINAL, pair
from tendonlab import _core
from tendonlab.errors import ParameterError
from tendonlab.simulation.catalog import PORT_QUANTITIES, system_info
from tendonlab.simulation.signals import smooth
from tendonlab.simulation.system import System

TORQUE = {"motor_torque": np.sin(9.0 * T)}


def run(system=None, inputs=TORQUE, **settings):
    system = system or pair(NOMINAL, **FRICTION)
    dof = system.info.dof
    given = [smooth(T, inputs[s.name]) if s.name in inputs else _core.Signal() for s in system.info.inputs]
    start = {"position": [0.0] * dof, "velocity": [0.0] * dof}
    experiment = _core.Experiment(kind=system.kind, time=T.tolist(), inputs=given, loop=_core.Loop(), **start)
    return _core.simulate(
        system.kind, system.values(), system.active(), experiment, [], _core.Settings(tolerance=1e-6, **settings)
    )


@pytest.mark.parametrize("wanted", [[0], [2], [0, 2], []])
def test_outputs_that_are_not_wanted_stay_zero(wanted):
    every, some = run()["outputs"], run(outputs=wanted)["outputs"]
    others = [c for c in range(len(every)) if c not in wanted]
    assert np.array_equal(some[wanted], every[wanted])
    assert not some[others].any()


@pytest.mark.parametrize("wanted", [["force"], ["velocity", "load"], ["force", "position"]])
def test_ports_show_the_wanted_quantities_in_their_usual_order(wanted):
    every, some = run(ports=PORT_QUANTITIES)["ports"], run(ports=wanted)["ports"]
    rows = [k for k, name in enumerate(PORT_QUANTITIES) if name in wanted]
    assert every.shape[1] == len(PORT_QUANTITIES)
    assert np.array_equal(some, every[:, rows])


def test_a_sampled_system_leaves_unwanted_outputs_zero_too():
    of = example("ccsrm_tensions")
    system = System(
        kind="ccsrm_tensions",
        parameters=of.parameters,
        effects=system_info("ccsrm_tensions").default_nominal_effects,
    )
    every, some = (run(system, of.inputs, **wanted)["outputs"] for wanted in ({}, {"outputs": [1]}))
    assert np.array_equal(some[1], every[1])
    assert not np.delete(some, 1, axis=0).any()


def test_without_wanted_quantities_there_are_no_ports():
    assert "ports" not in run()


def test_an_unknown_quantity_is_refused():
    with pytest.raises(ParameterError, match='ports: "power": expected velocity, position, load or force'):
        run(ports=["power"])


def test_an_index_beyond_all_outputs_is_refused():
    with pytest.raises(ParameterError, match="outputs: 3: two_inertia has 3 outputs"):
        run(outputs=[3])
