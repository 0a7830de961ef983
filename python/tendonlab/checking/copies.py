"""Columns and files that hold the same samples twice."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.data import Dataset

LEAST = 20  # samples that must agree to the last digit


def copy_findings(dataset: Dataset) -> list[Finding]:
    """Experiments with the same outputs, and outputs that equal another column."""
    return [*_same_experiments(dataset), *_same_columns(dataset)]


def _same_experiments(dataset: Dataset) -> Iterator[Finding]:
    names = [name for name, spec in dataset.signals.items() if spec.role == "output"]
    records = [{n: e.data[n].to_numpy(dtype=float) for n in names} for e in dataset.experiments]
    for (i, one), (j, two) in combinations(enumerate(records), 2):
        if all(_alike(one[n], two[n]) for n in names) and any(_tells(one[n], two[n]) for n in names):
            first, second = dataset.experiments[i].name, dataset.experiments[j].name
            text = f"{second} holds the same samples as {first}; leave one of them out"
            yield Finding(problem="copy", experiment=second, detail=text, blocks=True)


def _same_columns(dataset: Dataset) -> Iterator[Finding]:
    names = [name for name, spec in dataset.signals.items() if spec.role in ("input", "output")]
    for one, two in combinations(names, 2):
        if "output" not in (dataset.signals[one].role, dataset.signals[two].role):
            continue
        columns = [(e.data[one].to_numpy(dtype=float), e.data[two].to_numpy(dtype=float)) for e in dataset.experiments]
        if all(_alike(a, b) for a, b in columns) and any(_tells(a, b) for a, b in columns):
            text = f"{two} and {one} hold the same samples in every experiment; check their columns"
            yield Finding(problem="copy", signal=two, alternatives=(one,), detail=text, blocks=True)


def _alike(one: np.ndarray, two: np.ndarray) -> bool:
    num = min(len(one), len(two))
    return bool(one[0] == two[0] and np.array_equal(one[:num], two[:num], equal_nan=True)) or (
        bool(np.isnan(one[0])) and np.array_equal(one[:num], two[:num], equal_nan=True)
    )


def _tells(one: np.ndarray, two: np.ndarray) -> bool:
    """Whether there is something to agree on: enough samples that change."""
    kept = one[: min(len(one), len(two))]
    kept = kept[np.isfinite(kept)]
    return len(np.unique(kept)) >= LEAST
