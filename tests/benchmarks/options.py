"""How much is measured."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Options:
    """`rounds`: in which tools take turns, after one that is not counted. `points`, `mechanisms`: of the sweeps of J1
    and J2. `starts`: of the fits. `million`: points of the sweep whose memory is measured."""

    rounds: int = 7
    points: int = 10_000
    mechanisms: int = 500
    starts: int = 12
    million: int = 1_000_000
