"""What is written of a blind case is read as what it was, types and all."""

import tomllib

import numpy as np
import pytest

from tendonlab.blind.write import _table, _toml


@pytest.mark.parametrize(
    "value",
    [True, False, 0, 3, -7, 3.0, -0.0, 0.25, 1e20, 1e-9, -120000.0, np.inf, 'a "b" \\ é', [1, 2.0, "x"], []],
    ids=repr,
)
def test_values_keep_their_type(value: object) -> None:
    found = tomllib.loads(f"x = {_toml(value)}")["x"]
    assert found == value
    assert type(found) is type(value)
    if isinstance(value, list):
        assert [type(item) for item in found] == [type(item) for item in value]


def test_a_float_keeps_seven_digits() -> None:
    assert tomllib.loads(f"x = {_toml(np.pi)}")["x"] == pytest.approx(np.pi, rel=2e-7)
    assert _toml(np.pi) == "3.141593"


def test_names_that_are_no_plain_words_are_quoted() -> None:
    values = {"joint_coulomb": 0.5, "sensor.joint_angle_bias": 1.0, "joint:stribeck": 2.0, "run-1": 3.0}
    assert tomllib.loads("\n".join(_table(values))) == values
    assert _table({"joint_coulomb": 0.5}) == ["joint_coulomb = 0.5"]
