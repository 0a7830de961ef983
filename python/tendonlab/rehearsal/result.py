"""What a rehearsal found, as one frozen value."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.rehearsal.tally import EffectRehearsal, ReliabilityBin, Share
from tendonlab.report.diagnosis import plain
from tendonlab.simulation.equality import EqualByFields
from tendonlab.version import version

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

FORMAT = "tendonlab-rehearsal/1"


@dataclass(frozen=True, kw_only=True, eq=False)
class Rehearsal(EqualByFields):
    """Which effects a diagnosis of these experiments would find, from simulated rigs that have them.

    `effects`: one entry per effect, those found at the smallest gap first. `nothing`: of the rigs from which nothing
    was withheld, the shares in which an "effect" was named, an "unknown_effect" or a "data_fault" claimed;
    `false_effects`: which effects those were, with counts. `on_truth`: mean probability given to the truth; None
    without cases. `reliability`: stated probabilities beside how often they were right. `cases`: one row per
    diagnosis, indexed by its name. `num_left_out`: cases for which there was no time. `sizes`: gaps over noise that
    were asked for. `notes`: what was assumed, in words. `planned`: whether the experiments are planned ones."""

    dataset: str
    system: str
    seed: int
    seconds: float
    planned: bool
    sizes: tuple[float, ...]
    effects: tuple[EffectRehearsal, ...]
    nothing: Mapping[str, Share]
    false_effects: Mapping[str, int]
    on_truth: float | None
    reliability: tuple[ReliabilityBin, ...]
    num_left_out: int
    interrupted: bool = False
    notes: tuple[str, ...] = ()
    cases: pd.DataFrame = field(repr=False)

    def __getitem__(self, effect: str) -> EffectRehearsal:
        names = [entry.effect for entry in self.effects]
        if effect not in names:
            raise ParameterError(f"{effect!r} was not rehearsed; {expected_one_of(effect, names)}")
        return self.effects[names.index(effect)]

    @property
    def sentences(self) -> tuple[str, ...]:
        """One plain sentence or two per effect."""
        from tendonlab.rehearsal.words import effect_words

        return tuple(effect_words(entry, self.system) for entry in self.effects)

    def plot(self, ax: Axes | None = None, *, effect: str | None = None) -> Axes:
        """Draw the detection curve of `effect` (the first unless named) on `ax`, or on new axes.

        Raises ParameterError for an effect that was not rehearsed."""
        from tendonlab.rehearsal.figure import detection_curve

        return detection_curve(self.effects[0] if effect is None else self[effect], ax)

    def to_dict(self) -> dict[str, Any]:
        """The content of rehearsal.json, as docs/rehearsal.md explains it: plain types, None in place of NaN."""
        body: dict[str, Any] = {"format": FORMAT, "tendonlab": version()}
        for name in ("dataset", "system", "seed", "seconds", "planned", "sizes", "on_truth", "num_left_out"):
            body[name] = plain(getattr(self, name), key=name)
        body |= {"interrupted": self.interrupted, "false_effects": dict(self.false_effects)}
        body["effects"] = [plain(asdict(entry), key=entry.effect) for entry in self.effects]
        body["nothing"] = {name: plain(asdict(of), key=name) for name, of in self.nothing.items()}
        body["reliability"] = [plain(asdict(one), key="reliability") for one in self.reliability]
        return {**body, "sentences": list(self.sentences), "notes": list(self.notes)}

    def report(self, out: str | Path) -> Path:
        """Write rehearsal.html and rehearsal.json into the folder `out`, which is made where it does not exist; the
        path of rehearsal.html. Raises ParameterError where `out` is a file."""
        from tendonlab.rehearsal.page import page
        from tendonlab.report.write import prepare_folder

        folder = prepare_folder(out)
        text = json.dumps(self.to_dict(), indent=2, ensure_ascii=False, allow_nan=False)
        (folder / "rehearsal.json").write_text(text + "\n", encoding="utf-8")
        (folder / "rehearsal.html").write_text(page(self), encoding="utf-8")
        return folder / "rehearsal.html"

    def __repr__(self) -> str:
        return f"Rehearsal({self.dataset!r}: {len(self.effects)} effects, {len(self.cases)} simulated rigs)"

    def _repr_html_(self) -> str:
        lines = "".join(f"<li>{escape(sentence)}</li>" for sentence in self.sentences)
        return f"<p>{escape(repr(self))}</p><ul>{lines}</ul>"
