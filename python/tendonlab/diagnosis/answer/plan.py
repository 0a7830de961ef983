"""What an experiment that a rig could be asked for has to say of itself, however the rig is driven."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

import pandas as pd

from tendonlab.fitting.case import Case
from tendonlab.simulation.records import Experiment
from tendonlab.simulation.system import System


class Played(NamedTuple):
    """The log that a model makes of a plan, without noise, and its simulation as the core gives it."""

    log: Experiment
    run: Mapping[str, Any]


class Plan(Protocol):
    """An experiment that a rig could be asked for."""

    @property
    def words(self) -> str:
        """The experiment in a report."""

    def stated(self, case: Case) -> dict[str, dict[str, float]]:
        """What the experiment states beside its signals, as `add` and `conditions` of a dataset do."""

    def reference(self, case: Case) -> pd.DataFrame:
        """What is to be played: `t` in s, and columns as the logs have them."""

    def played(self, case: Case, of: System, *, ports: bool = False) -> Played:
        """What a rig that `of` is would do, from rest, sampled as the first training experiment. `ports`: recorded too.
        Raises NumericalError where that cannot be simulated."""
