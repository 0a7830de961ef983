"""What several scored series say together: every share with its number of cases and its interval."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from tendonlab.diagnosis.answer.calibration import Calibration, calibration_of, read_content, shipped, shipped_content
from tendonlab.rehearsal.tally import Share, share

from .calibrating import Folders, Judged, judged
from .oracle import shares_of_oracle
from .reliability import Interval, interval_of_mean
from .scoring import SURE, score

ENOUGH = 0.95  # of what a diagnosis reaches that is told the effects
STRONG, WEAK = 3.0, 1.0  # gap/noise from which an effect is strong, and below which noise may hide an effect


class Row(NamedTuple):
    """A quantity: what is counted, in which of the cases."""

    quantity: str
    column: str
    among: Callable[[pd.DataFrame], pd.Series]


class Mean(NamedTuple):
    """A mean over `num` rigs, with its 95 % interval where there are enough of them."""

    mean: float
    num: int
    ci95: Interval | None


def _between(least: float, below: float = np.inf) -> Callable[[pd.DataFrame], pd.Series]:
    return lambda cases: cases["gap_noise"].astype(float).between(least, below, inclusive="left")


def _unknown(least: float, below: float = np.inf) -> Callable[[pd.DataFrame], pd.Series]:
    return lambda cases: (cases["truth"] == "unknown_effect") & _between(least, below)(cases)


def _everywhere(cases: pd.DataFrame) -> pd.Series:
    return pd.Series(True, index=cases.index)


ROWS = (
    Row("single effect established, nothing beside it, gap/noise ≥ 3", "established", _between(STRONG)),
    Row("the same, gap/noise 1–3", "established", _between(WEAK, STRONG)),
    Row("the same, gap/noise < 1", "established", _between(0.0, WEAK)),
    Row("ranked first, gap/noise ≥ 1", "ranked_first", _between(WEAK)),
    Row("an effect named where none is missing", "named", _everywhere),
    Row("something unknown claimed where nothing is missing", "claimed", _everywhere),
    Row("unknown cause found, gap/noise ≥ 3", "unknown_hit", _unknown(STRONG)),
    Row("unknown cause found, gap/noise 1–3", "unknown_hit", _unknown(WEAK, STRONG)),
    Row("unknown cause found, all strengths", "unknown_hit", _unknown(0.0)),
    Row(f"unknown cause reported as an effect with P > {SURE}", "unknown_named", _unknown(0.0)),
    Row("pair: both established", "pair_both", _everywhere),
    Row("pair: at least one established", "pair_one", _everywhere),
    Row("mistake in the logs: right kind", "fault_kind", _everywhere),
    Row("mistake in the logs: right signal or run", "fault_signal", _everywhere),
    Row("held-out gap shrunk as far as with the effects told, gap/noise ≥ 1", "shrunk", _between(WEAK)),
    Row("right logs refused, or no report", "blocked", _everywhere),
    Row("verdict right", "verdict_hit", _everywhere),
)


@dataclass(frozen=True, kw_only=True)
class Results:
    """`cases`: one row per case of all series, as `Score.cases`; also whether an effect was `named`, or something
    unknown `claimed`, where nothing is missing, and whether the gap `shrunk` as much as with the effects told.
    `judged`: the cases whose probabilities count; `content`: of the calibration.json that maps their evidence."""

    cases: pd.DataFrame
    judged: tuple[Judged, ...]
    content: Mapping[str, Any] = field(default_factory=shipped_content, repr=False)

    def map_of(self, *, repeats: bool) -> Calibration:
        """The map from evidence to probability."""
        return calibration_of(self.content, repeats=repeats)

    @property
    def map_is_shipped(self) -> bool:
        """Whether it is the map that comes with this version, whatever confirmed it."""
        maps = [(self.map_of(repeats=repeats), shipped(repeats=repeats)) for repeats in (False, True)]
        return all((own.verdicts, own.effects) == (of.verdicts, of.effects) for own, of in maps)

    @property
    def parts(self) -> dict[str, pd.DataFrame]:
        """The cases without and with repeats."""
        repeats = self.cases["repeats"].astype(bool)
        return {"without repeats": self.cases[~repeats], "with repeats": self.cases[repeats]}

    def shares(self) -> dict[str, list[Share]]:
        """Each quantity of `ROWS` without and with repeats; those that no case concerns are left out."""
        counted = {row.quantity: [_count(part, row) for part in self.parts.values()] for row in ROWS}
        return {quantity: both for quantity, both in counted.items() if any(one.num for one in both)}

    def by_system(self) -> dict[str, list[Share]]:
        """Of each system and part: the share of right verdicts."""
        row = next(row for row in ROWS if row.column == "verdict_hit")
        systems = sorted(self.cases["system"].unique())
        return {s: [_count(part[part["system"] == s], row) for part in self.parts.values()] for s in systems}

    def means(self) -> dict[str, list[Mean]]:
        """Means without and with repeats; those of no case are left out."""

        def mean(column: str, least: float) -> list[Mean]:
            values = [part[column][_between(least)(part)].dropna().to_numpy(float) for part in self.parts.values()]
            return [Mean(float(x.mean()) if x.size else float("nan"), x.size, interval_of_mean(x)) for x in values]

        of_all = {
            "probability of the true effect, its twins included, gap/noise ≥ 1": mean("true_probability", WEAK),
            "ranked first, a group of at most three counted as 1/size, gap/noise ≥ 1": mean("ranked_share", WEAK),
            "share of the effects' parameters whose 95 % interval holds the truth": mean("covered", 0.0),
        }
        return {quantity: both for quantity, both in of_all.items() if any(of.num for of in both)}

    def confusion(self) -> pd.DataFrame:
        """True verdicts in rows, reported ones in columns: counts."""
        return pd.crosstab(self.cases["truth"], self.cases["verdict"])

    def confused_effects(self) -> dict[str, tuple[int, dict[str, int]]]:
        """Of each single effect that was not the most probable one everywhere: on how many rigs it was missing, and how
        often something else was reported, most frequent first: the first effect that was selected, or the verdict where
        none was."""
        found: dict[str, tuple[int, dict[str, int]]] = {}
        for effect, cases in self.single().groupby("effect"):
            wrong = cases[(cases["ranked_first"] < 1.0) & (cases["established"] < 1.0)]
            first = wrong["selected"].str.split(",").str[0]
            reported = first.where(first != "", wrong["verdict"])[first != effect]
            if len(reported):
                found[str(effect)] = (len(cases), {str(name): int(n) for name, n in reported.value_counts().items()})
        return found

    def single(self) -> pd.DataFrame:
        """The cases with one missing effect of the library."""
        return self.cases[self.cases["established"].notna()]

    def misses(self) -> pd.DataFrame:
        """The cases that were answered wrongly, the strongest first."""
        checks = ("established", "verdict_hit", "pair_both", "fault_signal")
        columns = [self.cases[name].astype(float) for name in checks]
        # Of each case the strictest check that concerns it.
        right = columns[0].combine_first(columns[2]).combine_first(columns[3]).combine_first(columns[1])
        return self.cases[right < 1.0].sort_values("gap_noise", ascending=False, na_position="last")


def _count(cases: pd.DataFrame, row: Row) -> Share:
    values = cases[row.column][row.among(cases)].dropna()
    return share(int(values.sum()), len(values))


def results(folders: Folders, told: Folders = (), *, map_file: Path | None = None) -> Results:
    """The results of several series, each a folder of truths and one of reports; `told`: of some of them the truths
    and what `tell` wrote; `map_file`: another calibration.json than the shipped one. Raises ValueError as `score`,
    `judged` and `read_content` do, where no series is given, and where one was told that is not given."""
    if not folders:
        raise ValueError("no series: expected at least one folder of truths with its folder of reports")
    oracles = {sealed.resolve(): reports for sealed, reports in told}
    if unknown := oracles.keys() - {sealed.resolve() for sealed, _ in folders}:
        raise ValueError(f"{min(unknown)}: expected the truths of one of the series, too")
    series = [_scored(sealed, reports, oracles.get(sealed.resolve())) for sealed, reports in folders]
    content = read_content(map_file) if map_file else shipped_content()
    return Results(cases=pd.concat(series), judged=tuple(judged(folders)), content=content)


def _scored(sealed: Path, reports: Path, told: Path | None) -> pd.DataFrame:
    cases = score(sealed, reports).cases
    share = pd.Series(dtype=float) if told is None else shares_of_oracle(reports, told)
    cases["shrunk"] = _only(share.reindex(cases.index) >= ENOUGH, cases.index.isin(share.index))
    cases.index = [f"{sealed.name}/{name}" for name in cases.index]
    nothing = cases["false_alarm"].notna()
    cases["named"] = _only((cases["selected"] != "") | cases["failed"].astype(bool), nothing)
    cases["claimed"] = _only((cases["selected"] == "") & (cases["verdict"] == "unknown_effect"), nothing)
    return cases


def _only(values: pd.Series, where: pd.Series | np.ndarray) -> pd.Series:
    """`values` as numbers, NaN elsewhere."""
    return values.astype(float).where(where)
