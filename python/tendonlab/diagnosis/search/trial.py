"""A refitted candidate, what it gained, and the bar that its gains must pass."""

from __future__ import annotations

from collections.abc import Sequence, Set
from dataclasses import dataclass

import numpy as np

from tendonlab.diagnosis.beliefs import strain
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import NEAR_FLOOR
from tendonlab.fitting.problem import Fitter
from tendonlab.simulation.catalog import LEVEL, SIGNAL, SystemInfo

STEADY, LOSSES = 2.0, 5.0
MOST = 1e9  # nats: beyond, a gain says no more
FURTHER_EVIDENCE, FURTHER_LEFT_OUT, FURTHER_SHARE = 30.0, 9.0, 0.01
SAME_LAW = 0.1  # the same share of a law that the model has elsewhere: errors of its shape gained up to 0.07
TWIN = 3.0  # nats within which two effects say the same of these data
SHARE, ALONE_SHARE = 0.5, 0.35  # of the rest that an effect must remove
LITTLE = 0.1  # of the rest, far above the floor: of right further effects none removed less than 0.14
UNBELIEVED, BELIEVED = 7.0, 4.0  # stated sd by which a model pulls a parameter too far, and by which it well may
HIDDEN = 100.0  # nats by which a weak effect must show behind another one: errors of shapes gained 84


@dataclass(frozen=True)
class Trial:
    """One refitted candidate against the model it extends: gains in nats, `doubt` that of the left-out gain, `lost`
    what experiments that are predicted worse lose, as a share of what the others gain; `is_nothing`: whether the effect
    may be 0 by its own interval although it gains; `has_shape`: whether its law may have another form on the rig, as
    friction has and a bias or a delay has not; `acts`: the element of its law, how that combines with others, and what
    it reads."""

    effect: str
    fitted: Fitted
    evidence_gain: float
    left_out_gain: float
    doubt: float
    lost: float = 0.0
    is_nothing: bool = False
    has_shape: bool = True
    acts: tuple[str, int, int] | None = None

    @classmethod
    def of(cls, effect: str, fitted: Fitted, base: Fitted) -> Trial:
        """What `fitted`, which has `effect`, gains over `base`, which has not; rows count as in `fitted`. Beliefs that
        suit it better count as one more experiment."""
        base = base.counted(fitted.shares)
        with np.errstate(invalid="ignore"):  # infinity less infinity
            gains = fitted.by_experiment(_bounded(fitted.left_out - base.left_out))
            evidence = float(_bounded(np.subtract(fitted.evidence, base.evidence)))
        relieved = relief(base, fitted)
        gains = np.append(gains, relieved) if relieved > 0.0 else gains
        lost = float(-np.minimum(gains, 0.0).sum() / max(np.maximum(gains, 0.0).sum(), 1.0 / MOST))
        nothing = evidence > DETECT.evidence and is_nothing(effect, fitted)
        left_out, info = float(np.sum(gains)), fitted.system.info
        law, shape = info.effect(effect), has_shape(effect, info)
        acts = (law.element, law.roles, law.sees)
        return cls(effect, fitted, evidence, left_out, doubt(gains), lost, nothing, shape, acts)

    @property
    def num_parameters(self) -> int:
        """Parameters of the effect."""
        return len(self.fitted.system.info.effect(self.effect).parameters)


def has_shape(effect: str, info: SystemInfo) -> bool:
    """Whether the law of an effect may have another form on the rig. Those that act on a command, a load or a reading
    have none; a gate or presliding that acts on what a sheath passes on has one."""
    law = info.effect(effect)
    return not law.roles & SIGNAL or law.element in {port.element for port in info.ports}


def is_constant(effect: str, info: SystemInfo) -> bool:
    """Whether an effect adds a constant of either sign to a command, a load or a reading."""
    rows = [info.parameter(name) for name in info.effect(effect).parameters]
    return not has_shape(effect, info) and all(p.lower == -np.inf and p.dimension != "ratio" for p in rows)


def is_nothing(effect: str, fitted: Fitted) -> bool:
    """Whether every amplitude of the effect may be 0 by its own interval. What it gains is then no trace of the effect,
    but of outputs that jump with the least of it, as where a gate opens one sample earlier."""
    info = fitted.system.info
    own = set(info.effect(effect).parameters) & {f.name for f in fitted.free}
    intervals = [fitted.value(name)[1] for name in own if info.parameter(name).purpose == "amplitude"]
    return bool(intervals) and all(lower <= 0.0 <= upper for lower, upper in intervals)


def relief(base: Fitted, extended: Fitted) -> float:
    """Nats by which what is believed of the parameters of `base` suits the `extended` model better."""

    def disbelief(model: Fitted) -> float:
        values = dict(zip((f.name for f in model.free), model.x, strict=True))
        return 0.5 * float(sum(((values[f.name] - f.mean) / f.sd) ** 2 for f in base.free if f.name in values))

    return disbelief(base) - disbelief(extended)


def restores_belief(case: Case, base: Fitted, extended: Fitted) -> bool:
    """Whether the extended model frees the parameters of `base` from what nobody believes of them: by many nats, or by
    enough of them where no one parameter is believed to be so far from what was stated, and all are with it."""
    gained = relief(base, extended)
    if gained > CLEAR.evidence:
        return True
    return gained > DETECT.evidence and strain(case, base) > UNBELIEVED and strain(case, extended) < BELIEVED


def _bounded(gains: np.ndarray | float) -> np.ndarray:
    """Gains over a model whose derivatives exploded, which has no evidence, are large but finite; of one such model
    over another they are none."""
    return np.asarray(np.clip(np.nan_to_num(gains, nan=0.0), -MOST, MOST))


def doubt(gains: np.ndarray) -> float:
    """By how much the sum of gains of single experiments may deceive: two standard errors, at most `LOSSES` times what
    experiments lose. A right effect that one run alone shows costs the others nothing."""
    if len(gains) < 2:
        return float("inf")
    errors = STEADY * float(np.std(gains, ddof=1) * np.sqrt(len(gains)))
    return min(errors, LOSSES * float(-np.minimum(gains, 0.0).sum()))


def counted_alike(trials: Sequence[Trial], base: Fitted) -> list[Trial]:
    """The trials, best first, with the rows of all counted as the residuals of the best model leave."""
    if not trials:
        return []
    shares = max(trials, key=lambda t: t.fitted.counted().evidence).fitted.shares
    alike = [Trial.of(t.effect, t.fitted.counted(shares), base) for t in trials]
    return sorted(alike, key=lambda trial: -trial.evidence_gain)


def plainest_first(trials: Sequence[Trial], established: Set[str]) -> list[Trial]:
    """The trials, best first. The first one gives way to the best of those with fewer parameters that predict left-out
    experiments as well within its doubt: an offset, for friction that differs by direction in a single run."""
    first = trials[0]
    for plain in trials[1:]:
        if plain.effect not in established or plain.num_parameters >= first.num_parameters:
            continue
        gains = first.fitted.by_experiment(first.fitted.left_out - plain.fitted.left_out)
        if np.sum(gains) <= doubt(gains) < np.inf:
            return [plain, *(t for t in trials if t is not plain)]
    return list(trials)


@dataclass(frozen=True)
class Bar:
    """What an effect must gain to be established: evidence, and log score of left-out experiments; `doubted`: the
    latter beyond its doubt."""

    evidence: float
    left_out: float
    doubted: bool

    def passed(self, trial: Trial) -> bool:
        """Whether the trial establishes its effect."""
        left_out = max(self.left_out, trial.doubt if self.doubted else 0.0)
        return trial.evidence_gain > self.evidence and trial.left_out_gain > left_out


DETECT = Bar(evidence=10.0, left_out=3.0, doubted=False)
CLEAR = Bar(evidence=30.0, left_out=30.0, doubted=False)  # what it must gain near the floor


def bar_for_further_effect(fitter: Fitter) -> Bar:
    """The bar for an effect beyond the first, which may only imitate what is wrong with the shape of the first. Without
    repeats the noise of each model already contains the error of its shape."""
    if not fitter.floor.repeated:
        return Bar(DETECT.evidence, DETECT.left_out, doubted=True)
    return Bar(FURTHER_EVIDENCE, FURTHER_LEFT_OUT, doubted=True)


def explains_enough(base: Fitted, trials: Sequence[Trial]) -> bool:
    """Whether the first trial removes half of what the base leaves above the known noise; 35 % where no other gains
    half as much. The error of a shape looks like one more effect, which removes less."""
    rest, left = base.mean_square - 1.0, trials[0].fitted.mean_square - 1.0
    most = trials[0].evidence_gain
    alone = all(t.evidence_gain < 0.5 * most or most - t.evidence_gain < TWIN for t in trials[1:])
    return rest > 0.0 and left < rest * (1.0 - (ALONE_SHARE if alone else SHARE))


def explains_half(base: Fitted, extended: Fitted) -> bool:
    """Whether the `extended` model removes half of what the base leaves above the known noise."""
    return extended.mean_square - 1.0 < (1.0 - SHARE) * (base.mean_square - 1.0)


def gain_elsewhere(base: Fitted, trial: Trial, *, heard: str | None) -> float:
    """Nats that the trial gains on outputs that no effect of `base` touches: the shape of a sensor's error shows in
    that sensor alone, unless the loop hears it (`heard`: the output that it does). 0 where other effects were added."""
    own = {name.split(":")[0].removeprefix("sensor.") for name in base.added if name.startswith("sensor.")}
    if not base.added or len(own) < len({name.split(":")[0] for name in base.added}) or heard in own:
        return 0.0
    outputs = [output.name for output in base.system.info.outputs]
    share = np.array([0.0 if name in own else count for name, count in zip(outputs, base.shares, strict=True)])
    pairs = zip(base.runs, trial.fitted.runs, strict=True)
    return 0.5 * float(sum(share[a.output] @ (a.residual**2 - b.residual**2) for a, b in pairs))


def is_no_shape(base: Fitted, trials: Sequence[Trial], largest_gain: float, *, elsewhere: float = 0.0) -> bool:
    """Whether, where repeats say what is noise, the first trial is more than the error of the shape of an effect that
    was added before: by its share of the `largest_gain` of those and of what is left, or because it tells clearly and
    leaves little, or tells clearly `elsewhere`, where none of those acts. Friction that falls with speed otherwise than
    the library's makes Stribeck friction of the joint of that of the motor: a law that the model has elsewhere needs a
    larger share."""
    gain = trials[0].evidence_gain
    matters = base.mean_square <= NEAR_FLOOR or not removes_little(base, trials[0])
    if is_friction_elsewhere(base, trials[0]):
        return gain > SAME_LAW * largest_gain and matters
    if matters and (gain > FURTHER_SHARE * largest_gain or elsewhere > HIDDEN):
        return True
    return gain > HIDDEN and explains_enough(base, trials)


def is_friction_elsewhere(base: Fitted, trial: Trial) -> bool:
    """Whether the model has the law of the trial's effect in another element already, where its shape could err."""
    law = trial.effect.split(":")[-1]
    there = any(name.split(":")[-1] == law for name in base.added)
    return there and trial.has_shape


def is_friction_beside(base: Fitted, trial: Trial) -> bool:
    """Whether the law of the trial's effect joins another that was added to the same element: the shape of the one may
    err, and look like the other."""
    element = trial.effect.split(":")[0]
    return trial.has_shape and any(name.split(":")[0] == element for name in base.added)


def is_level_beside(base: Fitted, trial: Trial) -> bool:
    """The same where the law adds to the level of friction. Friction of another form than the library's looks like two
    levels: 11 times of 13 where nothing repeats, and removes 0.54 of the rest at most."""
    return is_friction_beside(base, trial) and bool(trial.fitted.system.info.effect(trial.effect).roles & LEVEL)


def removes_little(base: Fitted, trial: Trial) -> bool:
    """Whether the trial removes less than a tenth of what the base leaves above the known noise."""
    return base.mean_square - trial.fitted.mean_square < LITTLE * (base.mean_square - 1.0)
