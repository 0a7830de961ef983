import numpy as np
import pytest

from tendonlab import _core


def test_a_cycle_dissipates_pi_c_omega_a_squared_and_stores_nothing() -> None:
    law = _core.transmission.Compliance(stiffness=300.0, damping=2.0)
    omega, reach = 5.0, 0.01
    t = np.linspace(0.0, 2 * np.pi / omega, 2001)[:-1]
    velocity = reach * omega * np.cos(omega * t)
    work = np.sum(law.force(position=reach * np.sin(omega * t), velocity=velocity) * velocity) * t[1]
    assert work == pytest.approx(3.14159265 * 2.0 * omega * reach**2, rel=1e-7)


def test_a_weight_hangs_by_its_stretch() -> None:
    assert _core.transmission.Compliance(stiffness=300.0, damping=2.0).force(position=0.1) == pytest.approx(30.0)
