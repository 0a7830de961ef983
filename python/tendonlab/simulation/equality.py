"""Equality of records that hold frames and arrays, on which `==` works element by element."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np


class EqualByFields:
    """Equal to an instance of the same class with equal fields. For dataclasses with `eq=False`.

    Missing samples (NaN) equal each other. Fields with `compare=False` are left out."""

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        compared = (f.name for f in fields(self) if f.compare)  # type: ignore[arg-type]
        return all(_same(getattr(self, name), getattr(other, name)) for name in compared)

    __hash__ = None  # type: ignore[assignment]  # frames and arrays can be changed


def _same(left: Any, right: Any) -> bool:
    if hasattr(left, "equals"):  # a frame or a series
        return type(left) is type(right) and bool(left.equals(right))
    if isinstance(left, np.ndarray) or isinstance(right, np.ndarray):
        return type(left) is type(right) and np.array_equal(left, right, equal_nan=left.dtype.kind == "f")
    if isinstance(left, Mapping) and isinstance(right, Mapping):
        return left.keys() == right.keys() and all(_same(left[name], right[name]) for name in left)
    if isinstance(left, tuple | list) and isinstance(right, tuple | list):
        return type(left) is type(right) and len(left) == len(right) and all(map(_same, left, right))
    return bool(left == right or (left != left and right != right))
