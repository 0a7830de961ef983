"""The answer where the logs cannot be right: what to correct, and nothing about effects."""

from __future__ import annotations

from typing import Any

from tendonlab import _core
from tendonlab.checking.finding import Check
from tendonlab.data import Dataset, Experiment
from tendonlab.errors import NumericalError
from tendonlab.fitting.noise import noise_of
from tendonlab.fitting.set_points import points_of
from tendonlab.report.diagnosis import Diagnosis
from tendonlab.report.words import STAGES, VERDICTS
from tendonlab.simulation.catalog import unit
from tendonlab.simulation.prepare import Replay, prepare
from tendonlab.simulation.system import System

ATTEMPTS = 5  # of the stepper per sample: what needs more is given up
TOLERANCE = 1e-4


def data_fault(dataset: Dataset, system: System, found: Check, *, seed: int, seconds: float) -> Diagnosis:
    """The Diagnosis that ends with the problems that the check of the logs `found`."""
    blocking = [finding for finding in found.findings if finding.blocks]
    kind = "controller" if system.controller is not None else "free"
    return Diagnosis(
        dataset=dataset.name,
        system=system.kind,
        seed=seed,
        seconds=seconds,
        verdict="data_fault",
        verdict_probability={name: float(name == "data_fault") for name in VERDICTS},
        replay={"kind": kind, "kp": None, "kd": None},
        gap=_nominal_gap(dataset, system, kind),
        where={"signals": [], "elements": [], "regimes": []},
        effects=(),
        sets=(),
        selected=(),
        explained=None,
        indistinguishable=(),
        invisible=(),
        shrinkage={"from_nominal": None, "from_refitted": None},
        next_experiments=tuple(
            {"description": f"correct the logs: {f.detail}", "separates": [], "expected_gain": None} for f in blocking
        ),
        data=tuple(finding.to_dict() for finding in found.findings),
        warnings=(*dataset.warnings, *found.notes),
        units={s.name: unit(s.dimension, system.axis) for s in system.info.outputs},
        split={"train": [e.name for e in dataset.train], "test": [e.name for e in dataset.test]},
    )


def _nominal_gap(dataset: Dataset, system: System, kind: str) -> dict[str, dict[str, Any]]:
    """Error of the untouched simulator, where it can be simulated at all on such logs."""
    errors = [_errors(e, system, kind) for e in dataset.test or dataset.train]
    gap: dict[str, dict[str, Any]] = {}
    for name in dataset.outputs:
        known = [one[name] for one in errors if one is not None and name in one]
        level = (sum(known) / len(known)) ** 0.5 if known and len(known) == len(errors) else None
        gap[name] = {"noise_floor": _noise(dataset, system, name), **dict.fromkeys(STAGES), "nominal": level}
    return gap


def _noise(dataset: Dataset, system: System, output: str) -> float:
    """Sd of the white noise of an output, in its unit, as it is stated or as its records show it."""
    experiments = [e for e in dataset.experiments if output in e.data]
    records = [e.data[output].to_numpy(dtype=float) for e in experiments]
    inputs = [s.name for s in system.info.inputs]
    points = points_of(experiments, inputs, records) if system.info.steady else None
    return noise_of(dataset.signals[output], records, points)


def _errors(experiment: Experiment, system: System, kind: str) -> dict[str, float] | None:
    """Mean square error of each output; None where the simulation does not get through."""
    under = system.under(experiment)
    ready = prepare(experiment, under, Replay(kind))
    settings = _core.Settings(
        tolerance=TOLERANCE,
        position_scale=ready.position_scale,
        velocity_scale=ready.velocity_scale,
        max_attempts=ATTEMPTS * len(experiment.data) + 1000,
    )
    try:
        run = _core.simulate(under.kind, under.values(), under.active(), ready.core, [], settings)
    except NumericalError:
        return None
    outputs = dict(zip((s.name for s in under.info.outputs), run["outputs"], strict=True))
    names = [name for name in outputs if name in experiment.data.columns]
    return {name: float(((experiment.data[name] - outputs[name]) ** 2).mean()) for name in names}
