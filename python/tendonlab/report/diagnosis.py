"""What a diagnosis found: the four answers (where, which, how far, what next) as one frozen value."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from tendonlab.errors import ParameterError
from tendonlab.report.words import STAGES, VERDICTS
from tendonlab.simulation.equality import EqualByFields
from tendonlab.version import version

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

FORMAT = "tendonlab-diagnosis/1"
Floats = NDArray[np.float64]


_DRAWN: Mapping[str, Any] = {"write": None}  # metadata of a field that report.json leaves out
_BY_ROW: Mapping[str, Any] = {"write": lambda frame: frame.to_dict(orient="index")}


def _empty_table() -> pd.DataFrame:
    import pandas as pd

    return pd.DataFrame(columns=list(STAGES), dtype=float)


@dataclass(frozen=True, kw_only=True, eq=False)
class EffectFinding(EqualByFields):
    """One candidate effect: how probable it is and what it would do.

    `probability` is marginal: that this effect is part of the cause. `parameters`: name -> {value, ci95, unit}, in the
    unit stated. `held_out_gain`: {mean, se}, nats of predictive log score over the refitted simulator. `shrinkage`:
    {value, ci95} of the held-out gap, or None where the gap is 0. `extra`: evidence by name, nats.
    """

    effect: str
    element: str
    probability: float
    parameters: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    held_out_gain: Mapping[str, float] | None = None
    shrinkage: Mapping[str, Any] | None = None
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """`element:effect`, as in `Diagnosis.selected`."""
        return f"{self.element}:{self.effect}"

    def to_dict(self) -> dict[str, Any]:
        """Plain types, field by field."""
        return {f.name: plain(getattr(self, f.name), key=f.name) for f in fields(self)}


@dataclass(frozen=True, kw_only=True, eq=False)
class Overlay(EqualByFields):
    """One held-out experiment with its three predictions.

    `time` has shape (n,), s; the arrays per signal have shape (n,) in its unit, NaN where not measured. `floor` is
    the noise floor of each signal, RMS in its unit. `inputs`: what was logged of the inputs, (n,) each. Raises
    ParameterError if an array has another shape.
    """

    name: str
    time: Floats
    measured: Mapping[str, Floats]
    nominal: Mapping[str, Floats]
    refitted: Mapping[str, Floats]
    with_effect: Mapping[str, Floats]
    floor: Mapping[str, float]
    inputs: Mapping[str, Floats] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, values in self.inputs.items():
            _require_shape(f"inputs[{name!r}]", values, np.shape(self.time))
        for signal in self.measured:
            for stage in ("measured", *STAGES):
                _require_shape(f"{stage}[{signal!r}]", getattr(self, stage).get(signal), np.shape(self.time))


@dataclass(frozen=True, kw_only=True, eq=False)
class WhereMap(EqualByFields):
    """Where in motion (and position or load) of one port of an element its residual lies. `place`: the port in words.

    `x_edges` (nx + 1,) and `y_edges` (ny + 1,) bound the cells, in `x_unit` and `y_unit`; `refitted` and `with_effect`,
    shape (ny, nx), are RMS residuals over the noise floor, NaN in cells without data. Raises ParameterError on other
    shapes.
    """

    element: str
    place: str
    x: str
    x_unit: str
    x_edges: Floats
    y: str
    y_unit: str
    y_edges: Floats
    refitted: Floats
    with_effect: Floats

    def __post_init__(self) -> None:
        shape = (len(self.y_edges) - 1, len(self.x_edges) - 1)
        for stage in ("refitted", "with_effect"):
            _require_shape(f"where_map of {self.place}: {stage}", getattr(self, stage), shape)


@dataclass(frozen=True, kw_only=True, eq=False)
class SideTable(EqualByFields):
    """A further table for the report, e.g. a comparison by inverse dynamics. The index is shown where it has a name."""

    title: str
    frame: pd.DataFrame
    note: str = ""


@dataclass(frozen=True, kw_only=True, eq=False)
class Diagnosis(EqualByFields):
    """Why the simulator and the rig disagree. Its fields are the keys of report.json, which docs/datasets.md explains;
    those with `write` None in their metadata are only drawn.

    `gap` is by output, RMS in its unit: noise_floor, nominal, refitted, with_effect, on held-out experiments. `units`:
    unit of every signal and coordinate. `held_out`: one row per held-out experiment, columns nominal, refitted,
    with_effect: the gap there, pooled over outputs, in noise floors. `data`: problems of the logs, worst first, each
    with problem, signal, experiment, detail and blocks. `caveats`: what a reader must know before any number.
    `references`: motions of `next_experiments` by file name, as `report` writes them: `t`, s, and the reference.
    `overlays`: every held-out experiment, the one that tuning leaves worst first. `split`: names under "train" and
    "test". `details`: whatever else says how it was computed. Raises ParameterError where a part of the contract is
    missing or the verdict is unknown.
    """

    dataset: str
    system: str
    seed: int
    seconds: float
    verdict: str
    verdict_probability: Mapping[str, float]
    calibrated: bool = False
    replay: Mapping[str, Any]
    gap: Mapping[str, Mapping[str, float]]
    where: Mapping[str, Sequence[Mapping[str, Any]]]
    effects: tuple[EffectFinding, ...]
    sets: tuple[Mapping[str, Any], ...]
    selected: tuple[str, ...]
    explained: float | None
    indistinguishable: tuple[tuple[str, ...], ...]
    invisible: tuple[str, ...]
    shrinkage: Mapping[str, Mapping[str, Any] | None]
    next_experiments: tuple[Mapping[str, Any], ...]
    data: tuple[Mapping[str, Any], ...] = ()
    warnings: tuple[str, ...]
    caveats: tuple[str, ...] = ()
    held_out: pd.DataFrame = field(default_factory=_empty_table, metadata=_BY_ROW)
    split: Mapping[str, Sequence[str]] = field(default_factory=dict)
    details: Mapping[str, Any] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict, metadata=_DRAWN)
    references: Mapping[str, pd.DataFrame] = field(default_factory=dict, metadata=_DRAWN)
    overlays: tuple[Overlay, ...] = field(default=(), metadata=_DRAWN)
    where_map: tuple[WhereMap, ...] = field(default=(), metadata=_DRAWN)
    table: SideTable | None = field(default=None, metadata=_DRAWN)

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise ParameterError(f"verdict = {self.verdict!r}: expected one of {', '.join(VERDICTS)}")
        _require_keys("verdict_probability", self.verdict_probability, VERDICTS)
        _require_keys("replay", self.replay, ("kind",))
        _require_keys("where", self.where, ("signals", "elements", "regimes"))
        _require_keys("shrinkage", self.shrinkage, ("from_nominal", "from_refitted"))
        for place, entry in enumerate(self.data):
            _require_keys(f"data[{place}]", entry, ("problem", "signal", "experiment", "detail", "blocks"))
        for signal, values in self.gap.items():
            _require_keys(f"gap of {signal}", values, ("noise_floor", *STAGES))
        for name in self.selected:
            if ":" not in name:
                raise ParameterError(f"selected: {name!r}: expected element:effect, such as joint:stribeck")

    @property
    def sentence(self) -> str:
        """The verdict in one plain sentence, with its probability and what it does to the gap."""
        from tendonlab.report.sentence import sentence

        return sentence(self)

    def to_dict(self) -> dict[str, Any]:
        """The content of report.json, as docs/datasets.md explains it: plain types, None in place of NaN."""
        body = {f.name: (f.metadata.get("write", _as_it_is), getattr(self, f.name)) for f in fields(self)}
        written = {name: plain(write(value), key=name) for name, (write, value) in body.items() if write is not None}
        return {"format": FORMAT, "tendonlab": version(), **written}

    def plot(self, ax: Axes | None = None) -> Axes:
        """The candidate effects, most probable first, on `ax` or on new axes."""
        from tendonlab.report.plot import ranked_effects

        return ranked_effects(self, ax)

    def report(self, out: str | Path, *, figures: bool = True) -> Path:
        """Write report.html, report.json, the references of proposed motions (next-1.csv, …) and (with `figures`) each
        figure as PNG and SVG into folder `out`.

        Returns the path of report.html. The folder is made where it does not exist."""
        from tendonlab.report import write_report

        return write_report(self, Path(out), figures=figures)

    def __repr__(self) -> str:
        chosen = f", selected={list(self.selected)}" if self.selected else ""
        return f"Diagnosis({self.dataset!r}, verdict={self.verdict!r}{chosen})"

    def _repr_html_(self) -> str:
        from tendonlab.report import effects_table

        caveats = "".join(f"<p>{escape(caveat)}</p>" for caveat in self.caveats)
        return f"<p><b>{escape(self.sentence)}</b></p>{caveats}{effects_table(self)}"


def _as_it_is(value: Any) -> Any:
    return value


def plain(value: Any, *, key: str = "value") -> Any:
    """`value` in JSON's own types: arrays and tuples as lists, numbers as int and float, None for NaN and infinity.

    Raises ParameterError, which names the key, for a type that has no such form."""
    if isinstance(value, np.generic | np.ndarray):
        value = value.tolist()
    if value is None or isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, EffectFinding):
        return value.to_dict()
    if isinstance(value, Mapping):
        return {str(name): plain(item, key=f"{key}.{name}") for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item, key=f"{key}[{index}]") for index, item in enumerate(value)]
    raise ParameterError(f"{key} is a {type(value).__name__}: expected a number, text, list or mapping")


def _require_keys(name: str, mapping: Mapping[str, Any], keys: Collection[str]) -> None:
    missing = [key for key in keys if key not in mapping]
    if missing:
        raise ParameterError(f"{name} lacks {', '.join(missing)}: expected {', '.join(keys)}")


def _require_shape(name: str, array: Any, shape: tuple[int, ...]) -> None:
    if array is None or np.shape(array) != shape:
        raise ParameterError(f"{name} has shape {np.shape(array)}: expected {shape}")
