"""The noise floor: what repeats of an experiment do not repeat (docs/method.md).

Rounding to coarse steps may repeat, yet no model predicts it: no output's floor is below that of rounding.

Repeats are compared through the residuals of the same model. What a slightly different friction from run to run
explains is a random effect of its own; the rest is coloured noise, whitened by an autoregression. Without repeats
nothing tells noise from what the model lacks: then the level of the noise is a parameter of each model, at least that
of the sensors, and a sample counts as the memory of the best model's residuals leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from tendonlab import _core
from tendonlab.fitting.case import Case
from tendonlab.fitting.noise import FOLLOWING, RUN_TO_RUN, RUN_TO_RUN_UNKNOWN, Floor, num_following, rounding_of
from tendonlab.simulation.system import System

AR_ORDER = 6
NOTHING = 1e-6  # of rounding: readings that differ by less, but for a constant, repeat exactly
LEAST = 0.3  # of the sensors' noise: less than this repeats do not show, whatever was stated
DIFFERENT = 0.5  # of the rms command, by which those of repeats may differ; such of stable loops differ by 0.35 at most
ALIKE = 0.5  # share of what repeats differ by from fitted starts (mean square), below which believed ones count
LARGEST = 0.5  # plausible factor by which friction differs from run to run
RUN_TO_RUN_WEIGHT = 4.0  # repeats that the default sd of friction from run to run counts for


@dataclass(frozen=True)
class Sensitivities:
    """Of one experiment at one model: residual (outputs, samples), the run-to-run directions d y / d log friction
    (k, outputs, samples) and the initial state's (q, outputs, samples), the latter per sd of its prior."""

    residual: np.ndarray
    friction: np.ndarray
    initial: np.ndarray

    @classmethod
    def unknown(cls, measured: np.ndarray) -> Sensitivities:
        """Of an experiment that could not be simulated, `measured` (outputs, samples)."""
        nothing = np.zeros((0, *measured.shape))
        return cls(np.full_like(measured, np.nan), nothing, nothing)

    @property
    def is_known(self) -> bool:
        """Whether the experiment could be simulated and was measured."""
        return bool(np.isfinite(self.residual).any())


def friction_groups(system: System, *, with_added: bool = False) -> list[list[int]]:
    """Indices of the friction parameters of each element that has friction: they scale together from run to run. A
    finite lower bound below 0, such as that of an asymmetry of the level, marks a share of friction that scales.
    `with_added`: also those of the friction effects that the system lacks, which a candidate may add."""
    info = system.info
    groups = []
    for element in dict.fromkeys(port.element for port in info.ports):
        able = [
            i
            for i, p in enumerate(info.parameters)
            if p.element == element and p.amplitude and p.purpose != "share"
            and p.dimension in ("effort", "damping", "ratio") and not -np.inf < p.lower < 0.0
        ]  # fmt: skip
        present = [i for i in able if _is_present(system, i)]
        if present:
            groups.append(able if with_added else present)
    return groups


def _is_present(system: System, i: int) -> bool:
    """Whether an effect of the system has this parameter, and not 0."""
    p = system.info.parameters[i]
    return f"{p.element}:{p.effect}" in system.effects and system.parameters.get(p.name, 0.0) != 0.0


def sensitivities(case: Case, system: System, i: int, own: Sequence[float]) -> Sensitivities:
    """Residual and directions of experiment i at `system`, with its own unknowns."""
    groups, ready = friction_groups(system), case.prepared[i]
    seeds = [("parameter", k) for group in groups for k in group] + list(ready.initial)
    run = case.run(i, system, own, seeds=seeds)
    gradient = run.get("gradient", np.zeros((0, *ready.measured.shape)))
    values, _ = case.at(i, system, own)
    rows, directions = 0, []
    for group in groups:
        directions.append(sum(values[k] * gradient[rows + j] for j, k in enumerate(group)))
        rows += len(group)
    sd = np.asarray(ready.initial_sd).reshape(-1, 1, 1)
    friction = np.array(directions) if directions else np.zeros((0, *ready.measured.shape))
    return Sensitivities(
        run["outputs"] - ready.measured, friction, gradient[rows:] * sd if len(sd) else gradient[rows:]
    )


def estimate(case: Case, seen: Sequence[Sensitivities], fitted: Sequence[int]) -> Floor:
    """The floor from repeats; where nothing repeats, from the residuals of the experiments `fitted` themselves."""
    repeats = [g for g in _groups(case, seen) if _do_repeat(case, g)]
    return _from_repeats(case, seen, repeats) if repeats else _without_repeats(case, seen, fitted)


def _do_repeat(case: Case, group: Sequence[int]) -> bool:
    """Whether these experiments share samples enough to compare and, where logged commands drive the simulator, the
    commands: those of a loop in a limit cycle do not repeat."""
    kept = _shared([case.experiments[i].time for i in group])
    if len(group) < 2 or len(kept[0]) <= AR_ORDER:
        return False
    if case.replay.kind == "controller" or not case.system.info.commanded:
        return True
    name = case.system.info.inputs[0].name
    rows = [case.experiments[i].data.get(name) for i in group]
    if any(row is None for row in rows):
        return True
    commands = np.array([np.asarray(row, dtype=float)[at] for row, at in zip(rows, kept, strict=True)])
    differ = np.sqrt(np.nanmean(np.square(commands - np.nanmean(commands, axis=0))))
    return bool(differ <= DIFFERENT * np.sqrt(np.nanmean(np.square(commands))))


def _from_repeats(case: Case, seen: Sequence[Sensitivities], repeats: Sequence[Sequence[int]]) -> Floor:
    members = [i for g in repeats for i in g]
    seen, differences = list(seen), []
    for g in repeats:
        for i, own in zip(g, _alike(case, seen, g), strict=True):
            seen[i] = own
        differences += _differences([seen[i].residual for i in g])
    pairs = [_clean(case, d, seen[i]) for i, d in zip(members, differences, strict=True)]
    ar: list[list[float]] = [[] for _ in case.noise]
    rms, sd = np.full(len(ar), np.nan), [0.0 for _ in ar]
    for c in case.measured:
        cleaned = [d[c] for d, _ in pairs if np.isfinite(d[c]).any()]
        if not cleaned:  # the repeats do not measure this output
            rms[c] = sd[c] = _assumed(case, seen, c)
            continue
        ar[c], innovation = _autoregression(cleaned)
        rounding = rounding_of(case.dataset.signals[case.outputs[c]])
        shown = _rms([record - np.nanmean(record) for record in cleaned])
        least, differs = LEAST * float(case.noise[c]), shown > NOTHING * rounding
        sd[c] = max(innovation * max(1.0, rounding / shown) if differs else rounding, least)
        rms[c] = max(_rms([d[c] for d in differences]), rounding, least)
    tau = _run_to_run([coefficients for _, coefficients in pairs])
    return Floor(rms, ar, sd, tau, repeated=True, differences=len(members) - len(repeats))


def with_steady_starts(
    case: Case, seen: Sequence[Sensitivities], believed: Mapping[int, Sensitivities]
) -> list[Sensitivities]:
    """What was `seen`; of repeats that differ by clearly less from the initial states that are `believed` of them, what
    was seen there. A model that lacks much may start each repeat from another place to make up for that."""
    chosen = list(seen)
    for g in _groups(case, seen):
        if len(g) > 1 and all(i in believed and believed[i].is_known for i in g):
            there = [believed.get(i, own) for i, own in enumerate(seen)]
            fitted, steady = (_spread(case, _alike(case, of, g)) for of in (seen, there))
            if steady < ALIKE * fitted:
                for i in g:
                    chosen[i] = believed[i]
    return chosen


def _groups(case: Case, seen: Sequence[Sensitivities]) -> list[list[int]]:
    """The experiments of each label that several may share, of those that could be simulated."""
    groups: dict[str, list[int]] = {}
    for i, experiment in enumerate(case.experiments):
        if experiment.repeat is not None and seen[i].is_known:
            groups.setdefault(experiment.repeat, []).append(i)
    return list(groups.values())


def _alike(case: Case, seen: Sequence[Sensitivities], group: Sequence[int]) -> list[Sensitivities]:
    """What was seen of each repeat of a group at the instants that all of them have."""
    shared = _shared([case.experiments[i].time for i in group])
    return [
        Sensitivities(seen[i].residual[:, kept], seen[i].friction[:, :, kept], seen[i].initial[:, :, kept])
        for i, kept in zip(group, shared, strict=True)
    ]


def _differences(residuals: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Of each repeat to the mean of all, with the variance of one."""
    scale = np.sqrt(len(residuals) / (len(residuals) - 1))
    return [scale * (row - np.mean(residuals, axis=0)) for row in residuals]


def _spread(case: Case, seen: Sequence[Sensitivities]) -> float:
    """Mean square by which repeats differ, in units of the sensors' noise."""
    rows = np.concatenate(_differences([own.residual for own in seen]), axis=1)
    return float(np.nanmean(np.square(rows[case.measured] / case.noise[case.measured, None])))


def _shared(times: Sequence[np.ndarray]) -> list[np.ndarray]:
    """For each record the samples at the instants, counted from its first one, that all records have to half a step."""
    at = min((t - t[0] for t in times), key=len)
    half = 0.5 * float(np.median(np.diff(at)))
    picked, common = [], np.ones(len(at), dtype=bool)
    for t in times:
        own = t - t[0]
        after = np.clip(np.searchsorted(own, at), 1, len(own) - 1)
        nearest = after - (at - own[after - 1] < own[after] - at)
        common &= np.abs(own[nearest] - at) <= half
        picked.append(nearest)
    return [nearest[common] for nearest in picked]


def _without_repeats(case: Case, seen: Sequence[Sensitivities], fitted: Sequence[int]) -> Floor:
    rms, sd = np.full(len(case.noise), np.nan), np.zeros(len(case.noise))
    for c in case.measured:
        rms[c] = _assumed(case, seen, c)
        sd[c] = max(_rms([seen[i].residual[c] for i in fitted]), float(case.noise[c]))
    known = tuple(float(s) if np.isfinite(s) else 0.0 for s in case.noise)
    return Floor(rms, [[] for _ in sd], sd.tolist(), RUN_TO_RUN, repeated=False, known=known)


def remaining(case: Case, seen: Sequence[Sensitivities]) -> Floor:
    """Where nothing repeats: the noise, with its memory, that a model leaves of experiments. What the model lacks
    counts as noise too."""
    cleaned = [_clean(case, own.residual, own)[0] for own in seen]
    ar: list[list[float]] = [[] for _ in case.noise]
    rms, sd = np.array(case.noise, dtype=float), [0.0 for _ in ar]
    for c in case.measured:
        records = [d[c] for d in cleaned if np.isfinite(d[c]).any()]
        sd[c] = float(case.noise[c])
        if records and (left := _rms([record - np.nanmean(record) for record in records])) > 0.0:
            rms[c] = left
            ar[c], sd[c] = _autoregression(records)
    return Floor(rms, ar, sd, RUN_TO_RUN, repeated=False)


def whitenings(case: Case, floor: Floor, seen: Sequence[Sensitivities] = ()) -> list[_core.Whitening]:
    """Whitening of every experiment by the autoregression. Run-to-run friction is an unknown of its own in a fit; of an
    experiment that nothing is fitted to, it is a random effect along what was `seen`."""
    made = [floor.whitening(ready.measured) for ready in case.prepared]
    for i in case.test if seen else ():
        if len(seen[i].friction):
            directions = made[i].apply_many(seen[i].friction)
            made[i] = floor.whitening(case.prepared[i].measured, directions, [floor.tau] * directions.shape[1])
    return made


def _clean(case: Case, difference: np.ndarray, s: Sensitivities) -> tuple[np.ndarray, np.ndarray]:
    """A difference without what friction from run to run and the initial state explain, and friction's coefficients.
    These are believed to lie below `LARGEST`: friction that moves nothing explains nothing, by however large a factor.
    """
    kept = case.measured
    weight = case.noise[kept][:, None]
    y = (difference[kept] / weight).ravel()
    basis = np.concatenate([s.friction[:, kept], s.initial[:, kept]]) / weight
    columns = basis.reshape(len(basis), y.size).T
    there = np.isfinite(y)
    believed = np.eye(len(basis))[: len(s.friction)] / LARGEST
    rows, right = np.vstack([columns[there], believed]), np.concatenate([y[there], np.zeros(len(believed))])
    found = np.linalg.lstsq(rows, right, rcond=None)[0] if columns.shape[1] else np.zeros(0)
    cleaned = difference.copy()
    cleaned[kept] -= np.tensordot(found, np.concatenate([s.friction, s.initial])[:, kept], axes=1)
    return cleaned, found[: len(s.friction)]


def _run_to_run(coefficients: list[np.ndarray]) -> float:
    """Relative sd of friction from run to run, shrunk to the default; at most what is plausible: runs that do not
    repeat at all, as in a limit cycle, differ by more than friction."""
    squares = np.concatenate([np.square(c) for c in coefficients]) if coefficients else np.zeros(0)
    total = RUN_TO_RUN_WEIGHT * RUN_TO_RUN**2 + float(np.sum(squares))
    return min(float(np.sqrt(total / (RUN_TO_RUN_WEIGHT + len(squares)))), LARGEST)


def _autoregression(records: list[np.ndarray]) -> tuple[list[float], float]:
    """Yule–Walker over several records: always stable. Nothing is left of zeros. White where too few samples follow on
    others, as where a sensor is read at every second stamp only, and where gaps leave no stable process."""
    from scipy.linalg import eigvalsh, solve_toeplitz, toeplitz

    lags, pairs, complete = np.zeros((3, AR_ORDER + 1))
    rows = 0
    for record in records:
        there = np.isfinite(record)
        x = np.where(there, record - np.nanmean(record), 0.0)
        lags += [float(x[k:] @ x[: len(x) - k]) for k in range(AR_ORDER + 1)]
        pairs += [np.count_nonzero(there[k:] & there[: len(x) - k]) for k in range(AR_ORDER + 1)]
        complete += [len(x) - k for k in range(AR_ORDER + 1)]
        rows += num_following(there, AR_ORDER)
    if not lags[0] > 0.0:
        return [], 0.0
    lags *= complete / (complete[0] * np.maximum(pairs, 1.0))
    lags[0] *= 1 + 1e-9
    if rows < FOLLOWING * pairs[0] or eigvalsh(toeplitz(lags)).min() <= 0.0:
        return [], float(np.sqrt(lags[0]))
    a = np.asarray(solve_toeplitz(lags[:-1], lags[1:]))
    return a.tolist(), float(np.sqrt(max(lags[0] - a @ lags[1:], 1e-300)))


def _assumed(case: Case, seen: Sequence[Sensitivities], c: int) -> float:
    """The plain floor of output c in what models are judged by, where nothing repeats: sensor noise and an assumed
    run-to-run friction. A training experiment that a little friction moves far says nothing about others."""
    judged = [seen[i] for i in case.test or range(len(seen))]
    moved = [np.sum(np.square(RUN_TO_RUN_UNKNOWN * s.friction[:, c]), axis=0) for s in judged if len(s.friction)]
    return float(np.sqrt(case.noise[c] ** 2 + (np.mean(np.concatenate(moved)) if moved else 0.0)))


def _rms(records: list[np.ndarray]) -> float:
    x = np.concatenate(records)
    return float(np.sqrt(np.nanmean(np.square(x))))
