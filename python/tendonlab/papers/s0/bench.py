"""The bench of S0: a motor on load cells turns a capstan, a cable a pulley, and the pulley's shaft carries a disc.

Elements, external loads and configurations as in S0 Tables 2 to 5; speeds and torques are those of the input side."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import pandas as pd

from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.papers.tables import table

CENTRES = 0.150  # m, capstan axis to pulley axis (S0 section 3.1)
CABLE_DIAMETER = 1.59e-3  # m, 7x7 steel (S0 section 2.1)
SAMPLE_RATE = 1000.0  # Hz (S0 section 2.3)
NUM_RUNS = 20  # of each point of a map (S0 section 2.3)
LOADS = ("none", "D", "D2M", "D4M")  # nothing, disc, disc with one and with two pairs of masses
TRANSMISSIONS = ("C35P75GX", "C25P104GX")  # those that S0 fits models to
_DIMENSIONS = {"a": "g", "b": "h", "c": "i"}  # of the pulley's shaft, and their names on the capstan's (Figs 8, 9)


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """A capstan or pulley on its shaft, both bearings A and B on one side (S0 Figs 8, 9, Tables 2, 5).

    Distances in m, from A along the shaft: `bearing` B, `gravity` centre of gravity, `cable` where it pulls, `disc`
    where the external load hangs (None at the capstan), `end` of the pulley. `diameter` m, `weight` N, `inertia`
    kg·m²."""

    diameter: float
    weight: float
    inertia: float
    bearing: float
    gravity: float
    cable: float
    end: float
    disc: float | None


@dataclass(frozen=True, kw_only=True)
class Load:
    """What hangs on the pulley's shaft (S0 Table 4): `weight` N, `inertia` kg·m². Balanced: it gives no torque."""

    weight: float
    inertia: float


@dataclass(frozen=True, kw_only=True)
class Configuration:
    """A threading of the bench with a load, "C25P104GX-D4M" (S0 Table 3): capstan 25 mm, pulley 104 mm, grooved, cable
    crossed (X) or parallel (P), disc and four masses."""

    transmission: str
    load: str
    capstan: Shaft
    pulley: Shaft
    external: Load
    crossed: bool

    @property
    def name(self) -> str:
        """As in S0 Table 3."""
        return self.transmission if self.load == "none" else f"{self.transmission}-{self.load}"

    def ratio(self, *, cable_diameter: bool = False) -> float:
        """Transmission ratio N, 1: of the nominal diameters, or of those to the middle of the cable."""
        more = CABLE_DIAMETER if cable_diameter else 0.0
        return (self.pulley.diameter + more) / (self.capstan.diameter + more)

    def radii(self, *, cable_diameter: bool = False) -> tuple[float, float]:
        """Radius of capstan and pulley, m; to the middle of the cable with `cable_diameter`."""
        more = CABLE_DIAMETER / 2 if cable_diameter else 0.0
        return self.capstan.diameter / 2 + more, self.pulley.diameter / 2 + more


def configurations() -> tuple[str, ...]:
    """Names of all configurations, in the order of S0 Table 3."""
    return tuple(table("S0_table3_configurations")["configuration"])


@cache
def configuration(name: str) -> Configuration:
    """The configuration of that name; ParameterError, with the nearest name, where there is none."""
    rows = table("S0_table3_configurations").set_index("configuration")
    if name not in rows.index:
        raise ParameterError(f"configuration = {name!r}: {expected_one_of(name, configurations())}")
    row = dict(rows.loc[name])
    transmission, _, load = name.partition("-")
    return Configuration(
        transmission=transmission,
        load=load or "none",
        capstan=_shaft("Capstan", int(row["capstan_mm"])),
        pulley=_shaft("Pulley", int(row["pulley_mm"])),
        external=_external(load or "none"),
        crossed=bool(row["thread"] == "X"),
    )


def loaded(transmission: str, load: str) -> Configuration:
    """Configuration of a transmission ("C25P104GX") with a load of `LOADS`. Raises ParameterError as above."""
    return configuration(transmission if load == "none" else f"{transmission}-{load}")


def _external(load: str) -> Load:
    rows = table("S0_table4_external_load")
    row = rows[rows["suffix"].fillna("none") == load].iloc[0]
    return Load(weight=float(row["weight_N"]), inertia=1e-6 * float(row["inertia_kg_mm2"]))


def _shaft(kind: str, size: int) -> Shaft:
    element = dict(table("S0_table2_elements").set_index("element").loc[f"{kind} {size}"])
    rows = table("S0_table5_dimensions")
    length: pd.Series[float] = 1e-3 * rows[rows["element"] == f"{kind} {size}"].set_index("dimension")["value_mm"]
    pulley = kind == "Pulley"
    to_bearing, to_gravity, to_cable = (float(length[k if pulley else _DIMENSIONS[k]]) for k in "abc")
    cable = to_bearing + to_gravity + to_cable
    return Shaft(
        diameter=1e-3 * float(element["diameter_mm"]),
        weight=float(element["weight_N"]),
        inertia=1e-6 * float(element["inertia_kg_mm2"]),
        bearing=to_bearing,
        gravity=to_bearing + to_gravity,
        cable=cable,
        end=cable + float(length["d"]) if pulley else float(length["j"]),
        disc=float(length["e"]) if pulley else None,
    )
