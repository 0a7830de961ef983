"""The order in which a session of prescribed motions is recorded, and when."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

Plan = TypeVar("Plan")
Signals = TypeVar("Signals")
Draw = np.random.Generator


def recorded(
    draw: Draw, plans: Sequence[Plan], make: Callable[[Plan, Draw], Signals], *, seconds: float, has_repeats: bool
) -> list[tuple[dict[str, Any], Plan, Signals]]:
    """Ten runs of `seconds` in the order recorded: the name, start, split and repeat of an Experiment, its plan, and
    what `make` makes of the plan. The first plan is recorded at the start, in the middle and at the end, without
    repeats as other motions of the same kind; four more are to fit, the last three are held out.
    """
    order = [("train", plan) for plan in plans[1:5]] + [("test", plan) for plan in plans[5:]]
    order = [order[i] for i in draw.permutation(len(order))]
    runs: list[tuple[str, str | None, Plan, Signals]] = [(split, None, p, make(p, draw)) for split, p in order]
    first, fresh = make(plans[0], draw), draw.spawn(1)[0]
    again = [first] + [first if has_repeats else make(plans[0], fresh) for _ in range(2)]
    for place, signals in zip((0, 5, 9), again, strict=True):
        runs.insert(place, ("train", "A" if has_repeats else None, plans[0], signals))
    breaks = np.cumsum([0.0, *(seconds + draw.uniform(20, 90, len(runs) - 1))])
    return [
        ({"name": f"run-{i + 1:02d}", "start": float(np.round(start, 1)), "split": split, "repeat": repeat}, plan, made)
        for i, ((split, repeat, plan, made), start) in enumerate(zip(runs, breaks, strict=True))
    ]
