"""Arguments of the wrong type: the public functions name the argument and what they expected."""

from collections.abc import Callable
from typing import Any

import pytest

import tendonlab as tl
from tendonlab.cli.demo import bundled


@pytest.fixture(scope="module")
def rig() -> tl.Dataset:
    return tl.load(bundled())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda rig: tl.load(None), "path = None: expected the folder of a dataset"),
        (lambda rig: tl.identify("rig"), "dataset = 'rig': expected a Dataset"),
        (lambda rig: tl.identify(rig, effects=None), "effects = None: expected a list of names"),
        (lambda rig: tl.identify(rig, effects="joint:stribeck"), "effects = 'joint:stribeck': expected a list"),
        (lambda rig: tl.identify(rig, system=rig), "expected a System, such as"),
        (lambda rig: tl.identify(rig, tolerance="x"), "tolerance = 'x': expected a value in"),
        (lambda rig: tl.diagnose(rig, system=1), "system = 1: expected a System, such as"),
        (lambda rig: tl.diagnose(None), "dataset = None: expected a Dataset"),
        (lambda rig: tl.sweep(rig, {}, experiment=rig.experiments[0]), "expected a System, such as"),
    ],
)
def test_a_wrong_type_is_a_parameter_error(rig: tl.Dataset, call: Callable[[Any], object], message: str) -> None:
    with pytest.raises(tl.ParameterError, match=message):
        call(rig)
