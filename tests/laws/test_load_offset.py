import numpy as np
import pytest

from tendonlab import _core
from tendonlab.simulation.system import System


def rest(output: str, **parameters: float) -> float:
    """Where a rig comes to rest on its own, from 0."""
    kind = "two_inertia" if "gear_ratio" in parameters else "rigid_joint"
    viscous = ("motor:viscous", "joint:viscous") if kind == "two_inertia" else ("joint:viscous",)
    system = System(kind=kind, parameters=parameters, effects=(*viscous, "load:offset"))
    info = system.info
    experiment = _core.Experiment(
        kind=kind,
        time=np.linspace(0.0, 60.0, 61).tolist(),
        inputs=[_core.Signal(), _core.Signal()],
        loop=_core.Loop(),
        position=[0.0] * info.dof,
        velocity=[0.0] * info.dof,
    )
    run = _core.simulate(kind, system.values(), system.active(), experiment, [], _core.Settings(tolerance=1e-10))
    return float(run["outputs"][[s.name for s in info.outputs].index(output)][-1])


def test_a_pendulum_hangs_where_gravity_balances_it() -> None:
    """g sin q = F_0: at 30 degrees for half of the gravity torque, forwards for a positive one."""
    given = {"inertia": 1.0, "gravity_torque": 2.0, "torque_constant": 3.0, "viscous": 1.5, "load_offset": 1.0}
    answer = rest("joint_angle", **given)
    assert answer == pytest.approx(0.5235988, rel=1e-6)


def test_it_pulls_at_the_joint_and_not_at_the_motor() -> None:
    """With the gravity torque at the joint too, a cable at rest carries nothing: the motor follows by the ratio."""
    given = {
        "motor_inertia": 1e-3, "joint_inertia": 0.1, "gear_ratio": 10.0, "cable_stiffness": 50.0, "cable_damping": 0.5,
        "gravity_torque": 2.0, "motor_viscous": 1e-3, "joint_viscous": 0.1, "load_offset": -1.0,
    }  # fmt: skip
    assert rest("joint_angle", **given) == pytest.approx(-0.5235988, rel=1e-6)
    assert rest("cable_torque", **given) == pytest.approx(0.0, abs=1e-6)
    assert rest("motor_angle", **given) == pytest.approx(-5.235988, rel=1e-6)
