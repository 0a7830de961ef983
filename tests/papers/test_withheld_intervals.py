"""The intervals of effects that S2's and S4's notebooks print hold the twin's values, over new draws of its noise."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.papers import s2, s4

pytestmark = pytest.mark.slow
SEEDS = 20
RIG = s2.constants()


def once(simulate: Callable[..., pd.DataFrame]) -> Callable[..., pd.DataFrame]:
    """The runs of a twin without its noise, each computed once."""
    known: dict[str, pd.DataFrame] = {}

    def run(*args: Any, **options: Any) -> pd.DataFrame:
        motion = [a.angle.tobytes() if isinstance(a, s2.Reference) else a for a in args]
        key = repr((motion, options))
        if key not in known:
            known[key] = simulate(*args, **options)
        return known[key]

    return run


def judged(fits: list[tl.Identification], name: str, truth: float) -> tuple[float, float]:
    """Share of the intervals that hold the truth, and their width over that which the scatter demands."""
    low, high = np.array([fit.ci95(name) for fit in fits]).T
    spread = np.std([fit.values[name] for fit in fits], ddof=1)
    return float(np.mean((low <= truth) & (truth <= high))), float(np.mean(high - low) / (2 * 1.96 * spread))


@pytest.mark.parametrize(
    ("withheld", "effect", "name", "truth", "widest"),
    [
        ({"hold": True, "repeated": True}, "stiction:hold", "stiction_hold", 1.0, 2.5),  # over 100 seeds: 1.4
        ({"path_error": 3e-4}, "cable:preload_variation", "cable_preload_variation", 3e-4 * RIG.K, 1.5),
    ],
)
def test_intervals_of_s2(
    withheld: dict[str, Any], effect: str, name: str, truth: float, widest: float, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """Half of the estimates of the hold end at its bound, so that the scatter of twenty says little."""
    monkeypatch.setattr("tendonlab.papers.s2.rig.simulate", once(s2.simulate))
    logs = (s2.write_dataset(tmp_path / str(seed), RIG, **withheld, seed=seed) for seed in range(SEEDS))
    held, width = judged([tl.identify(log, effects=[effect], progress=False) for log in logs], name, truth)
    assert held >= 0.85  # of 20 at 95 %: fewer has probability 0.02
    assert width <= widest


def test_intervals_of_s4(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of the asymmetry of the contacts and of the compliance of the ends, together."""
    monkeypatch.setattr("tendonlab.papers.s4.dataset.run_rig", once(s4.run_rig))
    asymmetry, compliance = (0.178 - 0.155) / (0.178 + 0.155), 1.0 / (5 * 5.023e4)
    cases = [("E1", False, "contact:asymmetry", "contact_coefficient_asymmetry", asymmetry)]
    cases += [("E2", True, "ends:compliance", "ends_compliance", compliance)]
    found = []
    for case, knows_direction, effect, name, truth in cases:
        of, believed = s4.case(case), s4.nominal(knows_direction=knows_direction)
        folders = (tmp_path / case / str(seed) for seed in range(SEEDS))
        logs = (tl.load(s4.write_rig(folder, of, believed, name="rig", seed=k)) for k, folder in enumerate(folders))
        found.append(judged([tl.identify(log, effects=[effect], progress=False) for log in logs], name, truth))
    held, width = np.mean(found, axis=0)
    assert held >= 0.875  # of 40 at 95 %: fewer has probability 0.02
    assert width <= 1.5
