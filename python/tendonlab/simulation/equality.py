"""Equality of records that hold frames, on which `==` works element by element."""

from __future__ import annotations

from dataclasses import fields
from typing import Any


def same_fields(left: Any, right: Any) -> bool:
    """Are all fields of two instances of the same dataclass equal? Missing samples (NaN) equal each other."""
    return all(_same(getattr(left, f.name), getattr(right, f.name)) for f in fields(left))


def _same(left: Any, right: Any) -> bool:
    if hasattr(left, "equals"):  # a frame or a series
        return type(left) is type(right) and bool(left.equals(right))
    if isinstance(left, tuple) and isinstance(right, tuple):
        return len(left) == len(right) and all(map(_same, left, right))
    return bool(left == right)
