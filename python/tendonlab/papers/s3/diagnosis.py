"""S3's own gap on its twin, as datasets to diagnose: runs with an effect that the paper's model lacks.

The friction coefficient of every case is the one that the paper's model gets from theta_6 at 54 kg, 15 N·m and 0.1 Hz,
where neither slack nor superposition shows. The twin's nodes and drive have viscous friction too, and its drive has
inertia; the paper's model has neither. The simulators here have a term for viscous friction, whose value nobody
knows, or are the paper's model as it is printed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache

from tendonlab.data import Dataset
from tendonlab.errors import ParameterError, expected_one_of
from tendonlab.papers.s3.fit import fit_gradient
from tendonlab.papers.s3.groups import Record, run_chain, to_dataset
from tendonlab.papers.s3.rig import FrictionParameters
from tendonlab.papers.s3.trajectories import Trajectory

SAMPLE_RATE = 100.0  # Hz: what happens takes tenths of a second
DURATION = 12.0  # s a run
SKEW = 0.9  # curvature at the load over its mean, less one, of the sheaths whose skew is withheld
GATE_STEEPNESS = 15.0  # s_v v_thres² of the simulator's gate: soft enough to have a slope that a fit can follow


@dataclass(frozen=True, kw_only=True, eq=False)
class Withheld:
    """A case: `records` to fit, `held_out` to judge on; what is withheld (`effect`), how the twin did it (`told`)."""

    effect: str
    told: str
    records: tuple[Record, ...] = field(repr=False)
    held_out: tuple[Record, ...] = field(repr=False)
    friction_known: bool = False

    def dataset(self, *, viscous: bool = True) -> Dataset:
        """As a dataset of kind `bowden_pair` whose simulator lacks the effect. `viscous`: whether it has a term for
        viscous friction, of unknown value, or is the paper's model as printed."""
        return to_dataset(
            self.records,
            self.held_out,
            identified(),
            name=self.effect,
            friction_known=self.friction_known,
            viscous=viscous,
        )


@cache
def identified() -> FrictionParameters:
    """The paper's model identified on theta_6 at 54 kg, 15 N·m and 0.1 Hz, with a gate that has a slope."""
    record = run_chain(6, 54.0, Trajectory("sine", 15.0, 10.0), sample_rate=SAMPLE_RATE)
    return fit_gradient([record], free=("mu_d", "v_thres"), num_starts=1, steepest=GATE_STEEPNESS, polish=False).p


def withheld(case: str, *, seed: int = 1) -> Withheld:
    """One of the cases "slack" (above 2 r T_s one tendon is loose), "pretension_loss" (true pretension 0.8 of the
    reading), "presliding" (superposed torques, whose partial reversals only stretch the cable) and "skew" (the sheaths
    bend more towards the load, and are believed to be the same from both ends). `seed`: of noise.

    Raises ParameterError for another name."""
    if case not in _CASES:
        raise ParameterError(f"case = {case!r}: {expected_one_of(case, _CASES)}")
    return _CASES[case](seed)


def _runs(
    runs: Sequence[tuple[int, float, str, float, float]],
    *,
    seed: int,
    repeats: int = 1,
    slack: bool = False,
    pretension_scale: float = 1.0,
    skew: float = 0.0,
) -> tuple[Record, ...]:
    """`repeats` records for each (shape, reading in kg, kind, amplitude in N·m, period in s)."""
    return tuple(
        run_chain(
            number,
            reading,
            Trajectory(kind, amplitude, period),
            seed=seed + k,
            slack=slack,
            pretension_scale=pretension_scale,
            skew=skew,
            sample_rate=SAMPLE_RATE,
            duration=DURATION,
        )
        for k, (number, reading, kind, amplitude, period) in enumerate([run for _ in range(repeats) for run in runs])
    )


def _slack(seed: int) -> Withheld:
    """Peak torques of 1.3 to 1.6 times what the pretension holds, and one run below."""
    fitted = [(6, 30.0, "sine", 22.0, 10.0), (6, 30.0, "sine", 12.0, 10.0), (4, 30.0, "sine", 22.0, 7.0)]
    fitted += [(6, 40.0, "sine", 26.0, 10.0), (8, 30.0, "sine", 22.0, 10.0)]
    judged = [(6, 30.0, "sine", 22.0, 10.0), (5, 35.0, "sine", 24.0, 10.0)]
    return Withheld(
        effect="sheath:slack",
        told="friction grows with the torque above 2 r T_s",
        records=_runs(fitted, seed=seed, repeats=2, slack=True),
        held_out=_runs(judged, seed=seed + 100, slack=True),
    )


def _pretension_loss(seed: int) -> Withheld:
    """The friction coefficient counts as known: a smaller one would look nearly the same."""
    fitted = [(6, 30.0, "sine", 15.0, 10.0), (4, 40.0, "sine", 12.0, 10.0), (6, 54.0, "sine", 15.0, 7.0)]
    judged = [(6, 40.0, "sine", 15.0, 10.0), (3, 30.0, "sine", 12.0, 10.0)]
    return Withheld(
        effect="sheath:pretension_loss",
        told="true pretension 0.8 of the reading",
        records=_runs([*fitted, (8, 30.0, "sine", 15.0, 10.0)], seed=seed, repeats=2, pretension_scale=0.8),
        held_out=_runs(judged, seed=seed + 100, pretension_scale=0.8),
        friction_known=True,
    )


def _presliding(seed: int) -> Withheld:
    """Sines and superposed torques together: one gate can be tuned to either, not to both."""
    fitted, judged = [(6, 54.0), (3, 54.0), (8, 40.0)], [(5, 54.0), (7, 54.0)]
    both = (("sine", 15.0, 10.0), ("superposed", 15.0, 10.0))
    return Withheld(
        effect="sheath:distributed_presliding",
        told="the cable stretches from its input on before its far end moves",
        records=_runs([(*group, *commanded) for group in fitted for commanded in both], seed=seed, repeats=2),
        held_out=_runs([(*group, *commanded) for group in judged for commanded in both], seed=seed + 100),
    )


def _skew(seed: int) -> Withheld:
    """Gain in proportion to skew and squared wrap angle (eq. 18): three wrap angles tell it from a gain of a sensor."""
    fitted = [(1, 54.0, "sine", 22.0, 10.0), (3, 54.0, "sine", 22.0, 7.0), (8, 54.0, "sine", 22.0, 10.0)]
    judged = [(2, 54.0, "sine", 22.0, 10.0), (4, 54.0, "sine", 18.0, 10.0)]
    return Withheld(
        effect="sheath:curvature_skew",
        told="the sheaths bend more towards the load",
        records=_runs(fitted, seed=seed, repeats=2, skew=SKEW),
        held_out=_runs(judged, seed=seed + 100, skew=SKEW),
    )


_CASES: dict[str, Callable[[int], Withheld]] = {
    "slack": _slack, "pretension_loss": _pretension_loss, "presliding": _presliding, "skew": _skew,
}  # fmt: skip
