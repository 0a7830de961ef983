"""Drawn cases as lanes of the simulator: parameters, run-to-run scatter, references, noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from . import unknown
from .description import Controller, Lanes, Scene
from .rig import Rig

Array = NDArray[np.float64]

RUN_TO_RUN = 0.008


def alike(rigs: Sequence[Rig]) -> list[list[int]]:
    """Places of the rigs that can be simulated together: of one system, sampled alike."""
    groups: dict[tuple[str, float], list[int]] = {}
    for i, rig in enumerate(rigs):
        groups.setdefault((rig.system.kind, rig.sample_time), []).append(i)
    return list(groups.values())


def lanes_of(
    rigs: Sequence[Rig], parameters: Sequence[dict[str, float]], *, is_noisy: Sequence[bool], with_effect: bool = True
) -> Lanes:
    """One lane for each rig and experiment, rig by rig; the payload is added, friction of the noisy ones scatters
    from run to run.
    """
    rows: list[dict[str, float]] = []
    for rig, values in zip(rigs, parameters, strict=True):
        for experiment in rig.experiments:
            rows.append({name: value + experiment.add.get(name, 0.0) for name, value in values.items()})
    names = sorted({name for row in rows for name in row})
    stacked = {name: np.array([row.get(name, 0.0) for row in rows]) for name in names}
    scale = [_scale(*case) for case in zip(rigs, parameters, is_noisy, strict=True)]
    form = np.concatenate([np.full(len(rig.experiments), rig.form if with_effect else 0) for rig in rigs])
    effects = tuple(rig.effect if with_effect else "" for rig in rigs for _ in rig.experiments)
    return Lanes(
        system=rigs[0].system, parameters=stacked, scale=np.concatenate(scale, axis=1), form=form, effect=effects
    )


def _scale(rig: Rig, values: Mapping[str, float], noisy: bool) -> Array:
    """Factor on the friction of every slot and run."""
    scale = _scatter(rig) if noisy else np.ones((len(rig.system.slots), len(rig.experiments)))
    if "warming" in values:
        starts = np.array([experiment.start for experiment in rig.experiments])
        scale = scale * unknown.warming(starts, share=values["warming"], time=values["warming_time"])
    return scale


def _scatter(rig: Rig) -> Array:
    draw = np.random.default_rng([rig.seed, 1, rig.recording])
    return np.asarray(1.0 + RUN_TO_RUN * draw.standard_normal((len(rig.system.slots), len(rig.experiments))))


def scene_of(rigs: Sequence[Rig], *, is_noisy: Sequence[bool]) -> Scene:
    """References, controllers and sensors of the lanes that `lanes_of` makes."""
    columns = [rig.motor_turns * e.reference for rig in rigs for e in rig.experiments]
    settle = rigs[0].num_settle
    reference = np.stack(columns, axis=1)
    reference = np.concatenate([np.repeat(reference[:1], settle, axis=0), reference])
    loop = {name: np.array([rig.loop[name] for rig in rigs for _ in rig.experiments]) for name in rigs[0].loop}
    others = {
        name: np.stack([e.others[name] for rig in rigs for e in rig.experiments], axis=1)
        for name in rigs[0].experiments[0].others
    }
    others = {name: np.concatenate([np.repeat(x[:1], settle, axis=0), x]) for name, x in others.items()}
    count = len(rigs[0].experiments)
    system, sample_time = rigs[0].system, rigs[0].sample_time
    quiet = np.zeros((len(system.outputs), reference.shape[0], count))
    noise, grid = None, None
    if any(is_noisy):
        noise = np.concatenate(
            [_noise(rig) if noisy else quiet for rig, noisy in zip(rigs, is_noisy, strict=True)], axis=2
        )
        grid = np.repeat(system.column("resolution")[:, None] * np.asarray(is_noisy, dtype=float), count, axis=1)
    return Scene(
        reference=reference,
        controller=Controller(**loop) if loop else None,
        sample_time=sample_time,
        num_settle=settle,
        noise=noise,
        resolution=grid,
        others=others,
    )


def _noise(rig: Rig) -> Array:
    """White and coloured reading noise, (outputs, num_samples, num_experiments)."""
    draw, system = np.random.default_rng([rig.seed, 2, rig.recording]), rig.system
    size = (len(system.outputs), rig.num_settle + rig.num_samples, len(rig.experiments))
    white = draw.standard_normal(size) * system.column("white")[:, None, None]
    shocks = draw.standard_normal(size)
    colour = system.colour(rig.sample_time)
    shocks[:, 0] /= np.sqrt(1.0 - colour**2)[:, None]  # starts stationary
    coloured = np.stack([lfilter([np.sqrt(1 - a * a)], [1.0, -a], shocks[i], axis=0) for i, a in enumerate(colour)])
    return np.asarray(rig.noise * (white + coloured * system.column("coloured")[:, None, None]))
