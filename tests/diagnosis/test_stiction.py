"""Static friction far above the kinetic one is no Stribeck effect."""

from types import SimpleNamespace
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.diagnosis.search.stiction import MOST, trouble_with_stiction
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter

NAME = "joint:stribeck"


def sticky(fitter: Fitter, ratio: float, coulomb: float) -> Fitted:
    """The bundled rig whose joint has so many times its `coulomb` friction at rest."""
    system = fitter.case.system.with_parameters({"joint_coulomb": coulomb})
    excess = {"joint_static_excess": (ratio - 1.0) * coulomb, "joint_stribeck_velocity": 0.05}
    return fitter.fit(system.with_effects({NAME: excess}), added=(NAME,), solve=False)


@pytest.mark.parametrize(("ratio", "is_told"), [(0.9 * MOST, True), (1.1 * MOST, False)])
def test_friction_at_rest_is_some_times_that_in_motion(fitter: Fitter, ratio: float, is_told: bool) -> None:
    trouble = trouble_with_stiction(fitter.case, sticky(fitter, ratio, 0.03), NAME)
    assert (trouble == "") is is_told
    assert is_told or f"{1.1 * MOST:.2g} times the kinetic one" in trouble


def test_other_effects_and_elements_have_none(fitter: Fitter, nominal: Any) -> None:
    sliding = sticky(fitter, 2.0 * MOST, 0.03)
    assert trouble_with_stiction(fitter.case, sliding, "joint:asymmetry") == ""
    assert trouble_with_stiction(fitter.case, nominal, "joint:coulomb") == ""


def test_a_joint_whose_friction_grows_with_load_may_have_little_of_its_own(fitter: Fitter) -> None:
    sliding = sticky(fitter, 2.0 * MOST, 0.03)
    system = sliding.system.with_effects({"joint:load_dependence": {"joint_load_dependence": 0.1}})
    loaded = fitter.fit(system, added=(NAME, "joint:load_dependence"), solve=False)
    assert trouble_with_stiction(fitter.case, loaded, NAME) == ""


def test_a_bushing_with_friction_of_its_own_may_have_little_coulomb_friction_beside_it() -> None:
    """Its branches are dry friction: the Stribeck excess is small beside them."""
    info = tl.system_info("cable_joint")
    values = {"bushing_1_coulomb": 0.1, "bushing_1_static_excess": 10.0, "bushing_1_stribeck_velocity": 0.01}
    there = ("bushing_1:bushing_branches", "bushing_1:coulomb", "bushing_1:stribeck")
    for effects, told in ((there, True), (there[1:], False)):
        fitted: Any = SimpleNamespace(system=SimpleNamespace(info=info, effects=effects, parameters=values))
        assert (trouble_with_stiction(None, fitted, "bushing_1:stribeck") == "") is told  # type: ignore[arg-type]
