"""What makes a sweep this sweep: a store keeps it and takes no chunk of another one."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from functools import partial
from types import CodeType
from typing import Any

import numpy as np

from tendonlab.simulation.records import Experiment
from tendonlab.sweeping.layout import Layout
from tendonlab.version import version


def fingerprint(layout: Layout, tolerance: float) -> dict[str, str]:
    """A digest of each part of a sweep, by the name that a message gives it."""
    keep, reduction = layout.keep, layout.keep.reduction
    function = "" if reduction is None or reduction.function is None else function_text(reduction.function)
    kept = (None if reduction is None else reduction.name, function, keep.dtype, layout.outputs, layout.several)
    return {
        "package version": version(),
        "system": digest([repr((layout.system.to_dict(), layout.system.controller))]),
        "points": digest([repr((layout.points.names, dict(layout.points.sizes))), layout.points.values]),
        "experiment": digest(part for experiment in layout.experiments for part in parts_of(experiment)),
        "settings": digest([repr((kept, float(tolerance)))]),
    }


def parts_of(experiment: Experiment) -> Iterable[Any]:
    data = experiment.data
    stated = (experiment.conditions, experiment.add, experiment.initial, experiment.holds)
    yield repr((experiment.name, [sorted(given.items()) for given in stated], list(map(str, data.columns))))
    yield data.index.to_numpy()
    for k in range(data.shape[1]):
        column = data.iloc[:, k]
        yield column.to_numpy() if column.dtype.kind in "biuf" else repr(column.tolist())


def function_text(given: Any) -> str:
    """The text of a function as far as Python knows it: its name, code and constants, its defaults, what its closure
    holds, and the arguments that `functools.partial` adds."""
    if isinstance(given, partial):
        return repr((function_text(given.func), list(map(_value, given.args)), _named(given.keywords)))
    code = getattr(given, "__code__", None)
    name = getattr(given, "__qualname__", type(given).__qualname__)
    held = [_value(cell.cell_contents) for cell in getattr(given, "__closure__", None) or ()]
    defaults = [_value(value) for value in getattr(given, "__defaults__", None) or ()]
    named = _named(getattr(given, "__kwdefaults__", None) or {})
    return repr((name, _code(code) if isinstance(code, CodeType) else None, defaults, named, held))


def _named(values: Mapping[str, Any]) -> list[tuple[str, str]]:
    return [(name, _value(values[name])) for name in sorted(values)]


def _value(given: Any) -> str:
    """What a function holds: another function by its text, an array by its bytes, anything else as it prints."""
    if isinstance(given, np.ndarray):
        return digest([repr((given.dtype.str, given.shape)), given])
    return function_text(given) if callable(given) else repr(given)


def _code(code: CodeType) -> tuple[Any, ...]:
    return code.co_code.hex(), code.co_names, [_constant(c) for c in code.co_consts]


def _constant(given: Any) -> Any:
    if isinstance(given, CodeType):
        return _code(given)
    return repr(sorted(map(repr, given)) if isinstance(given, frozenset) else given)  # sets have no order


def digest(parts: Iterable[Any]) -> str:
    total = hashlib.sha256()
    for part in parts:
        total.update(np.ascontiguousarray(part).tobytes() if isinstance(part, np.ndarray) else str(part).encode())
    return total.hexdigest()
