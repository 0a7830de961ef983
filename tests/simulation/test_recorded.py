"""What a simulation records: only the outputs and the quantities of ports that are asked for."""

import numpy as np
import pytest

from integrate.rig import FRICTION, NOMINAL, pair
from tendonlab import _core
from tendonlab.errors import ParameterError
from tendonlab.simulation.catalog import PORT_QUANTITIES
from tendonlab.simulation.signals import smooth

T = np.linspace(0.0, 1.0, 203)


def run(**settings):
    system = pair(NOMINAL, **FRICTION)
    torque = smooth(T, np.sin(9.0 * T))
    experiment = _core.Experiment(
        kind=system.kind,
        time=T.tolist(),
        inputs=[torque, _core.Signal()],
        loop=_core.Loop(),
        position=[0.1, 0.1],
        velocity=[0.0, 0.0],
    )
    given = (system.kind, system.values(), system.active(), experiment, [])
    return _core.simulate(*given, _core.Settings(tolerance=1e-6, **settings))


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


def test_without_wanted_quantities_there_are_no_ports():
    assert "ports" not in run()


def test_an_unknown_quantity_is_refused():
    with pytest.raises(ParameterError, match='ports: "power": expected velocity, position, load or force'):
        run(ports=["power"])


def test_an_index_beyond_all_outputs_is_refused():
    with pytest.raises(ParameterError, match="outputs: 3: two_inertia has 3 outputs"):
        run(outputs=[3])
