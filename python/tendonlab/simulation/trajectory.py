"""What a simulation gives: outputs at the instants of the experiment."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING, Any

from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.simulation.catalog import PORT_QUANTITIES, SystemInfo, unit
from tendonlab.simulation.equality import EqualByFields

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    from matplotlib.axes import Axes


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory(EqualByFields):
    """A simulated run; `run["joint_angle"]` is one output. `outputs`: by time "t", s, with one column per signal, SI.

    `units`: of each output. `ports`: a frame with columns (port, "velocity" | "position" | "load" | "force") where it
    was asked for. `num_attempts`: steps that were tried; `num_events`: reversals, stops and edges that were met."""

    outputs: pd.DataFrame = field(repr=False)
    units: dict[str, str] = field(repr=False)
    ports: pd.DataFrame | None = field(default=None, repr=False)
    num_attempts: int = 0
    num_events: int = 0

    def __getitem__(self, signal: str) -> pd.Series:
        return self.outputs[self._known(signal)]

    def plot(self, ax: Axes | None = None, *, signal: str | None = None) -> Axes:
        """Draw one output (the first unless named) against time on `ax`, or on the current axes.

        Raises ParameterError for an output that the system does not have."""
        import matplotlib.pyplot as plt

        ax = plt.gca() if ax is None else ax
        name = str(self.outputs.columns[0]) if signal is None else self._known(signal)
        ax.plot(self.outputs.index, self.outputs[name], lw=1.0, label=name)
        ax.set(xlabel="time (s)", ylabel=f"{name} ({self.units[name]})")
        return ax

    def _known(self, signal: str) -> str:
        known = [str(c) for c in self.outputs.columns]
        if not isinstance(signal, str):
            raise ParameterError(f"{signal!r} is no output: expected one name; `outputs` is the frame of all")
        if signal not in known:
            raise ParameterError(f"{signal!r} is no output; {expected_one_of(signal, known)}")
        return signal

    def to_dict(self) -> dict[str, Any]:
        """Time and outputs as lists."""
        return {"t": self.outputs.index.tolist(), **{str(c): self.outputs[c].tolist() for c in self.outputs.columns}}

    def __repr__(self) -> str:
        time = self.outputs.index
        span = f", {time[0]:g} to {time[-1]:g} s" if len(time) else ""
        return f"Trajectory({', '.join(map(str, self.outputs.columns))}; {len(time)} samples{span})"

    def _repr_html_(self) -> str:
        return str(self.outputs.describe().to_html())


def trajectory_of(run: dict[str, Any], info: SystemInfo, *, axis: str, time: np.ndarray) -> Trajectory:
    """What the core returned, as frames."""
    import pandas as pd

    index = pd.Index(time, name="t")
    units = {s.name: unit(s.dimension, axis) for s in info.outputs}
    return Trajectory(
        outputs=pd.DataFrame(run["outputs"].T, index=index, columns=_columns(info)),
        units=units,
        ports=_port_frame(run["ports"], info, index) if "ports" in run else None,
        num_attempts=run["attempts"],
        num_events=run["events"],
    )


@cache
def _columns(info: SystemInfo) -> pd.Index[str]:
    import pandas as pd

    return pd.Index([s.name for s in info.outputs])


def _port_frame(ports: np.ndarray, info: SystemInfo, index: pd.Index[float]) -> pd.DataFrame:
    import pandas as pd

    quantities = [[p.name for p in info.ports], PORT_QUANTITIES]
    columns = pd.MultiIndex.from_product(quantities, names=["port", "quantity"])
    return pd.DataFrame(ports.reshape(-1, ports.shape[-1]).T, index=index, columns=columns)
