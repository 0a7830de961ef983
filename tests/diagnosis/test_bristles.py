"""Bristles that bend too little for any sensor are no answer."""

from typing import Any

import pytest

from tendonlab.diagnosis.search.bristles import VISIBLE, trouble_with_bristles
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

NAME = "joint:presliding"


def bristled(fitter: Fitter, noises: float) -> Fitted:
    """The bundled rig with bristles at its joint that bend by so many times the noise of the best sensor: the motor's,
    whose gear makes it finer."""
    case = fitter.case
    level = case.system.parameters["joint_coulomb"]
    noise = case.noise[case.outputs.index("motor_angle")] / case.system.parameters["gear_ratio"]
    system = case.system.with_effects(
        {NAME: {"joint_bristle_stiffness": level / (noises * noise), "joint_bristle_damping": 0.1}}
    )
    return fitter.fit(system, added=(NAME,), solve=False)


@pytest.mark.parametrize(("noises", "is_seen"), [(0.2 * VISIBLE, False), (5.0 * VISIBLE, True)])
def test_bristles_count_where_a_sensor_sees_them_bend(fitter: Fitter, noises: float, is_seen: bool) -> None:
    trouble = trouble_with_bristles(fitter.case, bristled(fitter, noises), NAME)
    assert (trouble == "") is is_seen


def test_other_effects_have_none(fitter: Fitter, nominal: Any) -> None:
    assert trouble_with_bristles(fitter.case, nominal, "joint:stribeck") == ""
