"""Rehearse drawn rigs that lack nothing, then record and diagnose the same rigs with effects missing: the generator's
rigs are the real ones, of which the rehearsal predicts what would be found.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from tendonlab.data import Dataset, load
from tendonlab.rehearsal.sizes import size_parameter, withheld_effects

from .drawing import description, name_of
from .reach import refuse_within_reach
from .resuming import plain_settings, refuse_other
from .rig import Rig, draw_rig, effect_parameters, largest_amplitude
from .runner import VERDICTS, run
from .strength import measured, tune
from .systems import SYSTEMS
from .systems.effects import draw_shape
from .write import record, sealed_toml, stated, write_at_once, write_dataset

RIG, REHEARSAL, CASES, REPORTS, SETTINGS = "rig", "rehearsal", "cases", "reports", "settings.json"
FOUND = "rehearsal.json"  # in the folder of a rehearsal


@dataclass(frozen=True, kw_only=True)
class Designs:
    """What is drawn and asked. A design is a rig with its inputs, sensors, sample rate, repeats and nominal errors.

    `repeats`: share of the designs that repeat an experiment. `fastest`: highest sample rate, Hz. `num_effects`: of a
    design, drawn from those that can be compared. `sizes`: gaps over noise, as a rehearsal has them. `rehearsed`,
    `realised`: rigs of each effect and size in the rehearsal, and of the generator. `num_samples`, `step`: of the logs,
    None for those of the system.
    """

    seed: int
    system: str = "rigid_joint"
    repeats: float = 0.5
    fastest: float = 1000.0
    num_effects: int = 4
    sizes: tuple[float, ...] = (0.1, 0.3, 1.0, 3.0)
    rehearsed: int = 6
    realised: int = 1
    num_samples: int | None = None
    step: float | None = None

    def __post_init__(self) -> None:
        """Raise ValueError for another system, if a share is not from 0 to 1, and for counts, sizes, rates and steps
        that are none."""
        if self.system not in SYSTEMS:
            raise ValueError(f"system = {self.system!r}: expected one of {', '.join(SYSTEMS)}")
        if self.seed < 0:
            raise ValueError(f"seed = {self.seed}: expected at least 0")
        if not 0.0 <= self.repeats <= 1.0:
            raise ValueError(f"repeats = {self.repeats}: expected a share from 0 to 1")
        for name in ("num_effects", "rehearsed", "realised", "num_samples"):
            count = getattr(self, name)
            if count is not None and count < 1:
                raise ValueError(f"{name} = {count}: expected at least 1")
        for name in ("fastest", "step"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < np.inf:
                raise ValueError(f"{name} = {value}: expected a number above 0")
        ends = (0.0, *self.sizes, np.inf)
        if not self.sizes or not all(one < other for one, other in pairwise(ends)):
            raise ValueError(f"sizes = {self.sizes}: expected numbers above 0 that rise")

    def draw(self, index: int) -> Rig:
        """The rig of a design, which lacks nothing."""
        system = SYSTEMS[self.system]
        rates = tuple(time for time in system.sample_times if time * self.fastest > 1.0 - 1e-9)
        if not rates:
            raise ValueError(f"fastest = {self.fastest:g} Hz: expected at least {1 / max(system.sample_times):g} Hz")
        return draw_rig(
            self.random(index, 4),
            effect="",
            kind="effect",  # nominal values are as wrong as where an effect is missing
            system=replace(system, sample_times=rates),
            num_samples=self.num_samples,
            has_repeats=int((index + 1) * self.repeats) > int(index * self.repeats),
        )

    def random(self, index: int, stream: int) -> np.random.Generator:
        """Random numbers of a design, for one purpose."""
        return np.random.default_rng([self.seed, index + 1, 0, stream])


def rehearse(
    designs: Designs,
    count: int,
    out: Path | str,
    *,
    sealed: Path | str,
    minutes: float = 120.0,
    timeout: float = 1800.0,
    progress: bool = True,
) -> Path:
    """Draw, rehearse, record and diagnose the first `count` designs, one after the other, into `out`/design-001, …;
    return `out`. The truths go into `sealed`. What is there already is kept, so that the same call goes on, and a
    larger `count` adds designs.

    `minutes`: time of a rehearsal at most; `timeout`: of one diagnosis, s. A design whose rehearsal fails is left out.
    Raises ValueError where `sealed` and `out` lie in each other, where `out` belongs to other settings, or for settings
    that cannot be drawn."""
    out, sealed = Path(out).resolve(), Path(sealed).resolve()
    refuse_within_reach(sealed, out)
    if count < 1:
        raise ValueError(f"count = {count}: expected at least 1")
    designs.draw(0)
    _keep(designs, out)
    for index in tqdm(range(count), desc="rehearse", unit="design", disable=not progress):
        name = f"design-{index + 1:03d}"
        folder = out / name
        message = "" if (folder / CASES).exists() else _recorded(designs, index, folder, sealed / name, minutes=minutes)
        if message:
            tqdm.write(f"{name} is left out: {message}", file=sys.stderr)
        elif not (folder / REPORTS / VERDICTS).exists():
            run(folder / CASES, folder / REPORTS, timeout=timeout, progress=progress)
    return out


def _keep(designs: Designs, out: Path) -> None:
    """Write the settings, or raise ValueError where `out` has others."""
    settings, path = plain_settings(asdict(designs)), out / SETTINGS
    out.mkdir(parents=True, exist_ok=True)
    if path.exists():
        refuse_other(path, json.loads(path.read_text(encoding="utf-8")), settings)
    else:
        write_at_once(path, json.dumps(settings, indent=1) + "\n")


def _recorded(designs: Designs, index: int, folder: Path, truths: Path, *, minutes: float) -> str:
    """Rehearse a design and record its rigs; why that failed, or an empty text."""
    rig = designs.draw(index)
    message = _predict(designs, index, rig, folder, minutes=minutes)
    return message or _realise(designs, index, rig, folder, truths)


def _predict(designs: Designs, index: int, rig: Rig, folder: Path, *, minutes: float) -> str:
    """Write the logs of the rig that lacks nothing and rehearse them; why that failed, or an empty text."""
    _empty(folder / RIG)
    (logs,) = record([rig], tune([replace(rig, kind="none")]), step=designs.step)
    write_dataset(rig, logs, folder / RIG, name=folder.name, description=description(rig))
    known = comparable(rig, load(folder / RIG))
    effects = [known[k] for k in designs.random(index, 5).permutation(len(known))[: designs.num_effects]]
    command = [sys.executable, "-m", "tendonlab", "rehearse", str(folder / RIG), "--out", str(folder / REHEARSAL)]
    command += ["--effects", *effects, "--sizes", *map(str, designs.sizes), "--seed", str(designs.seed)]
    command += ["--repeats-per-size", str(designs.rehearsed), "--minutes", str(minutes), "--jobs", "1", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0 and (folder / REHEARSAL / FOUND).exists():
        return ""
    return (done.stderr or done.stdout or f"no {FOUND} was written").strip().splitlines()[-1]


def comparable(rig: Rig, dataset: Dataset) -> list[str]:
    """Effects that can be missing in a rehearsal and in the generator, and whose size is the same parameter in both.
    One with two amplitudes, such as friction that differs by direction, has no such size."""
    system = dataset.system()
    found = []
    for name in withheld_effects(system, dataset.outputs):
        rows = [system.info.parameter(parameter) for parameter in system.info.effect(name).parameters]
        if name in rig.system.effects and sum(row.purpose == "amplitude" for row in rows) <= 1:
            sizes = [amount(replace(rig, effect=name), size_parameter(system, name).name, at) for at in (1.0, 2.0)]
            found += [name] * (0.0 < sizes[0] != sizes[1])
    return found


def amount(rig: Rig, parameter: str, amplitude: float) -> float:
    """Absolute value of a parameter, by the name that the dataset gives it, at an amplitude of the rig's effect; 0
    where the effect does not have it."""
    return abs(stated(rig, effect_parameters(rig, amplitude)).get(parameter, 0.0))


def amplitude_of(rig: Rig, parameter: str, wanted: float) -> float:
    """The amplitude at which a parameter of the rig's effect is as `wanted`: it is a power of the amplitude."""
    first, second = (amount(rig, parameter, at) for at in (1.0, 2.0))
    amplitude = float((wanted / first) ** (1.0 / np.log2(second / first)))
    if not np.isclose(amount(rig, parameter, amplitude), wanted, rtol=1e-6):
        raise ValueError(f"{rig.effect}: {parameter} is no power of the amplitude; expected one")
    return amplitude


def _realise(designs: Designs, index: int, rig: Rig, folder: Path, truths: Path) -> str:
    """Record the rig with each effect missing at each size of its rehearsal, in random order, truths apart; why there
    is nothing to record, or an empty text."""
    _empty(truths)
    part = folder / f"{CASES}-part"  # renamed once complete
    _empty(part)
    random = designs.random(index, 6)
    rehearsal = json.loads((folder / REHEARSAL / FOUND).read_text(encoding="utf-8"))
    wanted = [each for each in _sized(rig, rehearsal) for _ in range(designs.realised)]
    if not wanted:
        return "the generator has none of the sizes that were rehearsed"
    cases = [wanted[k] for k in random.permutation(len(wanted))]
    rigs = [replace(r, shape=draw_shape(random), recording=k + 1) for k, (r, _, _) in enumerate(cases)]
    amplitudes = [amplitude_of(r, name, size) for r, (_, name, size) in zip(rigs, cases, strict=True)]
    strengths = measured(rigs, amplitudes)
    logs = record(rigs, strengths, step=designs.step)
    for k, (lacking, strength, log) in enumerate(zip(rigs, strengths, logs, strict=True)):
        name = name_of(k)
        write_dataset(lacking, log, part / name, name=name, description=description(rig))
        reached = replace(lacking, target=strength.gap_noise)  # the size was asked for, no gap over noise
        (truths / f"{name}.toml").write_text(sealed_toml(reached, strength), encoding="utf-8")
    part.rename(folder / CASES)
    return ""


def _sized(rig: Rig, rehearsal: Mapping[str, Any]) -> list[tuple[Rig, str, float]]:
    """Rigs that lack an effect of the library's own form, with its size parameter, for each size that was rehearsed; a
    size beyond the generator's limit is left out."""
    found = []
    for entry in rehearsal["effects"]:
        lacking, name = replace(rig, effect=entry["effect"], form=0), entry["parameter"]
        for size in entry["sizes"]:
            if amplitude_of(lacking, name, size["amount"]) <= largest_amplitude(lacking):
                found.append((lacking, name, size["amount"]))
    return found


def _empty(folder: Path) -> None:
    """Make a folder new: what an interrupted call left of it is incomplete."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
