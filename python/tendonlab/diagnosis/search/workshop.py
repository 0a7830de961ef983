"""Where candidates are screened and refitted: threads, progress bars, and the effects to choose from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import partial

from tendonlab import _core
from tendonlab.diagnosis.search.amplitudes import with_told
from tendonlab.diagnosis.search.bristles import trouble_with_bristles
from tendonlab.diagnosis.search.delays import trouble_with_delays, with_twins_even
from tendonlab.diagnosis.search.refit import refit, restarted
from tendonlab.diagnosis.search.screen import Screened, candidates, screen
from tendonlab.diagnosis.search.shares import with_whole_shares
from tendonlab.diagnosis.search.stiction import trouble_with_stiction
from tendonlab.diagnosis.search.trial import Trial, counted_alike
from tendonlab.errors import NumericalError, ParameterError
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.problem import Fitter
from tendonlab.progress import track

FAR_BEHIND = 0.1  # share of the most that another candidate promises, and of what the first one gains
CLOSE = (0.25, 0.1, 0.01, 0.01, 0.001, 0.001)  # of the best gain: so far behind may be a worse optimum, by rounds
SAME = 0.1  # nats that are no difference
NOTHING = "its 95 % interval holds 0"  # although it gains: why an effect does not count
TROUBLES = (trouble_with_bristles, trouble_with_delays, trouble_with_stiction)  # why a fit does not tell of its effect


@dataclass(frozen=True)
class Failed:
    """A candidate with which no fit succeeded, and why."""

    effect: str
    reason: str


@dataclass(frozen=True)
class Refitted:
    """Candidates after their refits: `trials`, best first, and why every fit of the others `failed`."""

    trials: list[Trial]
    failed: Mapping[str, str]

    def with_others(self, others: Refitted, base: Fitted, case: Case) -> Refitted:
        """These and others that extend the same base."""
        trials = counted_alike([*self.trials, *others.trials], base)
        return Refitted(with_twins_even(case, trials), {**self.failed, **others.failed})


@dataclass(frozen=True)
class Workshop:
    """Threads for simulations and fits, `cancel` to stop them, whether progress is shown, and the names of the effects
    to choose from (None: all)."""

    pool: ThreadPoolExecutor
    cancel: _core.Cancel
    progress: bool
    library: Sequence[str] | None

    def screen_all(self, fitter: Fitter, base: Fitted, label: str) -> list[Screened]:
        """All candidates as the screen sees them, most promising first."""
        names = candidates(fitter.case, base, self.library)
        all_rows = base.counted()  # the memory of the base's residuals would hide every lead
        work = self.pool.map(lambda name: screen(fitter, all_rows, name), names)
        shown = track(work, label=f"screen {label}", total=len(names), unit="effect", shown=self.progress, stays=False)
        return sorted(shown, key=lambda screened: -screened.gain)

    def refit_all(
        self,
        fitter: Fitter,
        base: Fitted,
        chosen: Sequence[Screened],
        label: str,
        *,
        least: float,
        incumbent: Trial | None = None,
    ) -> Refitted:
        """The chosen candidates refitted. The first sets the pace for the others, unless there is an `incumbent`: the
        trial of another effect that is fitted already. Those that stay far below a gain of `least` nats are sketched.
        """
        pace = base.counted().evidence + least
        first = incumbent or (_tried(fitter, base, chosen[0], pace=pace) if chosen else None)
        if isinstance(first, Trial):
            pace = max(pace, first.fitted.counted().evidence)
        rest = chosen if incumbent else chosen[1:]
        far = FAR_BEHIND * (pace - base.counted().evidence)
        rest = [_promising_after_all(s) if s.far_behind and s.gain >= far else s for s in rest]
        work = self.pool.map(lambda candidate: _tried(fitter, base, candidate, pace=pace), rest)
        shown = track(work, label=f"refit {label}", total=len(rest), unit="effect", shown=self.progress, stays=False)
        tried = [*([first] if first else []), *shown]
        trials = counted_alike([t for t in tried if isinstance(t, Trial)], base)
        failed = {t.effect: t.reason for t in tried if isinstance(t, Failed)}
        trials = self._levelled(fitter, base, trials)
        if trials:
            trials[0] = with_told(fitter, base, trials[0])
        holder = incumbent.effect if incumbent else None
        nothing = {t.effect: NOTHING for t in trials if t.is_nothing and t.effect != holder}
        left = with_twins_even(fitter.case, [t for t in trials if t.effect not in nothing])
        return Refitted(left, failed | nothing)

    def _levelled(self, fitter: Fitter, base: Fitted, trials: list[Trial]) -> list[Trial]:
        """The trials, those close behind the first also from where it ended, and the first from where they did."""
        for reach in CLOSE:
            if not trials:
                break
            first, most = trials[0].fitted, trials[0].evidence_gain
            close = [t for t in trials[1:] if SAME < most - t.evidence_gain < reach * most]
            fits = list(self.pool.map(partial(restarted, fitter, base, first), [t.fitted for t in close]))
            better = {
                t.effect: Trial.of(t.effect, fit, base)
                for t, fit in zip(close, fits, strict=True)
                if fit.counted().evidence > t.fitted.counted().evidence + SAME
            }
            if not better:
                break
            trials = counted_alike([better.get(t.effect, t) for t in trials], base)
        return trials


def _promising_after_all(candidate: Screened) -> Screened:
    """Where the first candidate kept too little of its promise, no screen says who is far behind."""
    return replace(candidate, far_behind=False, poor_when_believed=False)


def _tried(fitter: Fitter, base: Fitted, candidate: Screened, *, pace: float) -> Trial | Failed:
    try:
        started = candidate if candidate.far_behind else with_whole_shares(fitter, base, candidate)
        fit = refit(fitter, base, started, pace=pace)
        trouble = next(filter(None, (of(fitter.case, fit, candidate.effect) for of in TROUBLES)), "")
    except (NumericalError, ParameterError) as reason:
        return Failed(candidate.effect, str(reason))
    return Failed(candidate.effect, trouble) if trouble else Trial.of(candidate.effect, fit, base)


@contextmanager
def open_workshop(library: Sequence[str] | None, *, progress: bool) -> Iterator[Workshop]:
    """A workshop whose threads end with the block; Ctrl-C and errors cancel the fits that run in them."""
    cancel = _core.Cancel()
    pool = ThreadPoolExecutor()
    try:
        yield Workshop(pool, cancel, progress, library)
    except BaseException:
        cancel.set()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
