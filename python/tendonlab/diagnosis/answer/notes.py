"""What a reader must know beside the numbers: warnings, and how the numbers came about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from tendonlab.diagnosis.answer import where
from tendonlab.diagnosis.answer.heldout import Replayed, gap, row_mean_squares
from tendonlab.diagnosis.answer.judged import Judged
from tendonlab.diagnosis.answer.verdict import STRAINED, STRAINED_BESIDE, Levels
from tendonlab.diagnosis.beliefs import has_vanished
from tendonlab.diagnosis.discrepancy import FAR_SCATTERED, FAR_TRAINED, RINGS
from tendonlab.diagnosis.drift import Drift
from tendonlab.diagnosis.search.delays import value_and_interval
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.trial import is_nothing
from tendonlab.diagnosis.search.workshop import NOTHING
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.noise import RUN_TO_RUN_UNKNOWN, Floor
from tendonlab.fitting.replay import CONTRADICTED, missed_command
from tendonlab.fitting.uncertainty import FEWEST_EXPERIMENTS
from tendonlab.simulation.catalog import unit

if TYPE_CHECKING:
    import pandas as pd

APART = 1.5  # ratio of held-out errors in the closed loop and in an injection, beyond which a reader must know both
UNSTEADY = 0.03  # relative sd of friction from run to run beyond which repeatability is the limit
TOLD = 1.2  # noise floors that noise alone leaves, from which a reader is told


def warnings(case: Case, floor: Floor, search: Search) -> list[str]:
    """What weakens the answer."""
    return [
        *case.dataset.warnings,
        *_on_the_controller(case),
        *_on_the_floor(case, floor),
        *_on_the_split(case),
        *_on_the_fits(search),
        *_on_the_failed(search),
        *_on_wide_intervals(search),
        *_on_the_refuted(search),
    ]


def _on_the_controller(case: Case) -> list[str]:
    missed = missed_command(case.dataset, case.system)
    if missed <= CONTRADICTED:
        return []
    name = case.system.info.inputs[0].name
    return [
        f"The stated controller does not command the logged {name}: the two differ by {100 * missed:.0f} % (rms). The "
        "logged command was replayed instead. Check gains, reference and sample_time; d/dt is a backward difference."
    ]


def _on_the_floor(case: Case, floor: Floor) -> list[str]:
    if not floor.repeated:
        labels = [e.repeat for e in case.experiments if e.repeat is not None]
        marked = len(set(labels)) < len(labels)
        why = "Runs marked as repeats do not repeat: they share few samples, or their commands differ by half and more."
        return [why] * marked + [
            "No repeated runs, so the noise floor is assumed: sensor noise, and "
            f"{100 * RUN_TO_RUN_UNKNOWN:.0f} % friction scatter as far as the simulator with the effects named leaves "
            "that much. Weaker effects may hide below. Repeat one run to measure the floor."
        ]
    if floor.tau > UNSTEADY:
        return [f"Friction differs by {100 * floor.tau:.1f} % from run to run, which limits what can be said."]
    return []


def _on_the_split(case: Case) -> list[str]:
    num, messages = len(case.train), []
    if not case.test:
        how = "Each experiment is predicted by a fit to the others."
        alone = "There is only one, so all errors are those of the fit itself, which is optimistic."
        messages.append(f"No experiment is held out. {how if num > 1 else alone}")
    if num < FEWEST_EXPERIMENTS:
        only = f"Only {num} training experiment{'s' if num > 1 else ''}"
        messages.append(f"{only}: the 95 % intervals rest on blocks of 2 s, not on how experiments differ.")
    return messages


def _on_the_fits(search: Search) -> list[str]:
    final, messages = search.final, []
    vanished = {f.name for f, x in zip(final.free, final.x, strict=True) if has_vanished(f, float(x))}
    silent = [name for name in final.not_informed if name not in vanished]
    bound = [f.name for f, at in zip(final.free, final.at_bound, strict=True) if at and f.name not in silent]
    if bound:
        messages.append(f"At a bound: {', '.join(bound)}. Such a value is a limit and not an estimate.")
    if silent:
        messages.append(
            f"Held at the nominal value, since a small change leaves every prediction as it is: {', '.join(silent)}. "
            "At a switch, such as a hard gate, a large change may still matter."
        )
    models = {m.added: m for m in (search.tuned, final)}.values()
    return messages + [_stopped(model, search) for model in models if not model.converged]


def _stopped(model: Fitted, search: Search) -> str:
    """What it costs that a fit ended before it converged."""
    if model.added:
        named = f"the model with {', '.join(model.added)}"
        cost = "Values and intervals of its parameters are tentative"
    else:
        named = "the refitted simulator"
        cost = f"Tuning alone may explain more than is reported{', and the effects less' * bool(search.final.added)}"
    return (
        f"The fit of {named} did not converge: {model.message}. {cost}. If that matters, state nominal values closer "
        "to the rig, or the sd of those that you know, and diagnose again."
    )


def _on_the_failed(search: Search) -> list[str]:
    failed = {effect: reason for contest in search.rounds for effect, reason in contest.failed.items()}
    tried = {trial.effect for contest in search.rounds for trial in contest.trials}
    failed = {effect: reason for effect, reason in failed.items() if effect not in tried}
    found = [
        f"{effect} could not be weighed, which does not exclude it: {reason}."
        for effect, reason in failed.items()
        if reason != NOTHING
    ]
    ended = search.rounds[-1] if search.rounds and search.rounds[-1].accepted is None else None
    names = ", ".join(
        effect for effect, reason in failed.items() if ended and ended.failed.get(effect) == reason == NOTHING
    )
    if names:  # before an effect was found, what it leaves out gains for others
        found.append(f"These gain evidence, but their 95 % intervals hold 0, so they do not count: {names}.")
    return found


def _on_wide_intervals(search: Search) -> list[str]:
    """Effects that were established although their intervals hold 0."""
    return [
        f"{effect} was established although its 95 % interval holds 0. The interval follows from slopes of the error. "
        "Where the error changes in steps, the interval is too wide, and the evidence tells more."
        for effect in search.selected
        if is_nothing(effect, search.final)
    ]


def _on_the_refuted(search: Search) -> list[str]:
    """Effects that held-out experiments refute."""
    return [
        f"Not established: {name}. The training experiments speak for it, but {why}."
        for name, why in search.refuted.items()
    ]


def not_asked(case: Case, search: Search, library: Sequence[str] | None) -> list[str]:
    """A warning about effects that were asked for by name and could not be tried."""
    tried = {screened.effect for contest in search.rounds for screened in contest.screened}
    tried |= {trial.effect for contest in search.rounds for trial in contest.trials}
    names = [name for name in library or () if name not in tried and name not in case.system.effects]
    reason = "it requires an effect that the simulator lacks, or a signal that was not measured, or replaces nothing"
    return [f"Asked for and not tried: {', '.join(names)} ({reason})."] if names else []


def on_the_held_out(weighed: Judged, shown: Judged, near: Mapping[str, Replayed], selected: Sequence[str]) -> list[str]:
    """Warnings about single held-out experiments. `near`: the replays that the verdict counts."""
    predicted, allowed = weighed.stages["with_effect"], near["with_effect"]
    return [
        *not_simulated(weighed.failed),
        *(not_simulated(shown.failed) if shown is not weighed else []),
        *_apart(weighed, shown),
        *not_improved(shown.per_experiment(), selected),
        *allowed_more(weighed.case, predicted, allowed, weighed.floor, weighed.experiments),
    ]


def _apart(weighed: Judged, shown: Judged) -> list[str]:
    """A warning where the verdict rests on errors that are far below those in the closed loop."""
    used, seen = weighed.errors()["with_effect"], shown.errors()["with_effect"]
    if seen <= APART * max(1.0, used):
        return []
    return [
        f"In the closed loop the held-out error is {seen:.2g} noise floors. The verdict counts the {used:.2g} of an "
        "injection, which follows the logged motion: in the loop errors add up."
    ]


def not_simulated(failed: Mapping[str, str]) -> list[str]:
    """A warning for each experiment that errors leave out. `failed`: why it could not be simulated, by its name."""
    left_out = "is left out of the errors, as it could not be simulated"
    return [f"Experiment {name} {left_out}: {why}." for name, why in failed.items()]


def not_improved(held_out: pd.DataFrame, selected: Sequence[str]) -> list[str]:
    """A warning for each held-out experiment whose gap the selected effects do not shrink. `held_out`: the gap of each
    experiment (row) at each stage (column), in noise floors."""
    worse = held_out[held_out["with_effect"] >= held_out["refitted"]] if selected else held_out[:0]
    return [
        f"Held-out experiment {name}: {' and '.join(selected)} does not shrink the gap "
        f"({row['refitted']:.3g} noise floors before, {row['with_effect']:.3g} after)."
        for name, row in worse.iterrows()
        if row["refitted"] > 0
    ]


def allowed_more(
    case: Case, predicted: Replayed, near: Replayed, floor: Floor, experiments: Sequence[int]
) -> list[str]:
    """A warning for each held-out experiment above the floor that the verdict counts by what the fit leaves open, not
    as predicted."""
    found = []
    for i, before, after in zip(experiments, predicted.residuals, near.residuals, strict=True):
        gaps = [gap(row_mean_squares(of), floor.rms) for of in (before, after)]
        told, left = (f"{size:.2g}" for size in gaps)
        if gaps[1] < gaps[0] and gaps[0] > 1.0 and told != left:
            found.append(
                f"Held-out experiment {case.experiments[i].name}: the fitted model predicts a gap of {told} noise "
                f"floors. Within the uncertainty of the fit the gap can be {left}, and the verdict uses that."
            )
    return found


def no_noise(levels: Levels, *, selected: bool) -> list[str]:
    """Warnings where what the final model leaves cannot be noise, or where it needs parameters that were stated to be
    elsewhere. `selected`: whether it has effects of its own."""
    found = []
    if levels.strained >= (STRAINED_BESIDE if selected else STRAINED):
        found.append(
            f"{'Even with the selected effects the fit' if selected else 'Tuning alone'} needs a parameter "
            f"{levels.strained:.0f} stated standard deviations away from its stated value, so something else is "
            "missing. If that standard deviation was stated too small, nothing else may be."
        )
    if levels.patterns.followed >= levels.most_followed(selected=selected):
        found.append(
            "The remaining error follows the motion, or drifts alike in every run: a map over direction and place, or "
            "over direction and time since the start, learnt from other experiments, predicts "
            f"{100 * levels.patterns.followed:.0f} % of its mean square. So it is not noise."
        )
    if levels.patterns.ringing >= RINGS and not levels.repeated:
        found.append(
            f"The remaining error rings: the frequencies about {levels.patterns.frequency:.2g} Hz hold "
            f"{100 * levels.patterns.ringing:.0f} % of its mean square in most experiments. So it is not noise. A "
            "resonance that the simulator lacks leaves such errors."
        )
    if levels.trained >= FAR_TRAINED:
        found.append(
            f"The remaining error is {levels.trained**0.5:.2g} times as large as sensors and friction that differs by "
            f"{100 * RUN_TO_RUN_UNKNOWN:.0f} % from run to run leave. So it is not noise."
        )
    elif levels.beyond_sensors >= 1.0 and not selected:
        found.append(
            f"The remaining error is {levels.tuned**0.5:.2g} times as large as the noise of the sensors, though the "
            "fit lets friction differ from run to run. So it is not noise."
        )
    if levels.scattered >= FAR_SCATTERED:
        found.append(
            f"The fit needs friction that differs by {100 * RUN_TO_RUN_UNKNOWN * levels.scattered**0.5:.0f} % from run "
            "to run. That is more than noise: look for what changed between the runs (temperature, lubrication, "
            "pretension)."
        )
    return found


def stops(levels: Levels) -> list[str]:
    """A warning where noise decides what held-out experiments leave."""
    floors = levels.noise.left**0.5
    if floors < TOLD:
        return []
    return [
        f"Noise of the logs alone leads a perfect simulator about {floors:.2g} noise floors (rms) from the held-out "
        "experiments, mostly where friction holds a part, and noise decides where that part stops. The verdict allows "
        "for such noise."
    ]


def replay(case: Case) -> dict[str, Any]:
    """How experiments were replayed: the kind, and the gains with their units."""
    entry, info, axis = case.replay.to_dict(), case.system.info, case.system.axis
    angle = next((unit(s.dimension, axis) for s in info.outputs if s.name == case.replay.output), None)
    if entry["kp"] is None or angle is None:
        return entry
    logged = case.dataset.signals.get(info.inputs[0].name)
    command = logged.si_unit if logged else unit(info.inputs[0].dimension, axis)
    controller = case.system.controller
    cascade = case.replay.kind == "controller" and controller is not None and controller.kind == "cascade"
    return {**entry, "kp_unit": "1/s" if cascade else f"{command}/{angle}", "kd_unit": f"{command}*s/{angle}"}


def weighed(by: Judged, shown: Judged) -> dict[str, Any]:
    """How models were fitted and weighed, as `weighed_by`, where that is not how their errors are shown."""
    if shown.case is by.case:
        return {}
    step = float(np.median(np.diff(by.case.experiments[by.case.train[0]].time)))
    how = {"samples_per_second": float(f"{1.0 / step:.4g}"), "errors": by.errors()}
    return {"weighed_by": replay(by.case) | how}


def units(case: Case) -> dict[str, str]:
    """Unit of every signal and of every coordinate of the where-map."""
    info, axis, controller = case.system.info, case.system.axis, case.system.controller
    known = {s.name: unit(s.dimension, axis) for s in info.signals}
    if controller is not None:
        known[controller.reference] = known[controller.measured]
    for given in info.inputs:  # a command may be logged as a current
        logged = case.dataset.signals.get(given.name)
        known |= {given.name: logged.si_unit} if logged else {}
    for port in info.ports:
        own = info.element(port.element).axis or axis
        known |= {f"{port.name}_{q}": unit(where.dimension(port, q), own) for q in where.COORDINATES}
    return known | {"time": "s"}


def details(case: Case, floor: Floor, nominal: Fitted, search: Search, drift: Drift | None) -> dict[str, Any]:
    """How the numbers came about."""
    return {
        "run_to_run_friction": floor.tau,
        "noise": {case.outputs[c]: float(case.noise[c]) for c in case.measured},
        "mean_square": {
            "nominal": nominal.mean_square,
            "refitted": search.tuned.mean_square,
            "with_effect": search.final.mean_square,
        },
        "parameters": {f.name: _parameter(case, search.final, f.name) for f in search.final.free},
        "drift": asdict(drift) if drift and drift.tells else None,
    }


def _parameter(case: Case, model: Fitted, name: str) -> dict[str, Any]:
    value, interval = value_and_interval(case, model, name)
    return {
        "value": value,
        "ci95": list(interval),
        "unit": model.system.unit(name),
        "nominal": case.system.parameters.get(name),
        "informed": name not in model.not_informed,
    }
