"""What a diagnosis reaches that is told the missing effects: the most that a right verdict could shrink the gap."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from .runner import REPORT, cases_in, command, run_all
from .scoring import truth_of

Report = Mapping[str, Any]


def tell(
    sealed: Path | str,
    cases: Path | str,
    out: Path | str,
    *,
    jobs: int = 1,
    timeout: float = 1800.0,
    progress: bool = True,
) -> Path:
    """Diagnose the cases that lack effects of the library once more, told which, into `out`/<id>; return `out`.

    Cases that have a report there are skipped. A case that fails leaves none. Raises ValueError where `cases` holds no
    dataset, where a truth is missing, or where `out` lies in the folder that holds the cases: these reports tell the
    truth, and a diagnosis may run there."""
    sealed, cases, out = Path(sealed), Path(cases).resolve(), Path(out).resolve()
    if cases.parent in out.parents:
        raise ValueError(f"{out}: these reports tell the truth; expected a folder outside {cases.parent}")
    commands = {}
    for case in cases_in(cases):
        missing = truth_of(sealed, case.name)
        if missing["verdict"] == "effect":
            commands[case.name] = [*command(case, out / case.name), "--library", *missing["effects"]]
    run_all(commands, out, jobs=jobs, timeout=timeout, progress=progress)
    return out


def shares_of_oracle(reports: Path, told: Path) -> pd.Series:
    """By how much each case's held-out gap shrank, over what the diagnosis that was told reached, both over the floor
    of the latter; indexed by case. Left out: cases without a gap to shrink, and those where being told does not help.
    A case without a report, or whose logs were refused, shrank nothing."""
    shares: dict[str, float] = {}
    for path in sorted(told.glob(f"*/{REPORT}")):
        name, best = path.parent.name, _read(path)
        reached = _shrinkage(best, best)
        if reached > 0.0:
            own = reports / name / REPORT
            shares[name] = _shrinkage(_read(own), best) / reached if own.exists() else 0.0
    return pd.Series(shares, dtype=float)


def _read(path: Path) -> Report:
    report: Report = json.loads(path.read_text(encoding="utf-8"))
    return report


def _shrinkage(report: Report, best: Report) -> float:
    """1 - gap with effects / gap of the refitted simulator, over the noise floor that `best` reached; 0 where either
    was refused as a fault of the data, which fits nothing."""
    if "data_fault" in (report["verdict"], best["verdict"]):
        return 0.0
    rows = [(report["gap"].get(name), of["noise_floor"], of["refitted"]) for name, of in best["gap"].items()]
    after, floor, before = np.array([(own["with_effect"] if own else first, f, first) for own, f, first in rows]).T
    gaps = [np.sqrt(max(0.0, np.mean(np.square(level / floor)) - 1.0)) for level in (after, before)]
    return float(1.0 - gaps[0] / gaps[1]) if gaps[1] > 0 else 0.0
