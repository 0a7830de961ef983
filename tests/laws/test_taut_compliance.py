import numpy as np

from tendonlab import _core


def test_a_cable_pulls_and_never_pushes() -> None:
    law = _core.transmission.TautCompliance(pretension=200.0, stiffness=1e5, damping=1e3)
    elongation = np.array([-1e-2, -2e-3, -1e-3, 0.0, 1e-3])
    np.testing.assert_allclose(law.force(position=elongation), [0.0, 0.0, 100.0, 200.0, 300.0], atol=1e-9)
    assert law.force(velocity=-0.3) == 0.0  # released faster than its spring follows
