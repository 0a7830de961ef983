"""Wrong signs and scales: which one factor of a channel makes the equation of motion agree with what is believed."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from tendonlab.checking.conversions import nearest
from tendonlab.checking.equation import Equation
from tendonlab.checking.logs import Logs
from tendonlab.checking.regression import MOST_STEPS, Fit, Unknown
from tendonlab.checking.suspects import RATIO, Suspect, only_turns, suspects
from tendonlab.checking.terms import terms
from tendonlab.fitting.noise import integrated_time

ROUGH, FINE = 300, 1500  # samples in the search, and in what decides
STEPS = 6  # of a fit in the search
ROUGH_SHARE = 0.2  # of the samples that count as independent before the residual is known
GAUSS_NEWTON, NUDGE = 3, 1e-4  # steps to the least of a narrow valley, and the relative change that shows its slope
REFINED = 4  # of the best, which are looked at closely
SUSPECT, STRAINED = 0.05, 2.0  # level of the residual, and sd of the beliefs, beyond which factors are looked for
EXPLAINED = 0.7  # level of the residual beyond which an equation explains too little to judge by: half the power
MENDED = 0.7  # share of the level of a bad equation that a right factor must at most leave, or
RELIEVED = 0.5  # share of the strain of the beliefs that it may leave instead
SPOILT = 1.5  # times the level of an equation that explains too little, beyond which a factor is no right one
CREDIBLE = 4.0  # sd by which a corrected scale may strain the beliefs (a mere sign by any), unless the logs strain more
SETTLED = 0.01  # share of the level of an equation that may be left where no strain speaks against a factor
BALANCED = 0.1  # level of an equation that balances: where none does, nothing may be strained
NOISELESS = 0.002  # level of an equation that balances beyond what any model does: strained beliefs bring it many nats
NEARLY = 0.4  # level to which a factor must mend an equation to be believed for that: friction with memory remains
LATEST, MOST_LAGS = 0.05, 8  # s: lags of outputs that are tried before a factor is told, at most so many
LEAST_GAIN = 10.0  # nats by which a factor must improve on none
ALIKE, ALIKE_SHARE = 3.0, 0.02  # nats within which factors of different channels are equally good
EXACT = 0.02  # relative distance at which a factor is the ratio of two units
FAR = 100.0  # ratio of units that no parameter explains
MERE = 0.9  # share of the gain of a negative factor at which a mere sign is believed,
HEALED = 0.1  # and share of the level of an equation that such a sign leaves
AWAY = RATIO**-6  # of a channel that is explained away
BLOCKING = 1.5  # a factor below it is a parameter: of 306 right rigs two asked for one, 1.33 and 1.42
PASSED_ON = 1.85  # where no axis moves by an equation: friction of a sheath grows with the load, and asked for 1.80


@dataclass(frozen=True)
class Factor:
    """Channels that are logged `value` times too large, the fit once they are corrected, and its gain in nats over
    the logs as they are. `exact`: the value is a ratio of units, which is not refined."""

    signals: tuple[str, ...]
    value: float
    fit: Fit
    gain: float = 0.0
    exact: bool = False


def wrong_factors(equation: Equation, logs: Logs) -> list[Factor]:
    """The equally good factors, best first, one for each set of channels; empty where none is needed."""
    rough = logs.thinned(ROUGH)
    share = np.full(len(equation.predicted), ROUGH_SHARE)
    plain = terms(equation, rough).fit(share)
    if not np.isfinite(plain.cost):
        return []
    if np.all(plain.level < SUSPECT) and plain.strain < STRAINED:
        return []
    least = BLOCKING if equation.moved else PASSED_ON
    searched = [_searched(equation, rough, suspect, share) for suspect in suspects(equation, plain.level)]
    leading = _leading(searched)
    found = [_refined(equation, rough, f, share, RATIO, 0.05) for f in leading]
    found = [f for f in found if _is_credible(f, plain, least)]
    found = [f for f in found if agrees(f.fit, plain)] or found
    if not found:
        return []
    best = min(found, key=lambda f: f.fit.cost)
    told = best.fit.level < EXPLAINED
    if not told.any() or not _blocks(best.value, least) or plain.cost - best.fit.cost < LEAST_GAIN:
        return []
    slack = LEAST_GAIN + ALIKE_SHARE * (plain.cost - best.fit.cost)
    found = [f for f in found if f.fit.cost < best.fit.cost + 2.0 * slack or (f.exact and agrees(f.fit, plain))]
    fine = logs.thinned(FINE)
    share = told * independent(best, equation, fine)
    noiseless = np.fmax(plain.level, best.fit.level) < NOISELESS
    share = np.where(noiseless & np.any(~noiseless & told), np.fmin(share, ROUGH_SHARE * ROUGH / FINE), share)
    base = terms(equation, fine).fit(share)
    polished = [_refined(equation, fine, f, share, 1.3, 1e-2) for f in found]
    polished = [_mere_sign(equation, fine, f, share, base, told) for f in polished]
    judged = ranked([replace(f, gain=base.cost - f.fit.cost) for f in polished])
    best = judged[0]
    if best.gain < LEAST_GAIN or not _blocks(best.value, least) or np.any(best.fit.level[told] > EXPLAINED):
        return []
    if any(not _blocks(f.value, least) and f.gain > best.gain - LEAST_GAIN for f in judged):
        return []  # a parameter says nearly the same
    if not _helps(best.fit, base, told) or not _convinces(best, base, told) or _suits_late(equation, logs, best, share):
        return []
    if only_turns(equation, best.signals):  # of any size: its sign must be what the beliefs ask for
        if best.fit.strain > CREDIBLE:
            return []
    elif _is_explained_away(equation, fine, best, base, told, share):
        return []
    return [f for f in judged if f.gain > best.gain - ALIKE - ALIKE_SHARE * best.gain and _blocks(f.value, least)]


def _leading(factors: list[Factor]) -> list[Factor]:
    """The best of those that a search found, and of the units of single channels that strain no belief: each of these
    channels is among the former with any factor, and would take the place of others."""
    by_cost = sorted(factors, key=lambda f: f.fit.cost)
    others = [f for f in by_cost if not f.exact or len(f.signals) > 1]
    units = [f for f in by_cost if f.exact and len(f.signals) == 1 and f.fit.strain < CREDIBLE]
    return [*others[:REFINED], *units[:REFINED]]


def ranked(factors: list[Factor]) -> list[Factor]:
    """By gain, one for each set of channels. The ratio of two units counts as equally good within the slack in which
    channels do: it is far likelier than a ratio near it, and more so than one that strains beliefs."""
    slack = ALIKE + ALIKE_SHARE * max(f.gain for f in factors)
    ordered = sorted(factors, key=lambda f: f.gain + slack * f.exact, reverse=True)
    best: dict[tuple[str, ...], Factor] = {}
    for factor in ordered:
        known = best.setdefault(factor.signals, factor)
        if factor.exact and factor.fit.strain < CREDIBLE < known.fit.strain:
            best[factor.signals] = factor
    return list(best.values())


def _is_explained_away(
    equation: Equation, logs: Logs, factor: Factor, base: Fit, told: np.ndarray, share: np.ndarray
) -> bool:
    """Whether a channel suits at any size beyond a factor as well: then nothing is explained."""
    beyond = factor.value * (RATIO**2 if abs(factor.value) > 1.0 else RATIO**-2)
    if factor.value == -1.0 and _heals(factor.fit, base, told):
        beyond = AWAY
    return _fitted(equation, logs, factor.signals, beyond, share).cost < factor.fit.cost + LEAST_GAIN


def _is_credible(factor: Factor, plain: Fit, least: float) -> bool:
    """Whether beliefs may be strained as far as a corrected scale strains them: a mere sign may by any, and so may what
    brings an equation from far away near balance. There the logs as they are strain nothing, as nothing suits them."""
    if not _blocks(-factor.value, least) or factor.fit.strain < max(plain.strain, CREDIBLE):
        return True
    return bool(np.any((factor.fit.level < NEARLY) & (factor.fit.level < SETTLED * plain.level)))


def agrees(fit: Fit, plain: Fit) -> bool:
    """Whether corrected logs strain no belief, and balance, or heal an equation and leave none worse than nothing.
    Beside such a correction none that strains beliefs counts: far more friction than stated suits a sheath whose output
    is in N*mm to a tenth of what its right unit leaves."""
    healed = np.any((fit.level < BALANCED) & (fit.level < HEALED * plain.level)) and np.all(fit.level < 1.0)
    return bool(fit.strain < CREDIBLE and (healed or np.all(fit.level < BALANCED)))


def _mere_sign(
    equation: Equation, logs: Logs, factor: Factor, share: np.ndarray, base: Fit, told: np.ndarray
) -> Factor:
    """A turned sign instead of a negative factor that suits hardly better, where it heals an equation: nobody logs a
    channel times -0.7."""
    if factor.value > 0:
        return factor
    turned = Factor(factor.signals, -1.0, _fitted(equation, logs, factor.signals, -1.0, share))
    hardly_worse = base.cost - turned.fit.cost > MERE * (base.cost - factor.fit.cost)
    return turned if hardly_worse and _heals(turned.fit, base, told) else factor


def _heals(fit: Fit, base: Fit, told: np.ndarray) -> bool:
    return bool(np.any(fit.level[told] < HEALED * base.level[told]))


def _helps(fit: Fit, base: Fit, told: np.ndarray) -> bool:
    """Whether any equation that balances badly balances better, or beliefs that the logs strain are relieved; and no
    equation is spoilt. One that balances well anyway, as that of a stiff cable does, may gain many nats from a factor
    that no other equation asks for; and so may one that lacks something large, as a stop. Where all balance well, as
    between compliant ends, beliefs must be relieved."""
    suspect = told & (base.level >= SUSPECT)
    mends = bool(np.any(fit.level[suspect] < MENDED * base.level[suspect]))
    relieves = base.strain >= STRAINED and fit.strain < RELIEVED * base.strain
    return (mends or relieves) and not np.any(fit.level > np.fmax(EXPLAINED, SPOILT * base.level))


def _convinces(factor: Factor, base: Fit, told: np.ndarray) -> bool:
    """Whether the logs, once corrected, suit the simulator anywhere: an equation balances, or the beliefs suit it. Or
    the factor is the ratio of two units, and nears balance where the logs as they are were far from any, or where the
    ratio is so large that no parameter explains it."""
    fit = factor.fit
    if fit.strain < STRAINED or np.any(fit.level[told] < BALANCED):
        return True
    exact = factor.value > 0 and abs(np.log(factor.value / nearest(factor.value).ratio)) < EXACT
    far = _heals(fit, base, told) or (fit.strain < CREDIBLE and abs(np.log(abs(factor.value))) > np.log(FAR))
    return bool(exact and far and np.all(fit.level[told] < NEARLY))


def _suits_late(equation: Equation, logs: Logs, factor: Factor, share: np.ndarray) -> bool:
    """Whether outputs that are late, all or one, suit the simulator better than a factor, and spoil no equation: beyond
    a step of the logs, a lag is more than its slope."""
    everywhere, step = np.ones(len(equation.dataset.experiments)), max(logs.step, LATEST / MOST_LAGS)
    bearable = np.fmax(SUSPECT, SPOILT * factor.fit.level)
    for lag in np.arange(step, LATEST, step):
        for late in (equation.measured, *((name,) for name in equation.measured)):
            moved = logs.earlier(dict.fromkeys(late, lag * everywhere)).thinned(FINE)
            found = terms(equation, moved).fit(share)
            if found.cost < factor.fit.cost and np.all(found.level < bearable):
                return True
    return False


def _searched(equation: Equation, logs: Logs, suspect: Suspect, share: np.ndarray) -> Factor:
    """The best of the factors that a suspect may have."""
    fits = [_fitted(equation, logs, suspect.signals, v, share, STEPS) for v in suspect.values]
    tried = [Factor(suspect.signals, v, f, exact=suspect.exact) for v, f in zip(suspect.values, fits, strict=True)]
    return min(tried, key=lambda f: f.fit.cost)


def _refined(
    equation: Equation, logs: Logs, factor: Factor, share: np.ndarray, reach: float, accuracy: float
) -> Factor:
    """The best factor within `reach` of one. Where something stiff is stretched by a small difference of long travels,
    its valley is too narrow for a search: there Gauss-Newton finds it, or it is that one."""
    from scipy.optimize import minimize_scalar

    if factor.exact or only_turns(equation, factor.signals):
        return replace(factor, fit=_fitted(equation, logs, factor.signals, factor.value, share))

    def cost(logarithm: float) -> float:
        return _fitted(equation, logs, factor.signals, factor.value * np.exp(logarithm), share).cost

    bounds = (-np.log(reach), np.log(reach))
    found = minimize_scalar(cost, bounds=bounds, method="bounded", options={"xatol": accuracy})
    values = (factor.value, float(factor.value * np.exp(found.x)), _stepped(equation, logs, factor, share))
    tried = [Factor(factor.signals, v, _fitted(equation, logs, factor.signals, v, share)) for v in values]
    return min(tried, key=lambda f: f.fit.cost)


def _stepped(equation: Equation, logs: Logs, factor: Factor, share: np.ndarray) -> float:
    """The factor where Gauss-Newton takes its logarithm together with all unknowns."""
    value = factor.value
    for _ in range(GAUSS_NEWTON):
        here, there = (terms(equation, logs.scaled(factor.signals, v)) for v in (value, value * np.exp(NUDGE)))
        slope = (there.residual * (here.size / there.size)[:, None] - here.residual) / NUDGE
        unknowns = (*here.unknowns, Unknown("factor", sd=np.log(RATIO)))
        both = replace(here, columns=np.concatenate([here.columns, slope[None]]), unknowns=unknowns)
        value = float(value * np.exp(np.clip(both.fit(share).x[-1], -np.log(RATIO), np.log(RATIO))))
    return value


def _fitted(
    equation: Equation, logs: Logs, signals: tuple[str, ...], value: float, share: np.ndarray, steps: int = MOST_STEPS
) -> Fit:
    return terms(equation, logs.scaled(signals, value)).fit(share, steps=steps)


def rough_fit(equation: Equation, logs: Logs) -> Fit:
    """The regression of logs that nobody corrected, before it is known how many samples count."""
    return terms(equation, logs).fit(np.full(len(equation.predicted), ROUGH_SHARE))


def independent(factor: Factor, equation: Equation, logs: Logs) -> np.ndarray:
    """Share of the samples of each equation that count as independent, from the residual of the best factor."""
    rough = np.full(len(equation.predicted), ROUGH_SHARE)
    residual = _fitted(equation, logs, factor.signals, factor.value, rough).residual
    return shares(residual, logs.run)


def shares(residual: np.ndarray, run: np.ndarray) -> np.ndarray:
    """Share of the samples of each row that count as independent, by the memory within the experiments."""
    memory = [
        np.mean([integrated_time(np.clip(row[run == i], *np.quantile(row, (0.02, 0.98)))) for i in np.unique(run)])
        for row in residual
    ]
    return 1.0 / np.maximum(np.array(memory), 1.0)


def _blocks(value: float, least: float = BLOCKING) -> bool:
    return value < 0 or value >= least or value <= 1 / least
