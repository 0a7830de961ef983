"""From the protocol to the map: draw a series to fit on and one to test, diagnose them, fit the map, write the page."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from tendonlab.diagnosis.answer.calibration import FILE as MAP
from tendonlab.version import version

from .calibrating import calibrate, write_map
from .drawing import draw
from .oracle import tell
from .protocol import STANDARD, read
from .reach import refuse_within_reach
from .results import results
from .results_page import write
from .resuming import plain_settings, refuse_other
from .runner import run
from .write import write_at_once

JOURNAL = "campaign.json"
COUNTS = (600, 300)
MADE_ANEW = ("fit", "page")  # each time: they take seconds, and show what was told since


class Stage(NamedTuple):
    """A stage that is done: how long it took, s, in all calls together; whether it `was_done` before this one."""

    name: str
    seconds: float
    was_done: bool


@dataclass(frozen=True)
class Series:
    """Cases that serve one purpose, below `out`, and their truths below `sealed`."""

    purpose: str
    seed: int
    count: int
    out: Path
    sealed: Path

    @property
    def folder(self) -> Path:
        return self.out / f"seed-{self.seed}"

    @property
    def cases(self) -> Path:
        return self.folder / "cases"

    @property
    def reports(self) -> Path:
        return self.folder / "reports"

    @property
    def truths(self) -> Path:
        return self.sealed / f"seed-{self.seed}"

    @property
    def told(self) -> Path:
        """Reports that tell the truth."""
        return self.sealed / f"told-{self.seed}"


def campaign(
    out: Path | str,
    *,
    sealed: Path | str,
    seeds: tuple[int, int],
    counts: tuple[int, int] = COUNTS,
    protocol: str | Path = STANDARD,
    changed: Mapping[str, Any] | None = None,
    tells: bool = False,
    jobs: int = 1,
    timeout: float = 1800.0,
    command: str = "",
    progress: bool = True,
) -> Iterator[Stage]:
    """The stages of a campaign, each when it is done; the last ones write `out`/calibration.json and the page of
    results into `out`.

    `seeds` and `counts`: of the series to fit on and of the one to test. `changed`: options of the protocol that are
    others here. `tells`: whether `tell` diagnoses the test series once more. `command`: what the page says made it.
    Truths, and a journal of what is done, go into the folder `sealed`. A campaign that was interrupted goes on where it
    stopped. Raises ValueError where a seed serves another purpose, where `sealed` and `out` lie in each other, where a
    campaign of other settings was begun there, and where the truths of series in `out` lie elsewhere.
    """
    out, sealed = Path(out).resolve(), Path(sealed).resolve()
    refuse_within_reach(sealed, out)
    by = read(protocol)
    of_purpose = dict(zip(("calibration", "test"), zip(seeds, counts, strict=True), strict=True))
    drawn = {purpose: by.drawn(seed, purpose=purpose, changed=changed) for purpose, (seed, _) in of_purpose.items()}
    settings = {
        "tendonlab": version(),
        "protocol": {name: drawn["test"]["origin"][name] for name in ("version", "sha256")},
        "changed": by.others(changed or {}),
        "seeds": seeds,
        "counts": counts,
        "timeout": timeout,
    }
    journal = Journal.open(sealed / JOURNAL, plain_settings(settings), out)
    fit, test = (Series(purpose, seed, count, out, sealed) for purpose, (seed, count) in of_purpose.items())
    pace: dict[str, Any] = {"jobs": jobs, "progress": progress}
    work: dict[str, Callable[[], object]] = {}
    for of in (fit, test):
        work |= _diagnosed(of, drawn[of.purpose], timeout=timeout, pace=pace)
    if tells:
        work[f"tell {test.purpose}"] = partial(tell, test.truths, test.cases, test.told, timeout=timeout, **pace)
    work["fit"] = partial(_fit, fit, test, out)
    work["page"] = partial(_page, test, out, tells=tells, command=command)
    return journal.through(work)


def _diagnosed(
    of: Series, drawn: Mapping[str, Any], *, timeout: float, pace: Mapping[str, Any]
) -> dict[str, Callable[[], object]]:
    return {
        f"draw {of.purpose}": partial(
            draw, of.seed, of.count, of.folder, sealed=of.truths, resumes=True, **pace, **drawn
        ),
        f"run {of.purpose}": partial(run, of.cases, of.reports, timeout=timeout, **pace),
    }


def _fit(fit: Series, test: Series, out: Path) -> None:
    write_map(calibrate([(fit.truths, fit.reports)], [(test.truths, test.reports)]), out / MAP)


def _page(test: Series, out: Path, *, tells: bool, command: str) -> None:
    told = [(test.truths, test.told)] if tells else []
    write(results([(test.truths, test.reports)], told, map_file=out / MAP), out, command)


@dataclass
class Journal:
    """What a campaign was asked for, which stages are done, and how long each took."""

    path: Path
    settings: dict[str, Any]
    done: list[str] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)

    @classmethod
    def open(cls, path: Path, settings: dict[str, Any], out: Path) -> Journal:
        """The journal of the campaign that was begun here, or a new one. Raises ValueError where the settings of that
        campaign are others, and for a new one where `out` holds series: their truths lie elsewhere."""
        if not path.exists():
            for series in sorted(out.glob("seed-*")):
                raise ValueError(f"{path} is missing: expected it beside the truths of {series}, or another OUT")
            path.parent.mkdir(parents=True, exist_ok=True)
            return cls(path, settings)
        kept = json.loads(path.read_text(encoding="utf-8"))
        refuse_other(path, kept["settings"], settings)
        return cls(path, settings, kept["done"], kept["seconds"])

    def through(self, work: Mapping[str, Callable[[], object]]) -> Iterator[Stage]:
        """Do what is not done yet, stage after stage."""
        for name, stage in work.items():
            was_done = name in self.done and name not in MADE_ANEW
            if not was_done:
                self._do(name, stage)
            yield Stage(name, self.seconds[name], was_done)

    def _do(self, name: str, stage: Callable[[], object]) -> None:
        began = time.monotonic()
        before = 0.0 if name in MADE_ANEW else self.seconds.get(name, 0.0)
        self._save()
        try:
            stage()
            self.done = [*self.done, name]
        finally:
            self.seconds[name] = before + time.monotonic() - began
            self._save()

    def _save(self) -> None:
        content = {"settings": self.settings, "done": sorted(set(self.done)), "seconds": self.seconds}
        write_at_once(self.path, json.dumps(content, indent=1) + "\n")
