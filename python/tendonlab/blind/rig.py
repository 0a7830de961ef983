"""A drawn case: rig, controller, sensors, session, and the one effect that its nominal simulator lacks."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from . import unknown
from .description import SETTLE, Experiment, System
from .systems import TWO_INERTIA
from .systems.effects import FORMS, FRICTION, LARGEST, SIGNED, draw_shape, friction

LACKING = ("effect", "unknown")  # kinds of cases whose nominal simulator lacks something
NOMINAL_SPREAD, PARAMETERS_ONLY_SPREAD = 0.12, 0.22
MET_WITHIN = 0.18  # of log gap/noise: 20 %


@dataclass(frozen=True, kw_only=True)
class Rig:
    """A case, except for the amplitude of its effect. `effect` is "" for none; `form` 0 is the documented
    form.

    `truth`: the rig without the effect. `shape`: the drawn numbers that fix the effect, except for its amplitude.
    `noise`: factor on the floor. `kind`: "effect", "unknown", "none" or "parameters_only". `loop`: kp, kd, limit.
    `second`: another effect that the simulator lacks, in the same functional form; its target and amplitude.
    `outputs`: those that were measured. `met_within`: how far log gap/noise may be from that of the target.
    `has_bounded_error`: nominal values are 10 to 20 % off, not normally drawn.
    `recording`: which recording of the same rig this is; each has noise and scatter of its own.
    """

    system: System
    truth: dict[str, float]
    effect: str
    shape: dict[str, float]
    form: int
    kind: str
    excitation: str
    experiments: tuple[Experiment, ...]
    sample_time: float
    loop: dict[str, float]
    has_controller: bool
    outputs: tuple[str, ...]
    noise: float
    target: float
    seed: int
    num_settle: int
    has_bounded_error: bool = False
    second: str = ""
    second_target: float = 0.0
    second_amplitude: float = 0.0
    met_within: float = MET_WITHIN
    recording: int = 0

    @property
    def has_repeats(self) -> bool:
        return any(experiment.repeat for experiment in self.experiments)

    @property
    def num_samples(self) -> int:
        return self.experiments[0].reference.size

    @property
    def motor_turns(self) -> float:
        """Turns of the first output per turn of the joint."""
        return self.truth.get(self.system.turns, 1.0)

    @property
    def missing(self) -> tuple[str, ...]:
        """Effects and causes that the nominal simulator lacks."""
        return tuple(name for name in (self.effect, self.second) if name)

    @property
    def forms(self) -> tuple[str, ...]:
        """Functional forms of the effect, the documented one first."""
        return forms_of(self.system, self.effect)


def draw_rig(
    draw: np.random.Generator,
    *,
    effect: str,
    kind: str,
    system: System = TWO_INERTIA,
    excitation: str | None = None,
    num_samples: int | None = None,
    has_repeats: bool = True,
    strengths: tuple[float, float] = (1.0, 6.0),
    is_other_form: bool | None = None,
    met_within: float = MET_WITHIN,
) -> Rig:
    """Draw a rig of one kind around the system's typical parameters (+-25 %).

    `strengths`: least and largest gap/noise of the effect. `excitation` None: drawn, rich twice as often as poor.
    `num_samples` None: as many as the system's records take. `is_other_form` None: drawn.
    """
    truth = {n: x * (1.0 if n in system.exact else draw.uniform(0.75, 1.25)) for n, x in system.typical.items()}
    chosen = str(draw.choice(["rich", "rich", "poor"]))
    period = system.sample_times[0] if len(system.sample_times) == 1 else float(draw.choice(system.sample_times))
    size = num_samples or round(system.duration / period)
    loop = system.loop(truth, draw) if system.loop else {}
    outputs, form = _outputs(system, effect, draw), _form(system, effect, draw, is_other=is_other_form)
    recorded = excitation or chosen
    runs = system.session(draw, excitation=recorded, sample_time=period, num_samples=size, has_repeats=has_repeats)
    return Rig(
        system=system,
        truth={name: float(f"{value:.5g}") for name, value in truth.items()},
        effect=effect,
        shape=draw_shape(draw),
        form=form,
        kind=kind,
        excitation=recorded,
        experiments=tuple(runs),
        sample_time=period,
        loop={name: float(f"{value:.4g}") for name, value in loop.items()},
        has_controller=bool(draw.random() < 0.5) and bool(loop),
        outputs=outputs,
        noise=float(np.exp(draw.uniform(np.log(0.7), np.log(1.8)))),
        target=float(np.exp(draw.uniform(*np.log(strengths)))),
        seed=int(draw.integers(2**31)),
        num_settle=min(round(SETTLE / period), size),  # short records, as tests make them, settle shortly
        met_within=met_within,
    )


def _outputs(system: System, effect: str, draw: np.random.Generator) -> tuple[str, ...]:
    """Those that are measured."""
    name, share, invisible_without = system.optional
    lacks = bool(draw.random() < share) and effect not in invisible_without
    return tuple(output for output in system.output_names if not (lacks and output == name))


def forms_of(system: System, effect: str) -> tuple[str, ...]:
    """Functional forms of an effect, the documented one first."""
    forms = FORMS | dict(system.forms)
    return forms.get(effect, forms.get(effect.partition(":")[2], ("documented",)))


def _form(system: System, effect: str, draw: np.random.Generator, *, is_other: bool | None) -> int:
    other, by_chance = int(draw.integers(1, 3)), bool(draw.random() < 0.5)
    chosen = by_chance if is_other is None else is_other
    return min(other, len(forms_of(system, effect)) - 1) if chosen else 0


def effect_parameters(rig: Rig, amplitude: float) -> dict[str, float]:
    """Parameters of the rig's effect at `amplitude` (0 is off, 1 is about usual); they replace or extend the
    truth.
    """
    element, _, effect = rig.effect.partition(":")
    if rig.system.strengthen:
        own = rig.system.strengthen(rig.effect, amplitude, truth=rig.truth, shape=rig.shape, seed=rig.seed)
        if own is not None:
            return own
    if element == unknown.PREFIX:
        return unknown.parameters(effect, amplitude, truth=rig.truth, seed=rig.seed)
    if effect in FRICTION:
        return friction(rig.effect, amplitude, truth=rig.truth, shape=rig.shape)
    size = rig.system.sizes(rig.truth)[rig.effect]
    return {f"{element}_{effect}": size * (rig.shape["sign"] * amplitude if effect in SIGNED else amplitude)}


def largest_amplitude(rig: Rig) -> float:
    """Physical limit of the amplitude."""
    return (LARGEST | unknown.LARGEST | dict(rig.system.largest))[rig.effect.partition(":")[2]]


def full_truth(rig: Rig, amplitude: float) -> dict[str, float]:
    """Parameters of the rig with its effect at `amplitude`; at 0 without it (a withheld Coulomb friction is then
    0).
    """
    is_on = bool(rig.effect) and (rig.effect in rig.system.nominal_effects or amplitude > 0)
    first = effect_parameters(rig, amplitude) if is_on else {}
    second = effect_parameters(replace(rig, effect=rig.second), rig.second_amplitude) if rig.second else {}
    return rig.truth | second | first


def nominal_effects(rig: Rig) -> tuple[str, ...]:
    """What the nominal simulator contains: all but what is withheld."""
    return tuple(name for name in rig.system.nominal_effects if name not in rig.missing)


def nominal_parameters(rig: Rig) -> tuple[str, ...]:
    """Names of the nominal simulator's parameters, in the order of the contract."""
    groups = (rig.system.withheld.get(effect, (effect.replace(":", "_"),)) for effect in rig.missing)
    withheld = {name for group in groups for name in group}
    return tuple(name for name in rig.truth if name not in withheld)


def free_parameters(rig: Rig) -> list[str]:
    """Those of them that are not known exactly."""
    return [name for name in nominal_parameters(rig) if name not in rig.system.exact]


def nominal_values(rig: Rig) -> dict[str, tuple[float, float]]:
    """Value and sd of the nominal simulator's parameters as the dataset states them.

    In error by 12 % (parameters_only: 22 %), by nothing where the simulator is to be right, or where a parameter is
    known exactly.
    """
    draw = np.random.default_rng([rig.seed, 3])
    spread = PARAMETERS_ONLY_SPREAD if rig.kind == "parameters_only" else NOMINAL_SPREAD
    stated: dict[str, tuple[float, float]] = {}
    for name in nominal_parameters(rig):
        error = float(np.exp(spread * draw.standard_normal()))
        if rig.has_bounded_error:
            error = 1.0 + float(draw.uniform(0.1, 0.2) * draw.choice([-1.0, 1.0]))
        known = name in rig.system.exact
        value = float(f"{rig.truth[name] * (1.0 if known or rig.kind == 'none' else error):.5g}")
        stated[name] = (value, 0.0 if known else float(f"{NOMINAL_SPREAD * value:.3g}"))
    return stated
