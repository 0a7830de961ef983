"""How the numbers came about: replay, floor, split, fitted parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from tendonlab.report import numbers
from tendonlab.report.blocks import Block, Cell, Table, Terms
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.words import REPLAYS, STAGES, capital, phrases, words
from tendonlab.version import version

_CALIBRATED = {
    True: "Calibrated on simulated rigs whose truth was withheld.",
    False: "Not yet calibrated on simulated rigs whose truth is known: read them as a ranking, not as frequencies.",
}


def computation(diagnosis: Diagnosis) -> list[Block]:
    """Settings by name, the error after each step, and the parameters of the last simulator."""
    rows = [("Replay", f"{_loop(diagnosis.replay)}. The same for every simulator compared."), *_weighed(diagnosis)]
    rows += [(title, ", ".join(diagnosis.split[key])) for key, title in _SPLITS.items() if diagnosis.split.get(key)]
    rows += [("Probabilities", _CALIBRATED[diagnosis.calibrated]), *_details(diagnosis)]
    run = f"tendonlab {version()}, seed {diagnosis.seed}, {numbers.number(diagnosis.seconds)} s"
    return [Terms(rows=[*rows, ("Run", run)]), *_steps(diagnosis), *_parameters(diagnosis)]


_ELSEWHERE = ("parameters", "steps", "evidence", "drift", "weighed_by")  # said there, or only read by a calibration
_SPLITS = {"train": "Fitted and chosen on", "test": "Held out"}


def _loop(replay: Mapping[str, Any]) -> str:
    """The kind of a replay, and its gains with their units."""
    kind = str(replay["kind"])
    gains = [
        f"{name} = {numbers.number(value, 4)} {numbers.unit_text(str(replay.get(f'{name}_unit') or ''))}"
        for name in ("kp", "kd")
        if (value := replay.get(name)) is not None
    ]
    return "; ".join([capital(REPLAYS.get(kind, words(kind))), *(gain.rstrip() for gain in gains)])


def _weighed(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """How simulators were fitted and weighed, where that is not how their errors are shown."""
    by = diagnosis.details.get("weighed_by")
    if by is None:
        return []
    rate = numbers.number(by["samples_per_second"])
    return [
        (
            "Fits and probabilities",
            f"{_loop(by)}; {rate} samples per second. The tables of errors are of the replay above.",
        )
    ]


def _details(diagnosis: Diagnosis) -> list[tuple[str, str]]:
    """The known entries of `details` with their units; all others as they are."""
    rows = []
    for key, value in diagnosis.details.items():
        if key in _ELSEWHERE:
            continue
        if key == "run_to_run_friction":
            rows.append(("Friction from run to run", f"differs by {numbers.percent(value)} (standard deviation)"))
        elif key == "noise":
            rows.append(("Sensor noise", f"{_by_signal(diagnosis, value)} (standard deviation)"))
        elif key == "mean_square":
            levels = [f"{STAGES[stage]} {numbers.number(level)}" for stage, level in value.items()]
            text = f"{', '.join(levels)}: mean square of the training residuals in units of the noise, 1 at the floor"
            rows.append(("Training error", text))
        else:
            rows.append((capital(words(key)), _plainly(value)))
    return rows


def _by_signal(diagnosis: Diagnosis, values: Mapping[str, float]) -> str:
    return "; ".join(
        f"{words(name)} {_with_unit(value, diagnosis.units.get(name, ''))}" for name, value in values.items()
    )


def _with_unit(value: float, unit: str) -> str:
    factor, shown = numbers.prefixed([value], unit)
    return f"{numbers.number(factor * value)} {shown}".rstrip()


def _steps(diagnosis: Diagnosis) -> list[Block]:
    steps = diagnosis.details.get("steps") or []
    if not steps:
        return []
    signals = list(steps[0]["rms"])
    scales = {s: numbers.prefixed([step["rms"][s] for step in steps], diagnosis.units.get(s, "")) for s in signals}
    rows = [
        [
            Cell(capital(phrases(step["effects"], diagnosis.system)) or "None (refitted)"),
            *(Cell(numbers.number(scales[s][0] * step["rms"][s])) for s in signals),
        ]
        for step in steps
    ]
    columns = ["Effects added", *(f"{capital(words(s))} ({scales[s][1]})" for s in signals)]
    right = frozenset(range(1, len(columns)))
    return [Table(title="Held-out RMS error, effect by effect", columns=columns, rows=rows, right=right)]


def _parameters(diagnosis: Diagnosis) -> list[Block]:
    """The parameters of the last simulator: nominal, fitted and interval, each in its unit where that is known."""
    rows = [_parameter_row(name, entry) for name, entry in diagnosis.details.get("parameters", {}).items()]
    if not rows:
        return []
    title = f"Parameters {'with the effect' if diagnosis.selected else 'after refitting'}"
    columns = ("Parameter", "Nominal", "Fitted", "95 % interval")
    return [Table(title=title, columns=columns, rows=rows, right=frozenset({1, 2, 3}), wraps=True)]


def _parameter_row(name: str, entry: Mapping[str, Any]) -> list[Cell]:
    bounds = list(entry.get("ci95") or [])
    shown = [entry["value"], entry.get("nominal"), *bounds]
    factor, unit = numbers.prefixed(shown, str(entry.get("unit") or ""))
    value, nominal, *ends = (None if number is None else factor * number for number in shown)
    told, interval = numbers.estimate(value, ends, 4)
    if not entry.get("informed", True):
        interval = "held: a small change has no effect"
    title = Cell(capital(words(str(name))), soft=f"({unit})" if unit else "")
    return [title, Cell(numbers.number(nominal, 4)), Cell(told), Cell(interval)]


def _plainly(value: Any) -> str:
    """A setting of `details` in words, whatever its type."""
    if isinstance(value, Mapping):
        return "; ".join(f"{words(str(key))} {_plainly(item)}" for key, item in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(_plainly(item) for item in value) or "none"
    if isinstance(value, bool) or value is None:
        return {True: "yes", False: "no", None: numbers.ABSENT}[value]
    return numbers.number(float(value), 4) if isinstance(value, int | float) else str(value)
