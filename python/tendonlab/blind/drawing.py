"""Draw blind cases: dataset folders under OUT/cases, their truth in a folder of its own."""

from __future__ import annotations

import shutil
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from . import unknown
from .faults import draw_fault
from .pairs import paired, tuned
from .planning import Wanted, plan
from .rig import LACKING, Rig, draw_rig
from .strength import Strength
from .systems import SYSTEMS
from .write import record, sealed_toml, write_at_once, write_dataset

BATCH = 40  # cases simulated together


@dataclass(frozen=True)
class Settled:
    """A drawn case, except for its logs: its place in the series, the rig with every amplitude set, the strengths of
    its effects, and the effects that were out of its reach.
    """

    index: int
    rig: Rig
    strengths: list[Strength]
    redrawn: list[str]

    @property
    def name(self) -> str:
        return name_of(self.index)


def draw(
    seed: int,
    count: int,
    out: Path | str,
    *,
    sealed: Path | str | None = None,
    origin: Mapping[str, object] | None = None,
    resumes: bool = False,
    jobs: int = 2,
    num_samples: int | None = None,
    step: float | None = None,
    progress: bool = True,
    **options: Any,
) -> Path:
    """Draw `count` cases into `out`/cases and return `out`; about 70 % lack one effect, 15 % nothing, 15 % have wrong
    parameters only, unless `options`, fields of `Options`, say otherwise.

    The truth goes into the folder `sealed`, without it into `out`/sealed, from where it must be moved before `run`.
    `origin`: what the truths say of the protocol, see `Protocol.origin`. Where it `resumes`, cases that were drawn
    before stay, and the others are drawn.
    The same seed gives the same cases whatever `jobs`. Raises ValueError for what `plan` cannot draw,
    FileExistsError if one of the two folders exists and drawing does not resume, or has nothing but this one to resume.
    """
    cases, sealed = Path(out) / "cases", Path(out) / "sealed" if sealed is None else Path(sealed)
    planned = plan(seed, count, **options)
    if not (resumes and cases.exists() and sealed.exists()):
        make_folders(cases, sealed)
    batches = [batch for batch in _batches(planned) if _missing(batch, sealed)]
    work = partial(
        _draw_batch, seed=seed, cases=cases, sealed=sealed, origin=origin, num_samples=num_samples, step=step
    )
    done = count - sum(len(batch) for batch in batches)
    with tqdm(total=count, initial=done, desc="draw", unit="case", disable=not progress) as bar:
        if jobs <= 1:
            for batch in batches:
                bar.update(work(batch))
        else:
            with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
                for drawn in pool.map(work, batches):
                    bar.update(drawn)
    return Path(out)


def _missing(batch: Sequence[tuple[int, Wanted]], sealed: Path) -> set[int]:
    """Places of the cases without a truth, which is the last that a case gets."""
    return {index for index, _ in batch if not (sealed / f"{name_of(index)}.toml").exists()}


def _batches(planned: Sequence[Wanted]) -> list[list[tuple[int, Wanted]]]:
    """The places of the series in batches of one kind of rig each: only rigs of one kind are simulated side by side."""
    of_kind: dict[str, list[tuple[int, Wanted]]] = {}
    for place in enumerate(planned):
        of_kind.setdefault(place[1].system, []).append(place)
    return [places[i : i + BATCH] for places in of_kind.values() for i in range(0, len(places), BATCH)]


def make_folders(*folders: Path) -> None:
    """Make new folders. Raises FileExistsError, and makes none, if one of them exists."""
    for folder in folders:
        if folder.exists():
            raise FileExistsError(f"{folder} exists: expected a new folder to draw into")
    for folder in folders:
        folder.mkdir(parents=True)


def _draw_batch(
    batch: Sequence[tuple[int, Wanted]],
    *,
    seed: int,
    cases: Path,
    sealed: Path,
    origin: Mapping[str, object] | None,
    num_samples: int | None,
    step: float | None,
) -> int:
    settled = settle(batch, seed=seed, num_samples=num_samples)
    rigs, firsts = [case.rig for case in settled], [case.strengths[0] for case in settled]
    missing = _missing(batch, sealed)  # of a batch that was interrupted, all rigs are simulated: the bits stay the same
    for case, wanted, run in zip(settled, (w for _, w in batch), record(rigs, firsts, step=step), strict=True):
        if case.index not in missing:
            continue
        name, rig = case.name, case.rig
        fault = draw_fault(rig, np.random.default_rng([seed, case.index + 1, 0, 2])) if wanted.has_fault else None
        shutil.rmtree(cases / name, ignore_errors=True)
        write_dataset(rig, run, cases / name, name=name, description=description(rig), fault=fault)
        text = sealed_toml(rig, *case.strengths, redrawn=case.redrawn, fault=fault, origin=origin)
        write_at_once(sealed / f"{name}.toml", text)
    return len(batch)


def settle(batch: Sequence[tuple[int, Wanted]], *, seed: int, num_samples: int | None = None) -> list[Settled]:
    """The rigs of these places, drawn again until their effects are as strong as wanted."""
    settled: dict[int, Settled] = {}
    redrawn: dict[int, list[str]] = {index: [] for index, _ in batch}
    wanted_of = dict(batch)
    while len(settled) < len(batch):
        rigs = {
            i: _rig(i, wanted, seed=seed, tries=len(redrawn[i]), num_samples=num_samples)
            for i, wanted in batch
            if i not in settled
        }
        for i, (rig, strengths) in tuned(rigs).items():
            if rig.kind not in LACKING or _are_met(strengths, wanted_of[i]):
                settled[i] = Settled(i, rig, strengths, redrawn[i])
            else:
                redrawn[i].append(rig.effect)
    return [settled[i] for i, _ in batch]


def _are_met(strengths: Sequence[Strength], wanted: Wanted) -> bool:
    """Whether the effects are as strong as was asked for. One at its physical limit counts where the limit lies within
    its range."""
    least = (wanted.strengths[0], wanted.second[0])
    return all(s.met or (s.limited and s.gap_noise >= low) for s, low in zip(strengths, least, strict=False))


def name_of(index: int) -> str:
    """The case at a place of the series."""
    return f"case-{index + 1:03d}"


def description(rig: Rig) -> str:
    """What a dataset says of itself."""
    return f"{rig.system.title}, recorded at {round(1.0 / rig.sample_time)} Hz; BSD-3-Clause."


def _rig(index: int, wanted: Wanted, *, seed: int, tries: int, num_samples: int | None) -> Rig:
    system = SYSTEMS[wanted.system]
    effect = wanted.effect
    effects = unknown.named(system.causes) if wanted.kind == "unknown" else system.effects
    if effect and tries >= wanted.tries:  # out of its reach on any of these rigs: another effect takes the place
        effect = effects[(effects.index(effect) + tries // wanted.tries) % len(effects)]
    rig = draw_rig(
        np.random.default_rng([seed, index + 1, tries]),
        effect=effect,
        kind=wanted.kind,
        system=system,
        excitation=wanted.excitation,
        num_samples=num_samples,
        has_repeats=wanted.has_repeats,
        strengths=wanted.strengths,
        is_other_form=wanted.is_other_form,
        met_within=wanted.met_within,
    )
    if not wanted.is_pair:
        return rig
    return paired(rig, np.random.default_rng([seed, index + 1, tries, 1]), strengths=wanted.second)
