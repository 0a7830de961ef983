"""Make the bundled twin: python -m tendonlab.blind.twin OUT [--kind effect|none|parameters_only]."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from .rig import Rig, draw_rig
from .strength import tune
from .write import record, sealed_toml, write_dataset

SEED = 20
EFFECT = "joint:stribeck"
GAP_NOISE = 3.5
DESCRIPTION = (
    "Synthetic two-inertia cable rig (motor, gear 10:1, elastic cable, pendulum joint) under a sampled PD position "
    "loop at 500 Hz, "
    "made by tendonlab's independent generator: python -m tendonlab.blind.twin; BSD-3-Clause."
)


def make_twin(
    out: Path | str,
    *,
    kind: str = "effect",
    effect: str = EFFECT,
    seed: int = SEED,
    gap_noise: float = GAP_NOISE,
    num_samples: int | None = None,
    step: float | None = None,
) -> Path:
    """Write one known rig as a dataset with sealed.toml beside, and return its folder.

    `kind` "effect": `effect` is withheld and the nominal values are 12 % off; "none": no effect and nominal values
    at the truth (expects no_gap); "parameters_only": no effect and values 10 to 20 % off. The same seed is the same
    rig in all three. Raises ValueError for another kind, FileExistsError where `out` has a dataset already.
    """
    if kind not in ("effect", "none", "parameters_only"):
        raise ValueError(f"kind = {kind!r}: expected 'effect', 'none' or 'parameters_only'")
    rig = _rig(kind=kind, effect=effect, seed=seed, gap_noise=gap_noise, num_samples=num_samples)
    (strength,) = tune([rig])
    (run,) = record([rig], [strength], step=step)
    folder = Path(out)
    write_dataset(rig, run, folder, name="two_inertia", description=DESCRIPTION)
    (folder / "sealed.toml").write_text(sealed_toml(rig, strength), encoding="utf-8")
    return folder


def _rig(*, kind: str, effect: str, seed: int, gap_noise: float, num_samples: int | None) -> Rig:
    drawn = draw_rig(
        np.random.default_rng([seed]),
        effect=effect if kind == "effect" else "",
        kind=kind,
        excitation="rich",
        num_samples=num_samples,
    )
    off = kind == "parameters_only"
    outputs = drawn.system.output_names
    return replace(
        drawn, target=gap_noise, form=0, has_controller=True, outputs=outputs, noise=0.6, has_bounded_error=off
    )


def main() -> None:
    """Command line: write the twin into a new folder."""
    parser = argparse.ArgumentParser(prog="python -m tendonlab.blind.twin", description=main.__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--kind", default="effect", choices=("effect", "none", "parameters_only"))
    parser.add_argument("--effect", default=EFFECT)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--gap-noise", type=float, default=GAP_NOISE)
    given = parser.parse_args()
    make_twin(given.out, kind=given.kind, effect=given.effect, seed=given.seed, gap_noise=given.gap_noise)


if __name__ == "__main__":
    main()
