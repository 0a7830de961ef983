"""A diagnosis is a value: its copies equal it, and it differs from another by any of its fields."""

import copy
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from tendonlab.report.diagnosis import Diagnosis


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_a_copy_equals_it_and_reports_the_same(diagnosis: Diagnosis, copied: Any) -> None:
    other = copied(diagnosis)
    assert other is not diagnosis
    assert other == diagnosis
    assert other.to_dict() == diagnosis.to_dict()


def test_any_field_makes_it_differ(with_effect: Diagnosis) -> None:
    (overlay,), table = with_effect.overlays, with_effect.table
    assert table is not None
    moved = {name: values + 1e-12 for name, values in overlay.refitted.items()}
    first = replace(with_effect.effects[0], held_out_gain={"mean": 812.0, "se": 91.0})
    for changes in (
        {"seconds": with_effect.seconds + 1.0},
        {"overlays": (replace(overlay, refitted=moved),)},
        {"overlays": ()},
        {"where_map": with_effect.where_map[:-1]},
        {"effects": (first, *with_effect.effects[1:])},
        {"table": replace(table, frame=table.frame.iloc[::-1])},
        {"held_out": with_effect.held_out.iloc[::-1]},
    ):
        assert replace(with_effect, **changes) != with_effect, changes
    assert with_effect != "something else"


def test_missing_numbers_equal_each_other(with_effect: Diagnosis) -> None:
    """After pickling, NaN is another object than before."""
    unknown = replace(with_effect, explained=float("nan"), details={"gap": [float("nan"), np.array([np.nan, 1.0])]})
    assert pickle.loads(pickle.dumps(unknown)) == unknown
    assert replace(unknown, details={"gap": [float("nan"), np.array([np.nan, 2.0])]}) != unknown
    assert replace(unknown, held_out=pd.DataFrame()) != unknown
