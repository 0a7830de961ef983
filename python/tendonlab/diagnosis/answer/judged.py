"""The models of a search on the experiments that judge them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from tendonlab.diagnosis.answer import heldout
from tendonlab.diagnosis.answer.heldout import Replayed
from tendonlab.diagnosis.search.select import Search
from tendonlab.errors import NumericalError
from tendonlab.fitting.case import Case
from tendonlab.fitting.floor import Sensitivities, estimate, sensitivities
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.problem import initial_state
from tendonlab.simulation.system import System

ESCAPED = 10.0  # ratio of mean squares on held-out runs: a fitted simulator that errs so much more ran away


@dataclass(frozen=True)
class Judged:
    """`stages`: the simulator untouched ("nominal"), tuned ("refitted") and with all effects that were established
    ("with_effect"); `steps`: tuned, then with each effect more; `experiments`: those that all of these can simulate;
    `failed`: why another one could not be simulated, by its name."""

    case: Case
    floor: Floor
    stages: dict[str, Replayed]
    steps: tuple[Replayed, ...]
    experiments: tuple[int, ...]
    failed: dict[str, str]

    @classmethod
    def of(cls, case: Case, floor: Floor, search: Search) -> Judged:
        """All models replayed as `case` does; an effect that was established stands out of the `floor`. Raises
        NumericalError where no experiment can be simulated."""
        everywhere = case.test or case.train
        models = [[case.system] * len(everywhere), *(heldout.models(case, model, everywhere) for model in search.path)]
        (untouched, *steps), experiments, failed = heldout.replay_all(case, models, everywhere)
        if search.selected:
            floor = floor.reached_by(heldout.rms(steps[-1]))
        stages = {"nominal": untouched, "refitted": steps[0], "with_effect": steps[-1]}
        return cls(case, floor, stages, tuple(steps), tuple(experiments), failed)

    @classmethod
    def in_loop(cls, case: Case, search: Search) -> Judged:
        """The same in the closed loop that `case` simulates, over the floor that the last simulator shows there. Raises
        NumericalError also where a simulator that was fitted without the loop runs away in it."""
        seen = [_sensitivities(case, search.final.system, i) for i in range(len(case.experiments))]
        judged = cls.of(case, estimate(case, seen, case.train), search)
        untouched, *fitted = judged.errors().values()
        if max(fitted) ** 2 > ESCAPED * max(1.0, untouched**2):
            raise NumericalError("a fitted simulator errs far more than the untouched one")
        return judged

    def errors(self) -> dict[str, float]:
        """Held-out error of each stage over the floor, rms over the outputs."""
        return {stage: heldout.level(of, self.floor) ** 0.5 for stage, of in self.stages.items()}

    def gap(self) -> dict[str, dict[str, float]]:
        """Floor and rms error of each stage, of every measured output."""
        errors, names = {stage: heldout.rms(of) for stage, of in self.stages.items()}, self.case.outputs
        return {
            names[c]: {"noise_floor": float(self.floor.rms[c]), **{stage: float(e[c]) for stage, e in errors.items()}}
            for c in self.case.measured
        }

    def shrinkage(self, seed: int) -> dict[str, dict[str, Any]]:
        """How far the gap shrinks from either stage to the last."""
        rng, last = np.random.default_rng(seed), self.stages["with_effect"]
        return {
            f"from_{stage}": heldout.shrinkage(self.case, self.stages[stage], last, self.floor, self.experiments, rng)
            for stage in ("nominal", "refitted")
        }

    def table_of_steps(self, search: Search) -> list[dict[str, Any]]:
        """Held-out rms of every output after the refit and after each effect that was added."""
        names, measured = self.case.outputs, self.case.measured
        return [
            {"effects": list(model.added), "rms": {names[c]: float(heldout.rms(run)[c]) for c in measured}}
            for model, run in zip(search.path, self.steps, strict=True)
        ]

    def per_experiment(self) -> pd.DataFrame:
        """The gap of each experiment (row) at each stage (column), in noise floors."""
        rows = {
            stage: [heldout.gap(heldout.row_mean_squares(r), self.floor.rms) for r in of.residuals]
            for stage, of in self.stages.items()
        }
        names = [self.case.experiments[i].name for i in self.experiments]
        return pd.DataFrame(rows, index=pd.Index(names, name="experiment"))


def _sensitivities(case: Case, system: System, i: int) -> Sensitivities:
    """Of one experiment; unknown where it is held out and cannot be simulated."""
    try:
        return sensitivities(case, system, i, initial_state(case, system, i))
    except NumericalError:
        if i in case.train:
            raise
        return Sensitivities.unknown(case.prepared[i].measured)
