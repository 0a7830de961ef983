"""From lags to findings: experiments that lag others, and a lag that all share."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from tendonlab.checking.finding import Finding
from tendonlab.checking.lags import RESOLVED, Lags

SURE = 5.0  # sd that make a lag which all experiments share
APART = 6.0  # sd, of the lag and of its scatter among experiments, by which one experiment lags the others
LEAST = 1.5  # samples by which an experiment must lag the others
LEAST_SHARED = 0.25  # of a sample, of a lag that all share
MATTERS = 6.0  # levels of the residual that the lag of one experiment must be worth: presliding may be worth 4
STRIKING = 50.0  # the same where nothing but a simulation confirms it: true ones were worth 63 and 190
SUITS = 50.0  # nats by which its own lags must suit an experiment better than those of the others, or they and a scan
SCANNED, ALONE = 20.0, 0.1  # nats of a scan that make an experiment late, and share of them that no other may reach
STANDS_OUT = 2.0  # times the nats of any experiment that is not late: what the simulator lacks suits lags in all
MOST_LATE = 0.25  # share of the experiments of which some may lag and others lead
MIDDLE = 0.6745  # sd that half of all normal errors exceed
ROUNDS = 3  # of common lag and scatter
SHARES = (0.01, 100.0)  # of what the equations leave: what may look like a lag
ALIGN = "align its channels to one clock, or leave the experiment out"
BEHIND = "a diagnosis weighs the effect delay against others that look like a lag"
AHEAD = "no delay explains this: either the inputs are stamped late, or the simulator lacks something that looks alike"
LONG = 0.1  # s: no sensor or drive of a joint is later
STRANGE = (
    "so long a delay is rare: more likely the simulator lacks something that looks alike, as friction in slow motion"
)
UNKNOWN = 10.0  # s: a lag of which nothing is known


def clock_findings(lags: Lags, names: Sequence[str], inputs: Sequence[str], step: float) -> list[Finding]:
    """What the lags of the outputs in the experiments `names` say; `step`: from sample to sample, s."""
    shared, total, late = _apart(lags, step)
    away = lags.seconds - shared[:, None]
    late &= (np.abs(away) * lags.weight > MATTERS) & (lags.gain > SUITS)
    others = lags.gain[~late.any(axis=0) & np.isfinite(lags.gain)]
    late &= lags.gain > STANDS_OUT * np.max(others, initial=0.0)
    late |= _late_alone(lags.scanned) & _far_off(away) & (lags.scanned + lags.gain > SUITS)
    if late.any(axis=0).sum() > MOST_LATE * len(names) and np.any(away[late] > 0) and np.any(away[late] < 0):
        late[:] = False  # so many clocks do not go wrong both ways: it is something that the simulator lacks
    found = [f for i, name in enumerate(names) for f in one_late(lags.channels, inputs, away[:, i], late[:, i], name)]
    return [*found, *_all_late(lags, inputs, shared, total, step)]


def striking_findings(lags: Lags, names: Sequence[str], inputs: Sequence[str], step: float) -> list[Finding]:
    """The same of single experiments whose lag is worth so much that a simulation should tell it, though by the
    equation friction, or a map over the place, suits the experiment as well."""
    shared, _, late = _apart(lags, step)
    away = lags.seconds - shared[:, None]
    late &= np.abs(away) * lags.weight > STRIKING
    return [f for i, name in enumerate(names) for f in one_late(lags.channels, inputs, away[:, i], late[:, i], name)]


def _apart(lags: Lags, step: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of each output the lag that most experiments share; how well the lag of each experiment is known beside that (s);
    and whether that lag is another one."""
    known = np.hypot(lags.sd, RESOLVED * step)
    levels = np.fmin(1.0 / np.fmax(lags.weight, 1e-300), UNKNOWN)
    shared, scatter = (np.array(x) for x in zip(*map(_common, lags.seconds, known, levels), strict=True))
    total = np.hypot(known, scatter[:, None] * levels)
    away = np.abs(lags.seconds - shared[:, None])
    # What the simulator lacks delays all outputs: an experiment is apart where even the largest scatter of any explains
    # nothing.
    apart = APART * np.hypot(known, np.max(scatter) * levels)
    return shared, total, (away > apart) & (away > LEAST * step)


def _late_alone(nats: np.ndarray) -> np.ndarray:
    """Whether a scan shows that one experiment is late and no other is. Noise in a slow run makes its exact lag look
    smaller than it is, and well known."""
    others = [np.max(np.delete(nats, i), initial=0.0) for i in range(len(nats))]
    return np.asarray((nats > SCANNED) & (np.array(others) < ALONE * nats))


def _far_off(away: np.ndarray) -> np.ndarray:
    """Whether a lag is far from the others beside what these scatter, in any channel: a stop delays every motion that
    meets it. Of one experiment alone nothing is."""
    if away.shape[1] < 2:
        return np.zeros(away.shape[1], dtype=bool)
    others = [np.median(np.abs(np.delete(away, i, axis=1)), axis=1) / MIDDLE for i in range(away.shape[1])]
    return np.asarray(np.any(np.abs(away) > APART * np.array(others).T, axis=0))


def one_late(
    channels: Sequence[str], inputs: Sequence[str], away: np.ndarray, late: np.ndarray, experiment: str
) -> Iterator[Finding]:
    """An experiment whose outputs lag its inputs otherwise than in the others: by how much `away` (s), and whether it
    is `late`, of each output. Where not all outputs agree, the one that differs is guilty."""
    if not late.any():
        return
    alone = len(late) > 1 and not late.all()
    for c in np.flatnonzero(late).tolist() if alone else [int(np.argmax(np.abs(away)))]:
        seconds = float(away[c])
        what = channels[c] if alone else " and ".join(channels)
        yield Finding(
            problem="clock",
            signal=channels[c] if alone else None,
            experiment=experiment,
            alternatives=() if alone else (*inputs, *channels),
            seconds=seconds,
            blocks=True,
            detail=f"in {experiment}, {what} {_verb(seconds, alone or len(late) == 1)} the inputs by {_time(seconds)} "
            f"more than in the other experiments; {ALIGN}",
        )


def _all_late(
    lags: Lags, inputs: Sequence[str], shared: np.ndarray, total: np.ndarray, step: float
) -> Iterator[Finding]:
    """Lags that all experiments share: the effect `delay`, which a diagnosis may establish."""
    sd = 1.0 / np.sqrt(np.sum(1.0 / total**2, axis=1))
    late = (np.abs(shared) > SURE * sd) & (np.abs(shared) > LEAST_SHARED * step)
    together = bool(late.all()) and float(np.ptp(shared)) < max(step, SURE * float(np.max(sd)))
    for c in [int(np.argmin(sd))] if together else np.flatnonzero(late):
        seconds = float(shared[c])
        single = len(lags.channels) > 1 and not together
        what = " and ".join(lags.channels) if together else lags.channels[c]
        verb = _verb(seconds, not together or len(lags.channels) == 1)
        meaning = AHEAD if seconds < 0 else BEHIND if seconds < LONG else STRANGE
        yield Finding(
            problem="clock",
            signal=lags.channels[c] if single else None,
            alternatives=() if single else (*inputs, *lags.channels),
            seconds=seconds,
            detail=f"{what} {verb} the inputs by {_time(seconds)} in all experiments; {meaning}",
        )


def _common(seconds: np.ndarray, sd: np.ndarray, level: np.ndarray) -> tuple[float, float]:
    """The lag that most experiments share, and their scatter about it beyond their own `sd`: a share of the `level` of
    each, the lag that is worth what the equations leave, since what the simulator lacks resembles a lag. The share is
    such that the middle experiment is as far away as normal errors are: a few that differ much do not change it."""
    common, scatter = float(np.median(seconds)), 0.0
    shares = np.concatenate([[0.0], np.geomspace(*SHARES, 60)])
    for _ in range(ROUNDS):
        away = np.abs(seconds - common)
        middle = [np.median(away / np.hypot(sd, share * level)) for share in shares]
        scatter = float(shares[int(np.argmax([*(np.array(middle[:-1]) <= MIDDLE), True]))])
        order = np.argsort(seconds)
        weight = np.cumsum(1.0 / np.hypot(sd, scatter * level)[order] ** 2)
        common = float(seconds[order][np.searchsorted(weight, 0.5 * weight[-1])])
    return common, scatter


def _verb(seconds: float, one: bool) -> str:
    return ("lag" if seconds > 0 else "lead") + ("s" if one else "")


def _time(seconds: float) -> str:
    size = abs(seconds)
    return f"{1e3 * size:.3g} ms" if size < 1.0 else f"{size:.3g} s"
