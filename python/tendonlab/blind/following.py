"""Give drawn cases the next experiment: the one that a report advises, or a random one of the same length."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import pandas as pd

from .description import Array, Experiment, Input
from .drawing import Settled, description, make_folders, name_of, settle
from .excitation import ARM, GRAVITY
from .planning import plan
from .rig import Rig
from .runner import REPORT
from .ties import tie_of
from .write import add_experiment, record, sealed_toml, write_dataset

Choice = Literal["advised", "random"]


class Advice(NamedTuple):
    """What a report advises: time, s, the columns of its reference by name, SI, and what the run adds to parameters."""

    time: Array
    columns: dict[str, Array]
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
    """Draw the cases of a series again whose report ends in a tie that an experiment can settle (`tie_of`), each with
    one more training experiment, into `out`/cases; return `out`.

    `seed`, `count`, `origin` and `drawn`: as `draw` had them. `reports`: what `run` wrote. `choice`: "advised" makes
    the experiment that the report puts first, "random" one of the generator's, as long as the advised one and within
    the range and the rates of the rig's logs. The truths go into the new folder `sealed`. Raises ValueError where no
    report has such a tie, FileExistsError if a folder exists.
    """
    advised = _advised(Path(reports))
    batch = [(i, w) for i, w in enumerate(plan(seed, count, **drawn)) if name_of(i) in advised and not w.has_fault]
    if not batch:
        raise ValueError(f"{reports}: expected a report with a tie that an experiment can settle, found none")
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
        tie = tie_of(json.loads(path.read_text(encoding="utf-8")))
        if tie is not None:
            table = pd.read_csv(path.parent / tie.experiment["reference"]).astype(float)
            columns = {str(name): table[name].to_numpy() for name in table.columns[1:]}
            found[path.parent.name] = Advice(table["t"].to_numpy(), columns, dict(tie.experiment.get("add", {})))
    return found


def _followed(case: Settled, advice: Advice, *, seed: int, choice: Choice) -> Rig:
    """The rig with one more experiment."""
    rig, last = case.rig, case.rig.experiments[-1]
    time = np.arange(0.0, advice.time[-1], rig.sample_time)
    if choice == "advised":
        new = _as_advised(rig, advice, time)
    else:
        new = _drawn(rig, time, np.random.default_rng([seed, case.index + 1, 0, 3]))
    start = last.start + 2 * rig.num_samples * rig.sample_time + 60.0
    new = replace(new, name="run-next", start=start, split="train", repeat=None)
    return replace(rig, experiments=(*rig.experiments, new))


def _as_advised(rig: Rig, advice: Advice, time: Array) -> Experiment:
    """The advised motion, or the advised inputs."""
    played = {name: np.interp(time, advice.time, values) for name, values in advice.columns.items()}
    others = {entry.name: played.pop(entry.column) for entry in rig.system.inputs[1:] if entry.column in played}
    ((column, path),) = played.items()
    of_motor = column in ("qr", rig.system.outputs[0].column)  # where there is a motor
    named = {told: own for own, told in rig.system.contract.items()}
    add = {named.get(name, name): value for name, value in advice.add.items()}
    if set(add) == {"gravity_torque"}:  # with the inertia that the load has at the end of the arm
        add["joint_inertia"] = add["gravity_torque"] / GRAVITY * ARM
    reference = path / (rig.motor_turns if of_motor else 1.0)
    return Experiment(name="", reference=reference, others=others, start=0.0, split="train", add=add)


def _drawn(rig: Rig, time: Array, draw: np.random.Generator) -> Experiment:
    """A random experiment of a rich session, with its load, within the range and the rates of the rig's own logs."""
    runs = rig.system.session(
        draw, excitation="rich", sample_time=rig.sample_time, num_samples=len(time), has_repeats=False
    )
    drawn = runs[draw.integers(len(runs))]
    seen = {name: [run.others[name] for run in rig.experiments] for name in drawn.others}
    of = {entry.name: entry for entry in rig.system.inputs}
    others = {name: _within(x, seen[name], of=of[name]) for name, x in drawn.others.items()}
    reference = _within(drawn.reference, [run.reference for run in rig.experiments], of=rig.system.inputs[0])
    return replace(drawn, reference=reference, others=others)


def _within(signal: Array, seen: Sequence[Array], *, of: Input) -> Array:
    """The signal, made smaller where it is wider or faster than those that were seen, and moved into their range unless
    it is a speed, which would drift."""
    low, high = min(map(np.min, seen)), max(map(np.max, seen))
    fastest = max(float(np.max(np.abs(np.diff(one)))) for one in seen)
    wide, fast = float(np.ptp(signal)), float(np.max(np.abs(np.diff(signal))))
    smaller = min(1.0, (high - low) / wide if wide else 1.0, fastest / fast if fast else 1.0)
    made = signal[0] + smaller * (signal - signal[0])
    moved = 0.0 if of.unit.endswith("/s") else max(0.0, low - made.min()) - max(0.0, made.max() - high)
    return np.asarray(made + moved)


def _alone(rig: Rig) -> Rig:
    """The rig's last experiment in lanes of its own, as long as it is, with noise and scatter of its own."""
    return replace(rig, experiments=(rig.experiments[-1],) * len(rig.experiments), recording=1)
