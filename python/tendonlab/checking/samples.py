"""What the samples show without a simulator: stamps, outliers, limits, steps, channels that stand still."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.checking.held import held_findings
from tendonlab.checking.spikes import Marks, marks
from tendonlab.data import Dataset, Experiment
from tendonlab.report.numbers import counted, number, unit_text
from tendonlab.simulation.reading import common_step, rounding_step, white_noise_sd

GAP = 1.5  # median steps between two stamps that make a gap
JITTER, DRIFT = 0.02, 0.01  # relative: scatter of steps, and change of their median from the first to the last quarter
FEWEST = 16  # samples of an experiment: fewer show no motion
LEAST_STEPS = 8  # of a record whose stamps are judged
EFFORTS = ("command", "effort", "voltage", "force")  # dimensions that saturate
MOTIONS = ("displacement", "angle", "flow", "speed")  # dimensions whose sensors do
PLATEAU, LEAST_RUN = 0.01, 5  # share of samples at an extreme, and samples in a row, that make a limit
SLOWED = 0.25  # of its usual change: a signal that changes less beside its stays eases into them
CLIPPED = "; if the sensor clips there, leave these samples empty: no simulator follows them"
COARSE = 4.0  # times its noise that a step of a reading must be to matter
FINE = 1000.0  # steps within the travel: finer readings need no word


def sample_findings(dataset: Dataset, marked: Marks | None = None) -> list[Finding]:
    """Findings about single channels, for every experiment. `marked`: their outliers where these are known already."""
    steady = dataset.system().info.steady
    if marked is None:
        marked = {} if steady else marks(dataset)
    found: list[Finding] = []
    for experiment in dataset.experiments:
        found += [] if steady else [*_stamps(experiment), *_spikes(dataset, experiment, marked)]
        found += _standing(dataset, experiment)
    found += [] if steady else [*_limits(dataset), *_jitter(dataset), *_steps(dataset), *held_findings(dataset)]
    return found


def _jitter(dataset: Dataset) -> Iterator[Finding]:
    """Experiments whose stamps scatter, all of them in one finding."""
    scatter = {e.name: _scatter(np.diff(e.time)) for e in dataset.experiments if len(e.data) > LEAST_STEPS}
    loud = {name: share for name, share in scatter.items() if share > JITTER}
    if loud:
        where = next(iter(loud)) if len(loud) == 1 else f"{len(loud)} of {len(dataset)} experiments"
        share = 100 * max(loud.values())
        text = f"the time steps differ by {share:.0f} % in {where}: right if the stamps are those of the samples"
        yield Finding(problem="sampling", experiment=next(iter(loud)) if len(loud) == 1 else None, detail=text)


def _scatter(steps: np.ndarray) -> float:
    """Robust relative sd of the steps of a clock."""
    usual = float(np.median(steps))
    return 1.4826 * float(np.median(np.abs(steps - usual))) / usual


def _stamps(experiment: Experiment) -> Iterator[Finding]:
    if (num := len(experiment.data)) < FEWEST:
        text = f"{experiment.name} has {num} samples, and a diagnosis takes at least {FEWEST}; leave it out"
        yield Finding(problem="sampling", experiment=experiment.name, detail=text, count=num, blocks=True)
    if experiment.num_repeated:
        text = f"{counted(experiment.num_repeated, 'sample')} left out, whose time stamp repeats the one before"
        yield _note("sampling", text, experiment, count=experiment.num_repeated)
    steps = np.diff(experiment.time)
    if len(steps) < LEAST_STEPS:
        return
    usual = float(np.median(steps))
    gaps = steps[steps > GAP * usual]
    if len(gaps):
        lost = int(np.sum(np.round(gaps / usual) - 1))
        text = f"{counted(len(gaps), 'gap')} in time, about {counted(lost, 'sample')} lost"
        longest = f"the longest lasts {number(float(gaps.max()))} s at a usual step of {number(usual)} s"
        yield _note("sampling", f"{text}; {longest}", experiment, count=lost)
    quarter = len(steps) // 4
    change = float(np.median(steps[-quarter:]) / np.median(steps[:quarter]) - 1.0)
    if abs(change) > max(DRIFT, _scatter(steps)):
        text = f"the step of the clock changes by {100 * change:+.1f} % from the first to the last quarter"
        yield _note("sampling", text, experiment)


def _spikes(dataset: Dataset, experiment: Experiment, marked: Marks) -> Iterator[Finding]:
    for name in experiment.data.columns:
        if (experiment.name, name) not in marked:
            continue
        count = int(marked[experiment.name, name].sum())
        if count:
            share = f"{counted(count, 'sample')} of {name} ({number(100 * count / len(experiment.data), 2)} %)"
            done = "interpolated values" if dataset.signals[name].role == "input" else "these left out"
            text = f"{share} far from the samples around; a diagnosis goes on with {done}"
            yield _note("outliers", text, experiment, name, count)


def _standing(dataset: Dataset, experiment: Experiment) -> Iterator[Finding]:
    for name in experiment.data.columns:
        values = experiment.data[name].to_numpy(dtype=float)
        kept = values[np.isfinite(values)]
        if dataset.signals[name].role == "output" and len(kept) > 1 and np.ptp(kept) == 0:
            reading = f"{number(float(kept[0]))} {unit_text(dataset.signals[name].si_unit)}".rstrip()
            dead = _why_dead(dataset, experiment, name)
            text = f"{name} never changes: it reads {reading}{dead}"
            yield replace(_note("constant", text, experiment, name), blocks=bool(dead))


def _why_dead(dataset: Dataset, experiment: Experiment, name: str) -> str:
    """What shows that an output which never changes is dead, and does not rest. A coarse sensor at rest reads one value
    as well; a noisy one never does."""
    others = [(e, e.data[name].dropna().to_numpy(dtype=float)) for e in dataset if name in e.data.columns]
    moving = [(e, row) for e, row in others if e is not experiment and len(row) > LEAST_STEPS and np.ptp(row) > 0]
    for e, _ in moving:
        if experiment.repeat is not None and e.repeat == experiment.repeat:
            return f", and moves in its repeat {e.name}; correct or leave out this experiment"
    if (
        moving
        and not any(rounding_step(row) for _, row in moving)
        and all(white_noise_sd(row) > 0 for _, row in moving)
    ):
        return ", without the noise that it has in the others; correct or leave out this experiment"
    return ""


def _limits(dataset: Dataset) -> Iterator[Finding]:
    """Signals that stay at an extreme. A motion may rest at its farthest: only an extreme that it shares with another
    experiment is a limit."""
    dimensions = {s.name: s.dimension for s in dataset.system().info.signals}
    for name in dataset.signals:
        if dimensions.get(name) not in (*EFFORTS, *MOTIONS):
            continue
        records = [(e, e.data[name].dropna().to_numpy(dtype=float)) for e in dataset if name in e.data.columns]
        found = [(experiment, _stays(values)) for experiment, values in records]
        often = Counter(edge for _, stays in found for edge in stays)
        least = 2 if dimensions[name] in MOTIONS else 1
        for experiment, stays in found:
            stays = {edge: at for edge, at in stays.items() if often[edge] >= least}
            if stays:
                unit = unit_text(dataset.signals[name].si_unit)
                shares = {number(edge): f"{100 * at.mean():.0f} % of the samples" for edge, at in stays.items()}
                places = " and ".join(f"at {edge} {unit} for {share}" for edge, share in shares.items())
                clips = CLIPPED if name in dataset.outputs else ""
                text = f"{name} stays {places}, as at a limit{clips}"
                yield _note("saturation", text, experiment, name, sum(int(at.sum()) for at in stays.values()))


def _stays(values: np.ndarray) -> dict[float, np.ndarray]:
    """The extremes at which a record stays, and which of its samples do; none of a record of few levels."""
    if len(np.unique(values)) < len(values) // 10:
        return {}
    stays = {float(edge): values == edge for edge in (values.max(), values.min())} if len(values) else {}
    stays = {edge: at for edge, at in stays.items() if at.mean() > PLATEAU and _longest(at) >= LEAST_RUN}
    return {edge: at for edge, at in stays.items() if _is_met_at_speed(values, at)}


def _steps(dataset: Dataset) -> Iterator[Finding]:
    for name, spec in dataset.signals.items():
        if spec.role != "output" or spec.resolution:
            continue
        records = [e.data[name].dropna().to_numpy(dtype=float) for e in dataset.experiments]
        records = [r for r in records if len(r)]
        if not (step := common_step(records)):
            continue
        travel = max(float(np.ptp(r)) for r in records)
        if step > max(COARSE * float(np.median([white_noise_sd(r) for r in records])), travel / FINE):
            size = f"{number(step)} {unit_text(spec.si_unit)}".rstrip()
            text = f"{name} changes in steps of {size}; state this as its `resolution`"
            yield Finding(problem="quantisation", signal=name, detail=text)


def _is_met_at_speed(values: np.ndarray, at: np.ndarray) -> bool:
    """Whether a signal still changes as usual next to its stays at an extreme. One that slows down before it rests, as
    a smooth step does, is at no limit."""
    moved = np.abs(values[LEAST_RUN:] - values[:-LEAST_RUN])  # over a few samples: readings may come in steps
    edges = np.diff(at.astype(int))
    before, after = np.flatnonzero(edges > 0) - LEAST_RUN, np.flatnonzero(edges < 0) + 1
    beside = moved[np.concatenate([before[before >= 0], after[after < len(moved)]])]
    usual = float(np.median(moved[moved > 0])) if moved.any() else 0.0
    return not len(beside) or float(np.median(beside)) > SLOWED * usual


def _note(
    problem: str, text: str, experiment: Experiment, signal: str | None = None, count: int | None = None
) -> Finding:
    return Finding(problem=problem, signal=signal, experiment=experiment.name, detail=text, count=count)


def _longest(marks: np.ndarray) -> int:
    """The most marked samples in a row."""
    ends = np.flatnonzero(np.diff(np.concatenate([[0], marks.astype(int), [0]])))
    return int(np.max(ends[1::2] - ends[::2], initial=0))
