"""The rig's twins as datasets of the library: what its sensors read, and a nominal simulator that lacks one effect."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.arguments import choice, positive
from tendonlab.papers.s4.constants import RESOLUTION, contact, design, identified
from tendonlab.papers.s4.drive import Drive
from tendonlab.papers.s4.rig import NOISE, Case, measured, run_rig
from tendonlab.papers.s4.twin import TENSIONS

SAMPLE_STEP = 10  # every tenth sample of 1 kHz: 100 Hz
SOFT_START, EASE = 0.5, 2  # s: what is differentiated must not jump at the start of a record
JITTER = 0.5 * RESOLUTION  # rad: without it repeats of a twin would repeat to the last bit
MOTIONS = (  # name, amplitude (deg), period (s), repeat, split
    ("slow", 10.0, 6.0, "", "train"),
    ("printed-a", 10.0, 4.0, "A", "train"),
    ("printed-b", 10.0, 4.0, "A", "train"),
    ("small", 6.0, 3.0, "", "train"),
    ("held-out-slow", 8.0, 5.0, "", "test"),
    ("held-out-fast", 9.0, 3.5, "", "test"),
)


@dataclass(frozen=True, kw_only=True)
class Nominal:
    """What the simulator to be diagnosed believes: stiffness, N/m, mean friction coefficient, whether it knows that the
    coefficient differs by direction, and pretension, N, which screws set to about 10 %."""

    k: float
    mu: float
    knows_direction: bool = False
    T_p: float = 50.0


def nominal(*, knows_direction: bool) -> Nominal:
    """The identified stiffness, and the mean of both identified friction coefficients."""
    found = identified()
    return Nominal(k=found.k, mu=0.5 * (found.mu_plus + found.mu_minus), knows_direction=knows_direction)


def write_rig(
    folder: Path | str,
    of: Case,
    believed: Nominal,
    *,
    name: str,
    system: str = "ccsrm",
    duration: float = 6.0,
    seed: int = 0,
) -> Path:
    """Record six motions of the twin `of` from rest into a new `folder` as a dataset that `tl.load`
    reads, whose simulator is `believed`; returns the folder. Same seed, same noise.

    `system`: "ccsrm", which simulates joint 1, or "ccsrm_tensions", which takes its angle as read and leaves the
    tensions to be explained. Raises ParameterError for another one."""
    choice("system", system, ("ccsrm", "ccsrm_tensions"))
    path = Path(folder)
    path.mkdir(parents=True, exist_ok=False)
    rng = np.random.default_rng(seed)
    runs: dict[tuple[float, float], pd.DataFrame] = {}
    for label, amplitude, period, *_ in MOTIONS:
        drive = Drive(
            amplitude=float(np.deg2rad(amplitude)), omega=2 * np.pi / period, soft_start=SOFT_START, ease=EASE
        )
        if (amplitude, period) not in runs:
            runs[amplitude, period] = run_rig(of, drive=drive, duration=duration, rtol=1e-7)
        read = measured(runs[amplitude, period], seed=rng, jitter=JITTER).iloc[::SAMPLE_STEP]
        columns = {"theta2": "driver_angle", "theta1": "joint_angle", **{T: f"tension_{T[1:]}" for T in TENSIONS}}
        read.rename(columns=columns)[list(columns.values())].to_csv(path / f"{label}.csv", float_format="%.9g")
    (path / "dataset.toml").write_text(_toml(of, believed, name, system), encoding="utf-8")
    return path


def softer(of: Case, *, k: float) -> Case:
    """The same rig with rigid ends and a cable of stiffness k, N/m: what elastic ends are easily mistaken for."""
    k = positive("k", k, "N/m")
    return replace(of, meaning=f"softer cable, k = {k:g} N/m", k=k, ends=None)


def _toml(of: Case, believed: Nominal, name: str, system: str) -> str:
    found, c, m = identified(), contact(), design()
    effects = ["contact:capstan", "contact:presliding", "contact:stribeck", "contact:viscous"]
    values = {
        "cable_stiffness": (believed.k, 0.3 * believed.k),
        "pretension": (believed.T_p, 0.1 * believed.T_p),
        "pulley_radius": (m.r, 0),
        "initial_wrap_angle": (m.theta_w0, 0),
        "friction_coefficient": (believed.mu, 0.03),
        "contact_viscous": (c.sigma_2, 0.3 * c.sigma_2),
        "static_friction_coefficient": (c.mu_s / c.mu_c * believed.mu, 0),  # what the paper keeps as in Table III
        "stribeck_velocity": (c.v_s, 0),
        "bristle_stiffness": (c.sigma_0, 0),
        "bristle_damping": (c.sigma_1, 0),
        "smallest_level": (c.eps, 0),
        "stribeck_share": (1.0, 0),
        "presliding_share": (1.0, 0),
    }
    if system == "ccsrm":
        values["inertia"] = (m.J, 0)
    if believed.knows_direction:
        effects.append("contact:asymmetry")
        difference = (found.mu_plus - found.mu_minus) / (found.mu_plus + found.mu_minus)
        values["contact_coefficient_asymmetry"] = (difference, 0.03)
    lines = [
        'format = "tendonlab-dataset/1"',
        f'name = "{name}"',
        f'description = "Synthetic twin of the rig of S4 ({of.meaning}), made by tendonlab.papers.s4"',
        'time = { column = "t", unit = "s" }',
        "[system]",
        f'kind = "{system}"',
        f"nominal_effects = {effects}".replace("'", '"'),
        "[system.parameters]",
        *(f"{key} = {{ value = {value!r}, sd = {sd!r} }}" for key, (value, sd) in values.items()),
    ]
    for signal in ("driver_angle", "joint_angle"):
        lines += [f"[signals.{signal}]", f'column = "{signal}"', 'unit = "rad"', f"resolution = {RESOLUTION!r}"]
    for tension in TENSIONS:
        column = f"tension_{tension[1:]}"
        lines += [f"[signals.{column}]", f'column = "{column}"', 'unit = "N"', f"noise_sd = {NOISE}"]
    for label, _, _, repeat, split in MOTIONS:
        lines += ["[[experiments]]", f'name = "{label}"', f'file = "{label}.csv"', f'split = "{split}"']
        lines += [f'repeat = "{repeat}"'] if repeat else []
        lines += ["initial = { joint_angle = 0.0, joint_velocity = 0.0 }"] if system == "ccsrm" else []
    return "\n".join(lines) + "\n"
