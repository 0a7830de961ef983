"""What the first refit tells of the promises of the others."""

from types import SimpleNamespace
from typing import Any

import pytest

from tendonlab.diagnosis.search import workshop
from tendonlab.diagnosis.search.screen import Screened


@pytest.mark.parametrize(("least", "behind"), [(100.0, False), (1000.0, True)])
def test_nobody_is_far_behind_a_promise_that_was_not_kept(
    least: float, behind: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first candidate fails: a tenth of the `least` gain that is asked for is then enough for all starts."""
    seen = {}

    def tried(_fitter: Any, _base: Any, candidate: Screened, *, pace: float) -> workshop.Failed:
        seen[candidate.effect] = candidate
        return workshop.Failed(candidate.effect, "stopped")

    monkeypatch.setattr(workshop, "_tried", tried)
    pool: Any = SimpleNamespace(map=map)
    shop = workshop.Workshop(pool, cancel=None, progress=False, library=None)  # type: ignore[arg-type]
    case = SimpleNamespace(replay=SimpleNamespace(kind="controller"))
    base: Any = SimpleNamespace(counted=lambda: SimpleNamespace(evidence=0.0), case=case)
    marks = {"far_behind": True, "poor_when_believed": True}
    chosen = [Screened("first", 500.0, ({},), 1.0), Screened("other", 20.0, ({},), 1.0, **marks)]
    shop.refit_all(base, base, chosen, "effect", least=least)
    assert (seen["other"].far_behind, seen["other"].poor_when_believed) == (behind, behind)


class Fit:
    """A fit of this evidence."""

    def __init__(self, evidence: float) -> None:
        self.evidence = evidence

    def counted(self) -> "Fit":
        return self


def test_twins_that_end_short_of_each_other_reach_one_evidence(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each fit goes 40 nats beyond where it starts, up to the optimum of both."""
    optimum = 100_200.0

    def trial(effect: str, fit: Any, _base: Any) -> Any:
        return SimpleNamespace(effect=effect, fitted=fit, evidence_gain=fit.evidence)

    monkeypatch.setattr(workshop, "Trial", SimpleNamespace(of=trial))
    monkeypatch.setattr(workshop, "counted_alike", lambda trials, _base: sorted(trials, key=lambda t: -t.evidence_gain))
    monkeypatch.setattr(
        workshop, "restarted", lambda _fitter, _base, leader, _fit: Fit(min(leader.evidence + 40.0, optimum))
    )
    pool: Any = SimpleNamespace(map=map)
    shop = workshop.Workshop(pool, cancel=None, progress=False, library=None)  # type: ignore[arg-type]
    none: Any = None
    found = shop._levelled(none, none, [trial("one", Fit(100_000.0), none), trial("other", Fit(99_950.0), none)])
    assert [t.evidence_gain for t in found] == [optimum, optimum]
