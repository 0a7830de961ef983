import pytest

from tendonlab import _core


def test_a_stalled_motor_and_a_free_one() -> None:
    """S2 Table I at 12 V: stalled it carries V/R, and at V/k it carries nothing."""
    motor = _core.actuation.Winding(torque_constant=0.1024, resistance=0.444, inductance=0.471e-3)
    stall = 12.0 / motor.resistance
    assert motor.rate(velocity=0.0, deflection=stall, level=0.0) == pytest.approx(-12.0 / motor.inductance, rel=1e-12)
    free = -12.0 / motor.torque_constant  # driven backwards it gives 12 V by itself
    assert motor.rate(velocity=free, deflection=0.0, level=0.0) == pytest.approx(12.0 / motor.inductance, rel=1e-12)
    assert motor.force(deflection=2.0, level=0.0) == pytest.approx(-0.2048, rel=1e-12)  # against the motion: it drives
