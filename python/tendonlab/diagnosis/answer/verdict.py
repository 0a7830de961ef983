"""From the search to a verdict and to probabilities: tempered evidence, which a calibration maps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from tendonlab.diagnosis.answer.by_noise import NO_NOISE, ByNoise
from tendonlab.diagnosis.discrepancy import (
    BEYOND_SCATTER,
    BEYOND_SENSORS,
    FAR_SCATTERED,
    FAR_TRAINED,
    FOLLOWED,
    FOLLOWED_BESIDE,
    FOLLOWED_REPEATED,
    NO_PATTERNS,
    RINGS,
    Patterns,
)
from tendonlab.diagnosis.drift import RARE
from tendonlab.diagnosis.search.contest import Round
from tendonlab.fitting.noise import NEAR_FLOOR

LOWERED = 0.05  # share of the mean square that tuning must remove to have gained anything
NO_GAP = 1.15  # whitened mean square below which the nominal simulator is at the floor
FAR = 4.0  # mean square of held-out runs, over the floor, that is no noise: 130 rigs that lack nothing left 3.1 at most
FAR_REPEATED = (
    1.8  # the same where repeats tell the floor, over what training runs leave: 77 such rigs left 1.3 at most
)
EXPLAINED = 0.75  # share of the held-out excess that library effects must remove to be the whole answer
EXPLAINED_OF_ASSUMED = 0.6  # the same where the floor is assumed: slow noise of a sensor lies above it
EXPLAINED_FAR = 0.85  # the same where they leave twice `FAR`: right effects removed 0.884 and more there
WELL_KNOWN = 2.5  # by how much less that share scatters there
AT_FLOOR = 1.06  # whitened, of training experiments: below, EXPLAINED_OF_ASSUMED is enough; repeats tell not all
STRAINED = 8.0  # stated sd from which on tuning a parameter is not believed: 92 rigs that lack nothing needed 6 at most
STRAINED_BESIDE = 20.0  # the same beside effects: four of 154 were strained further, and wrong or but a part
STEEP = 5.0  # how fast strained beliefs turn the verdict
PARTLY = 0.2  # probability that an effect is there that repeats establish and that leaves something unknown: 6 of 27
LARGELY = 0.5  # the same where it removes `MOST` of the held-out excess: 5 of 8; or the floor is assumed: 12 of 25
MOST = 0.7
SOFT = 0.05  # by how much a condition is met or missed where its probability is 0.73 or 0.27
SAME_GROUP = 0.2  # of the probability of the selected effect, from which on another one cannot be told from it


@dataclass(frozen=True)
class Levels:
    """Mean squares in units of the noise floor, by which the verdict is reached.

    `nominal`: at the untouched simulator, whitened, or plain where nothing repeats. `tuned`: whitened, of the
    refitted simulator on the training experiments. `refitted`: plain, of the refitted simulator on held-out
    experiments, which decides where nothing repeats; where runs do, it must not be far. `predicted`: the same as
    the fit predicts it, not as its uncertainty allows; None where these are one. `explained`: share of the
    held-out excess that the selected effects remove, None where there is none. `left`: plain, of the simulator with
    them on held-out experiments; `whitened`: of it on the training experiments. `repeated`: whether the floor comes
    from repeats. `patterns`: in what the final model leaves of the training experiments. Where nothing repeats,
    `trained`: the mean square of that in units of what run-to-run friction may leave; and, where nothing was selected,
    `scattered`: by how much friction differs from run to run. `strained`: by how many stated standard deviations the
    fit pulled the parameter that it pulled farthest. `drifted`: the chance of a trend of friction over the session, 1
    where there is none that matters. `noise`: what noise alone leaves of held-out experiments. `drowned`: whether the
    floor of every output exceeds its motion. `relieved`: whether the selected effects free the parameters from what
    nobody believes of them."""

    nominal: float
    tuned: float
    refitted: float
    explained: float | None
    left: float
    repeated: bool
    whitened: float = np.inf
    trained: float = 1.0
    patterns: Patterns = NO_PATTERNS
    scattered: float = 0.0
    strained: float = 0.0
    drifted: float = 1.0
    predicted: float | None = None
    noise: ByNoise = NO_NOISE
    drowned: bool = False
    relieved: bool = False

    @property
    def far_room(self) -> float:
        """By how much held-out experiments keep clear of what is no noise: a stop, say, that no training run
        reaches."""
        most = FAR_REPEATED * self.noise.more * max(1.0, self.tuned) if self.repeated else FAR
        return most - self.refitted

    @property
    def is_far(self) -> bool:
        """Whether held-out experiments hold what is no noise."""
        return self.far_room < 0.0

    @property
    def is_by_beliefs(self) -> bool:
        """Whether beliefs speak for the selected effects, and held-out experiments hardly."""
        return self.relieved and (self.explained or 0.0) < EXPLAINED

    @property
    def beyond_sensors(self) -> float:
        """How far what tuning leaves exceeds what is noise where nothing repeats; from 1 on it is none. The friction of
        each run is fitted, so that sensors should leave the rest, and friction that differs hardly."""
        return 0.0 if self.repeated else min(self.tuned / BEYOND_SENSORS, self.trained / BEYOND_SCATTER)

    def most_followed(self, *, selected: bool) -> float:
        """Share of what the final model leaves that may follow the motion; beyond that something is missing. Where
        effects were `selected`, another form of them leaves such errors as well."""
        if not self.repeated:
            return FOLLOWED
        return FOLLOWED_BESIDE if selected else FOLLOWED_REPEATED


@dataclass(frozen=True)
class Verdict:
    """The verdict, the probability of each verdict, and those of effects and of sets of effects."""

    verdict: str
    probability: dict[str, float]
    effects: dict[str, float]
    sets: list[dict[str, Any]]
    indistinguishable: list[list[str]]

    @property
    def evidence(self) -> dict[str, dict[str, float]]:
        """What a calibration starts from: probabilities of verdicts and effects as they are."""
        return {"verdict": self.probability, "effects": self.effects}


def decide(rounds: Sequence[Round], selected: Sequence[str], levels: Levels) -> Verdict:
    """The verdict on the effects `selected` in these `rounds`, and its probabilities."""
    after = levels.tuned if levels.repeated else levels.refitted if levels.predicted is None else levels.predicted
    # What tuning gains, beyond what is too little to matter; nothing where nothing is left to gain.
    gained = (1.0 - after / levels.nominal if levels.nominal > 0 else 0.0) - LOWERED
    room = _room(levels)
    noise = _noise_room(levels, selected=bool(selected))
    is_far = levels.is_far or (levels.nominal > NO_GAP and noise < 0.0)
    is_missing = levels.drifted <= RARE or (levels.repeated and is_far)
    holds = levels.repeated or levels.trained < FAR_TRAINED  # a held-out motion may miss what training ones show
    at_floor = holds and not (is_missing or selected) and (levels.nominal < NO_GAP or gained < 0 < room)
    # By how much the selected effects are the whole answer: held-out experiments at the floor leave nothing unknown.
    whole = max(_whole(levels), NO_GAP * levels.noise.left - levels.left)
    if levels.relieved:  # what may be noise beside parameters that nobody believes may be so beside effects
        whole = max(whole, room)
    spare = min(noise, whole, _chance_room(levels), _belief_room(levels, STRAINED_BESIDE))
    none = float(np.prod([contest.probability[None] for contest in rounds[: max(1, len(selected))]]))
    weight = {
        "data_fault": 0.0,
        "no_gap": _step(SOFT if at_floor else NO_GAP - levels.nominal)
        * (none if selected else 1.0)
        * (_step(room) if is_missing else 1.0),
        "parameters_only": _step(levels.nominal - NO_GAP) * _step(gained) * none * _step(room),
        "effect": (1.0 - none) * (_step(spare) if selected else 0.1),
        "unknown_effect": (1.0 - none) * (_step(-spare) if selected else 0.5) + (0.0 if room > 0 else none),
    }
    if at_floor:
        verdict = "no_gap"
    elif not selected:
        verdict = "parameters_only" if room > 0 else "unknown_effect"
    else:
        verdict = "effect" if spare >= 0 else "unknown_effect"
    if at_floor and levels.drowned:  # such data speak for no verdict
        weight = {name: float(name != "data_fault") for name in weight}
    weight[verdict] = max(weight[verdict], 1.05 * max(weight.values()), 1e-9)
    total = sum(weight.values())
    is_whole = 1.0
    if selected:  # what explains a part only may imitate what is not known
        is_whole = weight["effect"] / (weight["effect"] + weight["unknown_effect"])
    partly = PARTLY if levels.repeated and (levels.explained or 0.0) < MOST else LARGELY
    effects, sets = marginals(rounds, there=is_whole + (1.0 - is_whole) * partly)
    groups = [group for contest in rounds if (group := _group(contest))]
    return Verdict(verdict, {k: v / total for k, v in weight.items()}, effects, sets, groups)


def _whole(levels: Levels) -> float:
    """By how much the selected effects remove enough of the held-out excess to be the whole answer. Far above the floor
    more is asked for, and that share is well known; from `FAR` to twice that, one passes into the other."""
    near = EXPLAINED if levels.repeated and levels.whitened > AT_FLOOR else EXPLAINED_OF_ASSUMED
    left = levels.left / levels.noise.left
    far = float(np.clip(np.log2(max(left, FAR) / FAR), 0.0, 1.0))
    enough = near + far * (EXPLAINED_FAR - near)
    return (1.0 + far * (WELL_KNOWN - 1.0)) * ((levels.explained or 0.0) - enough)


def _room(levels: Levels) -> float:
    """By how much an error may be noise; below 0 it is none."""
    noise = _noise_room(levels, selected=False)
    common = min(levels.far_room, noise, _chance_room(levels), _belief_room(levels, STRAINED))
    if levels.repeated:
        return min(NEAR_FLOOR - levels.tuned, common)
    return min(SOFT, FAR_SCATTERED - levels.scattered, 1.0 - levels.beyond_sensors, common)


def _belief_room(levels: Levels, most: float) -> float:
    """By how much tuning may be all beside what was selected, by what was stated of parameters; below 0 it is not."""
    return STEEP * SOFT * float(np.log(most / max(levels.strained, 1e-9)))


def _chance_room(levels: Levels) -> float:
    """By how much a trend of friction over the session may be chance; below 0 it is none."""
    return SOFT * float(np.log(max(levels.drifted, 1e-9) / RARE))


def _noise_room(levels: Levels, *, selected: bool) -> float:
    """Share by which what the final model leaves of the training experiments keeps clear of what is no noise."""
    follows = 1.0 - levels.patterns.followed / levels.most_followed(selected=selected)
    if levels.repeated:  # nothing is left to follow the motion where training experiments end at the floor
        return follows if levels.whitened > (NEAR_FLOOR if selected else 1.0) else 1.0
    return min(1.0 - levels.trained / FAR_TRAINED, follows, 1.0 - levels.patterns.ringing / RINGS)


def _step(x: float) -> float:
    return float(1.0 / (1.0 + np.exp(-np.clip(x / SOFT, -50, 50))))


def marginals(rounds: Sequence[Round], *, there: float = 1.0) -> tuple[dict[str, float], list[dict[str, Any]]]:
    """Probability of each effect, given the other selected ones, and of sets of effects. `there`: probability that what
    was selected is no imitation of something unknown.

    An effect that was not selected counts only as far as the selected ones are the cause."""
    chosen = [contest.probability[contest.accepted.effect] if contest.accepted else 1.0 for contest in rounds]
    effects: dict[str, float] = {}
    sets: list[dict[str, Any]] = []
    for k, contest in enumerate(rounds):
        others = float(np.prod(chosen[:k] + chosen[k + 1 :]))
        for name, p in contest.probability.items():
            if name is not None:
                more = there * (p if contest.accepted else others * p)
                effects[name] = min(1.0, effects.get(name, 0.0) + more)
            together = [*contest.base, *([name] if name is not None else [])]
            is_own = contest.accepted is not None and name == contest.accepted.effect
            if together and not (is_own and k + 1 < len(rounds)):  # all that were selected together count once
                sets.append({"effects": together, "probability": there * others * p})
    accepted = [contest.accepted.effect for contest in rounds if contest.accepted]
    for contest in rounds:
        if contest.accepted:  # a rival, which may be there instead of it or beside it, is no likelier
            for name in {n for n in contest.probability if n is not None}.difference(accepted):
                effects[name] = min(effects[name], effects[contest.accepted.effect])
    sets.sort(key=lambda s: -float(s["probability"]))
    return effects, [s for s in sets if s["probability"] > 1e-4][:12]


def _group(contest: Round) -> list[str]:
    """Effects that these data cannot tell from the accepted one, most probable first."""
    if contest.accepted is None:
        return []
    top = contest.probability[contest.accepted.effect]
    members = [(p, n) for n, p in contest.probability.items() if n is not None and p >= SAME_GROUP * top]
    return [n for _, n in sorted(members, reverse=True)] if len(members) > 1 else []
