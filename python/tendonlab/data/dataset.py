"""What `load` returns: experiments as frames in SI units, and everything that dataset.toml says about them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tendonlab.errors import DatasetError, ParameterError, expected_one_of
from tendonlab.simulation.equality import EqualByFields
from tendonlab.simulation.records import Controller, Experiment, NominalParameter, SignalSpec
from tendonlab.simulation.system import System, require_system

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(frozen=True, kw_only=True, eq=False)
class Dataset(EqualByFields):
    """A checked dataset: a rig's logs and the simulator they are compared with. What `load` gives.

    `dataset["sweep-1"]` is one experiment (DatasetError where there is none of that name), and looping gives them all.
    `kind`, `axis` ("rotary" or "linear"), `nominal_effects` and `parameters` (value, sd, bounds, SI) describe the
    simulator; `controller` closes its loop where it is known; `signals`: what was recorded, by name; `warnings`: what
    was assumed, in words."""

    name: str
    description: str = field(repr=False)
    kind: str
    axis: str
    nominal_effects: tuple[str, ...]
    parameters: dict[str, NominalParameter] = field(repr=False)
    controller: Controller | None = field(repr=False)
    signals: dict[str, SignalSpec] = field(repr=False)
    experiments: tuple[Experiment, ...] = field(repr=False)
    path: Path = field(repr=False)
    warnings: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> Experiment:
        for experiment in self.experiments:
            if experiment.name == name:
                return experiment
        known = [experiment.name for experiment in self.experiments]
        raise DatasetError(f"{self.name}: no experiment {name!r}; {expected_one_of(name, known)}")

    def __iter__(self) -> Iterator[Experiment]:
        return iter(self.experiments)

    def __len__(self) -> int:
        return len(self.experiments)

    def __contains__(self, name: object) -> bool:
        """Whether an experiment has that name, or is one of these."""
        return any(name == experiment.name or name is experiment for experiment in self.experiments)

    @property
    def train(self) -> tuple[Experiment, ...]:
        """The experiments to fit."""
        return tuple(experiment for experiment in self.experiments if experiment.split == "train")

    @property
    def test(self) -> tuple[Experiment, ...]:
        """The experiments held out."""
        return tuple(experiment for experiment in self.experiments if experiment.split == "test")

    @property
    def inputs(self) -> tuple[str, ...]:
        """Names of the system's inputs that were recorded."""
        return self._with_role("input")

    @property
    def outputs(self) -> tuple[str, ...]:
        """Names of the system's outputs that were measured."""
        return self._with_role("output")

    def system(self) -> System:
        """The simulator that the dataset describes, with its nominal parameters."""
        return System(
            kind=self.kind,
            parameters={name: parameter.value for name, parameter in self.parameters.items()},
            effects=self.nominal_effects,
            axis=self.axis,
            controller=self.controller,
        )

    def plot(self, ax: Axes | None = None, *, signal: str | None = None) -> Axes:
        """Draw `signal` (the first output) of every experiment against time on `ax`, or on the current axes.

        Raises DatasetError for a signal that was not recorded."""
        import matplotlib.pyplot as plt

        name = self.outputs[0] if signal is None else signal
        if name not in self.signals:
            raise DatasetError(f"{self.name}: no signal {name!r}; {expected_one_of(name, self.signals)}")
        ax = plt.gca() if ax is None else ax
        for experiment in self.experiments:
            ax.plot(experiment.time, experiment.data[name], ".", ms=2, label=f"{experiment.name} ({experiment.split})")
        ax.set(xlabel="time (s)", ylabel=f"{name} ({self.signals[name].si_unit})")
        ax.legend()
        return ax

    def to_dict(self) -> dict[str, Any]:
        """What the dataset holds, in plain types and without the samples."""
        experiments = [
            {"name": e.name, "split": e.split, "repeat": e.repeat, "num_samples": len(e.data), "duration": e.duration}
            for e in self.experiments
        ]
        return {
            "name": self.name,
            "system": self.kind,
            "axis": self.axis,
            "nominal_effects": list(self.nominal_effects),
            "inputs": list(self.inputs),
            "outputs": list(self.outputs),
            "experiments": experiments,
            "warnings": list(self.warnings),
        }

    def __repr__(self) -> str:
        fit = "1 experiment" if len(self.train) == 1 else f"{len(self.train)} experiments"
        size = f"{fit} to fit, {len(self.test)} held out"
        return f"Dataset({self.name!r}: {self.kind}, {self.axis}; {size})"

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><td>{escape(e.name)}</td><td>{e.split}</td><td>{escape(e.repeat or '')}</td>"
            f"<td>{len(e.data)}</td><td>{e.duration:.3g}</td></tr>"
            for e in self.experiments
        )
        notes = "".join(f"<li>{escape(warning)}</li>" for warning in self.warnings)
        return (
            f"<p><b>{escape(self.name)}</b>: {self.kind}, {self.axis}; in: {', '.join(self.inputs)}; "
            f"out: {', '.join(self.outputs)}</p><table><tr><th>experiment</th><th>split</th><th>repeat</th>"
            f"<th>samples</th><th>duration (s)</th></tr>{rows}</table><ul>{notes}</ul>"
        )

    def _with_role(self, role: str) -> tuple[str, ...]:
        return tuple(name for name, spec in self.signals.items() if spec.role == role)


def simulator_of(dataset: Dataset, system: object) -> System:
    """`system`, or the dataset's own where it is None. Raises ParameterError for anything but a system of its kind."""
    if system is None:
        return dataset.system()
    checked = require_system(system)
    if checked.kind != dataset.kind:
        raise ParameterError(f"system is a {checked.kind}, and {dataset.name} a {dataset.kind}: expected the same kind")
    return checked


def require_dataset(given: object) -> None:
    """Raise ParameterError for anything but a dataset, such as the folder of one."""
    if not isinstance(given, Dataset):
        raise ParameterError(f"dataset = {given!r:.60}: expected a Dataset, which tendonlab.load makes of a folder")
