"""Draw blind cases: dataset folders under OUT/cases, their truth in a folder of its own."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from tqdm import tqdm

from .rig import EFFECTS, NUM_SAMPLES, Rig, draw_rig
from .strength import Strength, tune
from .write import FINE_STEP, record, sealed_toml, write_dataset

BATCH = 20  # cases simulated together
MAX_TRIES = 3  # of one effect, before another takes its place
DESCRIPTION = "Synthetic two-inertia cable rig under a sampled position loop, recorded at 500 Hz; BSD-3-Clause."


def draw(
    seed: int,
    count: int,
    out: Path | str,
    *,
    sealed: Path | str | None = None,
    jobs: int = 2,
    num_samples: int = NUM_SAMPLES,
    step: float = FINE_STEP,
    progress: bool = True,
) -> Path:
    """Draw `count` cases into `out`/cases and return `out`; about 70 % lack one effect, 15 % nothing, 15 % have wrong
    parameters only.

    The truth goes into the folder `sealed`, without it into `out`/sealed, from where it must be moved before `run`.
    The same seed gives the same cases whatever `jobs`. Raises ValueError if count < 1, FileExistsError if one of the
    two folders exists.
    """
    cases, sealed = Path(out) / "cases", Path(out) / "sealed" if sealed is None else Path(sealed)
    if count < 1:
        raise ValueError(f"count = {count}: expected at least 1")
    for folder in (cases, sealed):
        if folder.exists():
            raise FileExistsError(f"{folder} exists: expected a new folder to draw into")
    for folder in (cases, sealed):
        folder.mkdir(parents=True)
    kinds = plan(seed, count)
    batches = [list(enumerate(kinds))[i : i + BATCH] for i in range(0, count, BATCH)]
    work = partial(_draw_batch, seed=seed, cases=cases, sealed=sealed, num_samples=num_samples, step=step)
    with tqdm(total=count, desc="draw", unit="case", disable=not progress) as bar:
        if jobs <= 1:
            for batch in batches:
                bar.update(work(batch))
        else:
            with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
                for done in pool.map(work, batches):
                    bar.update(done)
    return Path(out)


def plan(seed: int, count: int) -> list[tuple[str, str]]:
    """(kind, effect) of every case, shuffled; effects go round in turn, so that all appear once `count` allows it."""
    draw = np.random.default_rng([seed, 0])
    singles = max(1, round(0.7 * count))
    none = round(0.15 * count)
    order: list[str] = []
    while len(order) < singles:
        order += [EFFECTS[i] for i in draw.permutation(len(EFFECTS))]
    kinds = [("effect", effect) for effect in order[:singles]] + [("none", "")] * none
    kinds += [("parameters_only", "")] * (count - len(kinds))
    return [kinds[i] for i in draw.permutation(count)]


def _draw_batch(
    batch: Sequence[tuple[int, tuple[str, str]]], *, seed: int, cases: Path, sealed: Path, num_samples: int, step: float
) -> int:
    settled: dict[int, tuple[Rig, Strength]] = {}
    redrawn: dict[int, list[str]] = {index: [] for index, _ in batch}
    wanted = dict(batch)
    while wanted:
        rigs = {
            i: _rig(i, kind, seed=seed, tries=len(redrawn[i]), num_samples=num_samples) for i, kind in wanted.items()
        }
        for (i, rig), strength in zip(rigs.items(), tune(list(rigs.values())), strict=True):
            if rig.kind != "effect" or strength.met or (strength.limited and strength.gap_noise >= 1.0):
                settled[i] = (rig, strength)
                del wanted[i]
            else:
                redrawn[i].append(rig.effect)
    for i, run in zip(settled, record(*_columns(settled), step=step), strict=True):
        name = f"case-{i + 1:03d}"
        rig, strength = settled[i]
        write_dataset(rig, run, cases / name, name=name, description=DESCRIPTION)
        (sealed / f"{name}.toml").write_text(sealed_toml(rig, strength, redrawn=redrawn[i]), encoding="utf-8")
    return len(batch)


def _columns(settled: dict[int, tuple[Rig, Strength]]) -> tuple[list[Rig], list[Strength]]:
    return [rig for rig, _ in settled.values()], [strength for _, strength in settled.values()]


def _rig(index: int, kind: tuple[str, str], *, seed: int, tries: int, num_samples: int) -> Rig:
    name, effect = kind
    if effect and tries >= MAX_TRIES:  # out of its reach on any of these rigs: another effect takes the place
        effect = EFFECTS[(EFFECTS.index(effect) + tries // MAX_TRIES) % len(EFFECTS)]
    return draw_rig(np.random.default_rng([seed, index + 1, tries]), effect=effect, kind=name, num_samples=num_samples)
