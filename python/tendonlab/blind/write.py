"""Write a drawn case as a dataset folder, and its truth apart from it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from .excitation import Experiment
from .plant import OUTPUTS, Run, simulate
from .rig import FORMS, RESOLUTION, SAMPLE_TIME, Rig, full_truth, lanes_of, nominal_effects, nominal_values, scene_of
from .strength import Strength

FINE_STEP = 2e-5  # s, ten times finer than the step that tuned the strength
COLUMNS = {"motor_torque": "u", "motor_angle": "qm", "joint_angle": "ql", "cable_torque": "fc", "reference_angle": "qr"}
UNITS = {
    "motor_torque": "N*m",
    "motor_angle": "rad",
    "joint_angle": "rad",
    "cable_torque": "N*m",
    "reference_angle": "rad",
}
FORMAT = {
    "motor_torque": "%.7f",
    "motor_angle": "%.6f",
    "joint_angle": "%.7f",
    "cable_torque": "%.4f",
    "reference_angle": "%.7f",
}
INDISTINGUISHABLE = 3.0  # nats


def record(rigs: Sequence[Rig], strengths: Sequence[Strength], *, step: float = FINE_STEP) -> list[Run]:
    """Noisy logs of every rig with its effect at the tuned amplitude, one Run of ten lanes each."""
    parameters = [full_truth(rig, strength.amplitude) for rig, strength in zip(rigs, strengths, strict=True)]
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


def write_dataset(rig: Rig, run: Run, folder: Path, *, name: str, description: str) -> None:
    """Write dataset.toml and one CSV an experiment; nothing of the truth. Raises FileExistsError where `folder` has
    a dataset.
    """
    if (folder / "dataset.toml").exists():
        raise FileExistsError(f"{folder} holds a dataset already: expected a new folder")
    folder.mkdir(parents=True, exist_ok=True)
    signals = ["motor_torque", *rig.outputs, *(["reference_angle"] if rig.has_controller else [])]
    for lane, experiment in enumerate(rig.experiments):
        values = {
            "motor_torque": run.command[:, lane],
            "reference_angle": rig.truth["gear_ratio"] * experiment.reference,
        }
        values |= {output: run.outputs[i, :, lane] for i, output in enumerate(OUTPUTS)}
        table = {"t": np.char.mod("%.3f", run.time)} | {COLUMNS[s]: np.char.mod(FORMAT[s], values[s]) for s in signals}
        pd.DataFrame(table).to_csv(folder / f"{experiment.name}.csv", index=False)
    (folder / "dataset.toml").write_text(
        dataset_toml(rig, signals, name=name, description=description), encoding="utf-8"
    )


def dataset_toml(rig: Rig, signals: Sequence[str], *, name: str, description: str) -> str:
    """Text of dataset.toml, as docs/datasets.md describes it."""
    lines = [
        'format      = "tendonlab-dataset/1"',
        f"name        = {_toml(name)}",
        f"description = {_toml(description)}",
    ]
    lines += ['time        = { column = "t", unit = "s" }', "", "[system]", 'kind = "two_inertia"', 'axis = "rotary"']
    lines += [f"nominal_effects = {_toml(list(nominal_effects(rig)))}", "", "[system.parameters]"]
    lines += [
        f"{key} = {{ value = {_toml(value)}, sd = {_toml(sd)} }}" for key, (value, sd) in nominal_values(rig).items()
    ]
    if rig.has_controller:
        lines += [
            "",
            "[controller]",
            'kind = "pd"',
            *(f"{key} = {_toml(rig.loop[key])}" for key in ("kp", "kd", "limit")),
        ]
        lines += [
            'measured = "motor_angle"',
            'reference = "reference_angle"',
            'derivative_on = "error"',
            f"sample_time = {SAMPLE_TIME}",
        ]
    for signal in signals:
        lines += ["", f"[signals.{signal}]", f"column = {_toml(COLUMNS[signal])}", f"unit = {_toml(UNITS[signal])}"]
        if signal == "motor_torque":
            lines.append("hold = true")
        if signal in OUTPUTS:
            lines.append(f"resolution = {RESOLUTION[OUTPUTS.index(signal)]:.7g}")
    return "\n".join(lines + [line for e in rig.experiments for line in _experiment_lines(e)]) + "\n"


def _experiment_lines(experiment: Experiment) -> list[str]:
    lines = ["", "[[experiments]]", f"name = {_toml(experiment.name)}", f"file = {_toml(experiment.name + '.csv')}"]
    lines.append(f"split = {_toml(experiment.split)}")
    if experiment.repeat:
        lines.append(f"repeat = {_toml(experiment.repeat)}")
    lines.append(f"start = {_toml(experiment.start)}")
    if experiment.add:
        lines.append("add = { " + ", ".join(f"{key} = {_toml(value)}" for key, value in experiment.add.items()) + " }")
    return lines


def sealed_toml(rig: Rig, strength: Strength, *, redrawn: Sequence[str] = ()) -> str:
    """Text of the truth file: effects, verdict, accept, [truth] parameters, [draw] how the case came about."""
    verdict = {"effect": "effect", "none": "no_gap", "parameters_only": "parameters_only"}[rig.kind]
    accept = [name for name, nats in strength.separation.items() if nats < INDISTINGUISHABLE]
    effect = rig.effect.partition(":")[2]
    truth = full_truth(rig, strength.amplitude)
    draw: dict[str, object] = {
        "kind": rig.kind,
        "excitation": rig.excitation,
        "controller": rig.has_controller,
        "repeats": rig.has_repeats,
        "form": FORMS.get(effect, ("documented",))[rig.form] if rig.kind == "effect" else "documented",
        "is_documented_form": rig.form == 0 or rig.kind != "effect",
        "gap_noise": round(strength.gap_noise, 4),
        "target": round(rig.target, 4) if rig.kind == "effect" else 0.0,
        "nominal_gap_noise": round(strength.nominal_gap_noise, 4),
        "limited": strength.limited,
        "met": strength.met,
        "amplitude": float(f"{strength.amplitude:.6g}"),
        "noise": round(rig.noise, 4),
        "floor": [float(f"{value:.4g}") for value in strength.floor],
        "redrawn": list(redrawn),
    }
    lines = ['format = "tendonlab-sealed/1"', f"effects = {_toml([rig.effect] if rig.kind == 'effect' else [])}"]
    lines += [
        f"verdict = {_toml(verdict)}",
        f"accept = {_toml(accept)}",
        "",
        "[truth]",
        *_table(truth),
        "",
        "[draw]",
        *_table(draw),
    ]
    if strength.separation:
        nats = {name: float(f"{value:.4g}") for name, value in strength.separation.items()}
        lines += ["", "[separation]  # nats that tell the effect from its rivals; accepted below 3", *_table(nats)]
    return "\n".join(lines) + "\n"


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
