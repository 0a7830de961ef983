"""A command that kicks where its reference jumps, and spikes that only the log has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import tendonlab as tl
from tendonlab.checking.spikes import marks

INERTIA, GRAVITY, VISCOUS, STEP, FINE = 0.02, 0.5, 0.03, 0.01, 50
JUMPS = (0.4, -0.25, 0.6, -0.3, 0.15, -0.5)
PLACES = tuple(range(60, 660, 100))


def stepped(folder: Path, *, misread: bool) -> tl.Dataset:
    """A joint under a PD loop whose reference jumps each second, integrated by many small steps under a command that is
    held; `misread`: a command without kicks drives the joint, and the log has spikes of the same size."""
    random = np.random.default_rng(3)
    reference = np.repeat(np.cumsum((0.0, *JUMPS)), 100)[40:]
    angle = rate = last = 0.0
    rows = []
    for k, r in enumerate(reference):
        kick = 0.04 * (r - last) / STEP
        last = r
        u = 0.5 * (r - angle) - 0.05 * rate + (0.0 if misread else kick)
        rows.append((k * STEP, u + (kick if misread else 0.0), angle + 2e-5 * random.standard_normal()))
        for _ in range(FINE):
            rate += STEP / FINE * (u - GRAVITY * np.sin(angle) - VISCOUS * rate) / INERTIA
            angle += STEP / FINE * rate
    pd.DataFrame(rows, columns=["t", "u", "q"]).to_csv(folder / "run.csv", index=False)
    (folder / "dataset.toml").write_text(
        'format = "tendonlab-dataset/1"\nname = "steps"\ntime = { column = "t", unit = "s" }\n'
        '[system]\nkind = "rigid_joint"\nnominal_effects = ["joint:viscous"]\n[system.parameters]\n'
        f"inertia = {{ value = {1.2 * INERTIA} }}\ngravity_torque = {{ value = {GRAVITY} }}\n"
        f"viscous = {{ value = {VISCOUS} }}\n[signals]\n"
        'motor_torque = { column = "u", unit = "N*m", hold = true }\njoint_angle = { column = "q", unit = "rad" }\n'
        '[[experiments]]\nname = "run"\nfile = "run.csv"\nsplit = "train"\n'
    )
    return tl.load(folder)


@pytest.mark.parametrize("misread", [False, True])
def test_what_moves_the_rig_is_no_outlier(tmp_path: Path, misread: bool) -> None:
    found = marks(stepped(tmp_path, misread=misread))[("run", "motor_torque")]
    assert set(np.flatnonzero(found)) == (set(PLACES) if misread else set())
