"""What a simulation gives: outputs at the instants of the experiment."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


@dataclass(frozen=True, kw_only=True)
class Trajectory:
    """A simulated run. `outputs`: indexed by time "t", s, one column a signal, SI. `ports`: the same with columns
    (port, "velocity" | "position" | "load" | "force") where asked for. `num_attempts`, `num_events`: of the stepper."""

    outputs: pd.DataFrame = field(repr=False)
    units: dict[str, str] = field(repr=False)
    ports: pd.DataFrame | None = field(default=None, repr=False)
    num_attempts: int = 0
    num_events: int = 0

    def __getitem__(self, signal: str) -> pd.Series:
        return self.outputs[signal]

    def plot(self, ax: Axes | None = None, *, signal: str | None = None) -> Axes:
        """Draw one output (the first unless named) against time."""
        import matplotlib.pyplot as plt

        ax = plt.gca() if ax is None else ax
        name = str(self.outputs.columns[0]) if signal is None else signal
        ax.plot(self.outputs.index, self.outputs[name], lw=1.0, label=name)
        ax.set(xlabel="time (s)", ylabel=f"{name} ({self.units[name]})")
        return ax

    def to_dict(self) -> dict[str, Any]:
        """Time and outputs as lists."""
        return {"t": self.outputs.index.tolist(), **{str(c): self.outputs[c].tolist() for c in self.outputs.columns}}

    def _repr_html_(self) -> str:
        return str(self.outputs.describe().to_html())
