"""Give drawn cases the next experiment: the motion that a report advises, or a random one of the same length."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import pandas as pd

from .description import Array, Experiment
from .drawing import Settled, description, make_folders, name_of, settle
from .excitation import ARM, GRAVITY, RICH, motion
from .planning import plan
from .rig import Rig
from .runner import REPORT
from .write import add_experiment, record, sealed_toml, write_dataset

DECIDES = 10.0  # nats that an advised motion must promise
Choice = Literal["advised", "random"]


class Advice(NamedTuple):
    """The motion that a report puts first: its reference, s and SI, the column it is for, what the run adds to
    parameters.
    """

    time: Array
    path: Array
    column: str
    add: dict[str, float]


def follow(
    seed: int,
    count: int,
    reports: Path | str,
    out: Path | str,
    *,
    sealed: Path | str,
    origin: Mapping[str, object] | None = None,
    choice: Choice = "advised",
    step: float | None = None,
    num_samples: int | None = None,
    **drawn: Any,
) -> Path:
    """Draw the cases of a series again whose report ends in a tie that a motion decides, each with one more training
    experiment, into `out`/cases; return `out`.

    `seed`, `count`, `origin` and `drawn`: as `draw` had them. `reports`: what `run` wrote. `choice`: "advised" follows
    the motion that the report puts first, "random" one of the generator's motions, as long as the advised one and
    without load. The truths go into the new folder `sealed`. Raises ValueError where no report has such a tie,
    FileExistsError if a folder exists.
    """
    advised = _advised(Path(reports))
    batch = [(i, w) for i, w in enumerate(plan(seed, count, **drawn)) if name_of(i) in advised and not w.has_fault]
    if not batch:
        raise ValueError(f"{reports}: expected a report with a tie that a motion decides, found none")
    cases, sealed = Path(out) / "cases", Path(sealed)
    make_folders(cases, sealed)
    settled = settle(batch, seed=seed, num_samples=num_samples)
    runs = record([case.rig for case in settled], [case.strengths[0] for case in settled], step=step)
    for case, run in zip(settled, runs, strict=True):
        folder, name, words = cases / case.name, case.name, description(case.rig)
        followed = _followed(case, advised[name], seed=seed, choice=choice)
        (more,) = record([_alone(followed)], [case.strengths[0]], step=step)
        write_dataset(case.rig, run, folder, name=name, description=words)
        add_experiment(followed, more, folder, name=name, description=words)
        text = sealed_toml(case.rig, *case.strengths, redrawn=case.redrawn, origin=origin)
        (sealed / f"{case.name}.toml").write_text(text, encoding="utf-8")
    return Path(out)


def _advised(reports: Path) -> dict[str, Advice]:
    """By case, the advice of reports with a tie."""
    found = {}
    for path in sorted(reports.glob(f"*/{REPORT}")):
        report = json.loads(path.read_text(encoding="utf-8"))
        motions = [m for m in report.get("next_experiments", []) if m.get("reference") and _is_tie(m)]
        if report.get("indistinguishable") and motions and motions[0]["expected_gain"] >= DECIDES:
            table = pd.read_csv(path.parent / motions[0]["reference"])
            if len(table.columns) > 2:  # inputs of a rig that follows no path
                continue
            time, column = table["t"].to_numpy(), str(table.columns[1])
            found[path.parent.name] = Advice(time, table[column].to_numpy(), column, motions[0].get("add", {}))
    return found


def _is_tie(motion: dict[str, Any]) -> bool:
    """Whether a motion separates effects, not what the errors of an unknown cause follow."""
    return all(":" in name for name in motion.get("separates", []))


def _followed(case: Settled, advice: Advice, *, seed: int, choice: Choice) -> Rig:
    """The rig with one more experiment."""
    rig, last = case.rig, case.rig.experiments[-1]
    time = np.arange(0.0, advice.time[-1], rig.sample_time)
    if choice == "advised":
        reference, add = _reference(rig, advice, time), _payload(advice.add)
    else:
        draw = np.random.default_rng([seed, case.index + 1, 0, 3])
        reference, add = motion(RICH[draw.integers(len(RICH))], time, draw), {}
    start = last.start + 2 * rig.num_samples * rig.sample_time + 60.0
    new = Experiment(name="run-next", reference=reference, start=start, split="train", add=add)
    return replace(rig, experiments=(*rig.experiments, new))


def _reference(rig: Rig, advice: Advice, time: Array) -> Array:
    """The advised path of the joint: a reference, and the first output, are those of the motor where there is one."""
    of_motor = advice.column in ("qr", rig.system.outputs[0].column)
    return np.interp(time, advice.time, advice.path) / (rig.motor_turns if of_motor else 1.0)


def _payload(add: dict[str, float]) -> dict[str, float]:
    """An advised load, with the inertia that it has at the end of the arm."""
    return add | ({"joint_inertia": add["gravity_torque"] / GRAVITY * ARM} if add else {})


def _alone(rig: Rig) -> Rig:
    """The rig's last experiment in lanes of its own, as long as it is."""
    return replace(rig, experiments=(rig.experiments[-1],) * len(rig.experiments))
