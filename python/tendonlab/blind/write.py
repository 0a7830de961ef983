"""Write a drawn case as a dataset folder, and its truth apart from it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
import pandas as pd

from .description import Array, Experiment, Run
from .faults import TIME, Fault, spoiled
from .lanes import alike, lanes_of, scene_of
from .plant import simulate
from .rig import LACKING, Rig, full_truth, nominal_effects, nominal_values
from .strength import Strength

INDISTINGUISHABLE = 3.0  # nats
VERDICTS = {"none": "no_gap", "unknown": "unknown_effect"}  # the other kinds are called like their verdict
Value = TypeVar("Value")


def record(rigs: Sequence[Rig], strengths: Sequence[Strength], *, step: float | None = None) -> list[Run]:
    """Noisy logs of every rig with its effect at the tuned amplitude, one Run of ten lanes each; `step` None: the
    system's fine one.
    """
    runs: dict[int, Run] = {}
    for rows in alike(rigs):
        part = [rigs[i] for i in rows]
        amplitudes = [strengths[i].amplitude for i in rows]
        runs |= dict(zip(rows, _record(part, amplitudes, step=step or part[0].system.fine_step), strict=True))
    return [runs[i] for i in range(len(rigs))]


def _record(rigs: Sequence[Rig], amplitudes: Sequence[float], *, step: float) -> list[Run]:
    parameters = [full_truth(rig, amplitude) for rig, amplitude in zip(rigs, amplitudes, strict=True)]
    noisy = [True] * len(rigs)
    run = simulate(lanes_of(rigs, parameters, is_noisy=noisy), scene_of(rigs, is_noisy=noisy), step=step)
    runs, first = [], 0
    for rig in rigs:
        part = slice(first, first + len(rig.experiments))
        runs.append(
            Run(time=run.time, command=run.command[:, part], outputs=run.outputs[..., part], state=run.state[..., part])
        )
        first = part.stop
    return runs


def write_dataset(rig: Rig, run: Run, folder: Path, *, name: str, description: str, fault: Fault | None = None) -> None:
    """Write dataset.toml and one CSV an experiment, with the mistake `fault` in the logs; nothing of the truth. Raises
    FileExistsError where `folder` has a dataset.
    """
    if (folder / "dataset.toml").exists():
        raise FileExistsError(f"{folder} holds a dataset already: expected a new folder")
    folder.mkdir(parents=True, exist_ok=True)
    logs = {experiment.name: _log(rig, run, lane) for lane, experiment in enumerate(rig.experiments)}
    if fault:
        logs = spoiled(logs, fault, outputs=tuple(output.name for output in rig.system.outputs))
    for experiment, log in logs.items():
        _write_log(rig, log, folder / f"{experiment}.csv", fault=fault)
    text = dataset_toml(rig, name=name, description=description)
    (folder / "dataset.toml").write_text(text, encoding="utf-8")


def add_experiment(rig: Rig, run: Run, folder: Path, *, name: str, description: str) -> None:
    """Write the log of the rig's last experiment, the last lane of `run`, and dataset.toml with all experiments."""
    _write_log(rig, _log(rig, run, -1), folder / f"{rig.experiments[-1].name}.csv")
    (folder / "dataset.toml").write_text(dataset_toml(rig, name=name, description=description), encoding="utf-8")


def _write_log(rig: Rig, log: Mapping[str, Array], path: Path, *, fault: Fault | None = None) -> None:
    table = {"t": np.char.mod("%.3f", log[TIME])}
    for signal, column, _, digits in _signals(rig):
        is_scaled = fault is not None and abs(fault.factor) != 1.0 and signal in fault.signals
        table[column] = np.char.mod("%.9g" if is_scaled else digits, log[signal])
    pd.DataFrame(table).to_csv(path, index=False)


def _log(rig: Rig, run: Run, lane: int) -> dict[str, Array]:
    """Time and every signal of one experiment."""
    experiment = rig.experiments[lane]
    log = {rig.system.reference: rig.motor_turns * experiment.reference, **experiment.others}
    log |= {TIME: run.time, rig.system.inputs[0].name: run.command[:, lane]}
    return log | {output.name: run.outputs[i, :, lane] for i, output in enumerate(rig.system.outputs)}


def _signals(rig: Rig) -> list[tuple[str, str, str, str]]:
    """Signal, column, unit and digits of what is logged."""
    measured = [output[:4] for output in rig.system.outputs if output.name in rig.outputs]
    reference = (rig.system.reference, "qr", "rad", "%.7f")
    inputs = [entry[:4] for entry in rig.system.inputs]
    return [*inputs, *measured, *([reference] if rig.has_controller else [])]


def dataset_toml(rig: Rig, *, name: str, description: str) -> str:
    """Text of dataset.toml, as docs/datasets.md describes it."""
    lines = [
        'format      = "tendonlab-dataset/1"',
        f"name        = {_toml(name)}",
        f"description = {_toml(description)}",
    ]
    lines += ['time        = { column = "t", unit = "s" }', "", "[system]", f"kind = {_toml(rig.system.kind)}"]
    lines += ['axis = "rotary"', f"nominal_effects = {_toml(list(nominal_effects(rig)))}", "", "[system.parameters]"]
    lines += [
        f"{key} = {{ value = {_toml(value)}, sd = {_toml(sd)} }}"
        for key, (value, sd) in stated(rig, nominal_values(rig)).items()
    ]
    if rig.has_controller:
        lines += _controller_lines(rig)
    resolution = {output.name: output.resolution for output in rig.system.outputs if output.resolution > 0}
    held = {entry.name for entry in rig.system.inputs if entry.hold}
    for signal, column, unit, _ in _signals(rig):
        lines += ["", f"[signals.{signal}]", f"column = {_toml(column)}", f"unit = {_toml(unit)}"]
        if signal in held:
            lines.append("hold = true")
        if signal in resolution:
            lines.append(f"resolution = {resolution[signal]:.7g}")
    return "\n".join(lines + [line for e in rig.experiments for line in _experiment_lines(rig, e)]) + "\n"


def stated(rig: Rig, values: Mapping[str, Value]) -> dict[str, Value]:
    """`values` under the names that a dataset gives the parameters."""
    return {rig.system.contract.get(name, name): value for name, value in values.items()}


def _controller_lines(rig: Rig) -> list[str]:
    return [
        "",
        "[controller]",
        'kind = "pd"',
        *(f"{key} = {_toml(rig.loop[key])}" for key in ("kp", "kd", "limit")),
        f"measured = {_toml(rig.system.outputs[0].name)}",
        f"reference = {_toml(rig.system.reference)}",
        'derivative_on = "error"',
        f"sample_time = {rig.sample_time}",
    ]


def _experiment_lines(rig: Rig, experiment: Experiment) -> list[str]:
    lines = ["", "[[experiments]]", f"name = {_toml(experiment.name)}", f"file = {_toml(experiment.name + '.csv')}"]
    lines.append(f"split = {_toml(experiment.split)}")
    if experiment.repeat:
        lines.append(f"repeat = {_toml(experiment.repeat)}")
    lines.append(f"start = {_toml(experiment.start)}")
    if experiment.add:
        added = stated(rig, experiment.add)
        lines.append("add = { " + ", ".join(f"{key} = {_toml(value)}" for key, value in added.items()) + " }")
    return lines


def write_at_once(path: Path, text: str) -> None:
    """Write a file that appears when all of it is there."""
    unfinished = path.with_name(f"{path.name}.unfinished")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(path)


def sealed_toml(
    rig: Rig,
    strength: Strength,
    *second: Strength,
    redrawn: Sequence[str] = (),
    fault: Fault | None = None,
    origin: Mapping[str, object] | None = None,
) -> str:
    """Text of the truth file: effects, verdict, accept, [truth] parameters, [draw] how the case came about.

    `second`: of the second effect, where the rig has one. `fault`: a mistake in the logs, which is then all that can be
    found. `origin`: the protocol that the case was drawn by.
    """
    verdict = "data_fault" if fault else VERDICTS.get(rig.kind, rig.kind)
    separation = {name: nats for each in (strength, *second) for name, nats in each.separation.items()}
    twins = {twin for effect in rig.missing for twin in rig.system.twins(effect, rig.outputs)}
    accept = [n for n, nats in separation.items() if nats < INDISTINGUISHABLE or n in twins]
    effects = list(rig.missing) if rig.kind == "effect" and not fault else []
    truth = full_truth(rig, strength.amplitude)
    lines = ['format = "tendonlab-sealed/1"', f"effects = {_toml(effects)}"]
    lines += [
        f"verdict = {_toml(verdict)}",
        f"accept = {_toml(accept)}",
        "",
        "[truth]",
        *_table(stated(rig, truth)),
        "",
        "[draw]",
        *_table(_drawn(rig, strength, redrawn) | _drawn_second(*second)),
    ]
    if origin:
        lines += ["", "[protocol]", *_table(origin)]
    if fault:
        lines += ["", "[fault]", *_table(fault.to_dict())]
    if separation:
        nats = {name: float(f"{value:.4g}") for name, value in separation.items()}
        lines += ["", "[separation]  # nats that tell the effect from its rivals; accepted below 3", *_table(nats)]
    return "\n".join(lines) + "\n"


def _drawn(rig: Rig, strength: Strength, redrawn: Sequence[str]) -> dict[str, object]:
    """How the case came about."""
    effect = rig.effect.partition(":")[2]
    return {
        "kind": rig.kind,
        "cause": effect if rig.kind == "unknown" else "",
        "system": rig.system.kind,
        "sample_time": rig.sample_time,
        "excitation": rig.excitation,
        "controller": rig.has_controller,
        "repeats": rig.has_repeats,
        "form": rig.forms[rig.form] if rig.kind == "effect" else "documented",
        "is_documented_form": rig.form == 0 or rig.kind != "effect",
        "gap_noise": round(strength.gap_noise, 4),
        "target": round(rig.target, 4) if rig.kind in LACKING else 0.0,
        "nominal_gap_noise": round(strength.nominal_gap_noise, 4),
        "limited": strength.limited,
        "met": strength.met,
        "amplitude": float(f"{strength.amplitude:.6g}"),
        "noise": round(rig.noise, 4),
        "floor": [float(f"{value:.4g}") for value in strength.floor],
        "redrawn": list(redrawn),
    }


def _drawn_second(*second: Strength) -> dict[str, object]:
    return {f"second_{name}": round(getattr(s, name), 4) for s in second for name in ("gap_noise", "amplitude")}


def _table(values: Mapping[str, object]) -> list[str]:
    return [
        f"{key if key.replace('_', '').isalnum() else json.dumps(key)} = {_toml(value)}"
        for key, value in values.items()
    ]


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        text = f"{value:.7g}"
        return text if any(mark in text for mark in ".en") else text + ".0"
    if isinstance(value, list):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return json.dumps(value, ensure_ascii=False)
