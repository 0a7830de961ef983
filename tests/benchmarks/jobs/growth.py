"""How cost grows with bristles, parameters of the gradient, samples, and points of a sweep."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

import tendonlab as tl
from benchmarks import mass, mechanism
from benchmarks.clock import Call, alternate
from benchmarks.options import Options
from benchmarks.peers import natives
from benchmarks.sweep import masses
from benchmarks.table import Table, count_text, ratio_text, seconds_text
from tendonlab import _core
from tendonlab.simulation.signals import smooth
from tendonlab.simulation.system import System

TOLERANCE = 1e-4
PARAMETERS = (0, 1, 2, 4, 6, 8, 12, 16, 20, 25, 30)
SAMPLES = (1_000, 10_000, 100_000, 1_000_000)
POINTS = (1, 10, 100, 1_000, 10_000, 100_000)
MOST_ROUNDS = 3  # of the long ones
SYSTEMS_NOTE = "Time per attempted step with 11 outputs."
CONTACTS = (1, 4, 16, 32, 64)
CONTACTS_NOTE = (
    "Time per attempted step of one joint with so many bristles, each with Coulomb, viscous and Stribeck friction; "
    "compiled for this table, since five contacts are the most that a system of the library has."
)
CORE = Path(__file__).resolve().parents[3] / "cpp"
COMPILER = (
    *("c++", "-std=c++17", f"-I{CORE}", "-fno-math-errno", "-fno-trapping-math", "-fno-signed-zeros"),
    *("-ffp-contract=fast", "-fno-ipa-sra", "--param=sra-max-scalarization-size-Ospeed=8192", "-Wno-psabi"),
)
# Effects that bring J2 to 30 directions; each too weak to change its motion much.
MORE: dict[str, dict[str, float]] = {
    "joint:viscous": {"viscous": 1e-4},
    "joint:stribeck": {"static_excess": 1e-4, "stribeck_velocity": 0.01},
    "joint:load_dependence": {"load_dependence": 1e-4},
    "joint:asymmetry": {"level_asymmetry": 0.01, "viscous_asymmetry": 0.01},
    "contact:asymmetry": {"coefficient_asymmetry": 0.01},
    "contact:coulomb": {"coulomb": 1e-3},
    "contact:load_dependence": {"load_dependence": 1e-4},
    "cable:viscous": {"viscous": 1e-3},
}
SHARES = ("joint_presliding_share", "presliding_share", "stribeck_share")


def run(options: Options) -> list[Table]:
    return [
        _systems(options.rounds),
        _contacts(options.rounds),
        _parameters(options.rounds),
        _samples(options.rounds),
        _points(options.rounds),
    ]


def simulation(system: System, driver: np.ndarray, time: np.ndarray, num: int, seeds: Any = ()) -> Call:
    """A call of the core with `num` samples, under a spline through `driver` at `time`."""
    empty = [_core.Signal() for _ in system.info.inputs[1:]]
    experiment = _core.Experiment(
        kind=system.kind,
        time=np.linspace(time[0], time[-1], num).tolist(),
        inputs=[smooth(time, driver), *empty],
        loop=_core.Loop(),
        position=[0.0] * system.info.dof,
        velocity=[0.0] * system.info.dof,
    )
    settings = _core.Settings(tolerance=TOLERANCE)
    given = (system.kind, system.values(), system.active(), experiment, list(seeds), settings)
    return lambda: _core.simulate(*given)


def _contacts(rounds: int) -> Table:
    columns, title = ("bristles", "per step", "ratio", "per step and bristle"), "Growth with contacts"
    core = natives.shared_object("contacts.cpp", *COMPILER)
    if core is None:
        return Table(columns, (), ("Skipped: no C++ compiler that can compile the core.",), title)
    core.simulate.argtypes, core.simulate.restype = (ctypes.c_int, ctypes.c_double), ctypes.c_long
    calls = [partial(core.simulate, num, TOLERANCE) for num in CONTACTS]
    steps = [call() for call in calls]
    each = [spent / num for spent, num in zip(alternate(calls, rounds=rounds), steps, strict=True)]
    found = [
        (str(num), seconds_text(s), ratio_text(s / each[0]), seconds_text(s / num))
        for num, s in zip(CONTACTS, each, strict=True)
    ]
    return Table(columns, tuple(found), (CONTACTS_NOTE,), title)


def _systems(rounds: int) -> Table:
    one, five = mass.driven(force=False), mechanism.coupled(tensions=True)
    sine = np.sin(2.0 * np.pi * mass.FREQUENCY * one.time)
    turn = mechanism.AMPLITUDE * np.sin(mechanism.OMEGA * five.time)
    without_joint = replace(five.system, effects=mechanism.EFFECTS[2:], parameters=_without_joint(five.system))
    elastic = five.system.with_effects({"ends:compliance": {"compliance": 2e-6}})
    cases = (
        ("rigid_joint", "1", "1", simulation(one.system, sine, one.time, 11)),
        ("ccsrm, contacts", "1", "4", simulation(without_joint, turn, five.time, 11)),
        ("ccsrm, contacts and joint", "1", "5", simulation(five.system, turn, five.time, 11)),
        ("ccsrm with elastic ends, contacts and joint", "5", "5", simulation(elastic, turn, five.time, 11)),
    )
    steps = [call()["attempts"] for *_, call in cases]
    spent = alternate([call for *_, call in cases], rounds=rounds)
    each = [seconds / num for seconds, num in zip(spent, steps, strict=True)]
    found = [(*case[:3], seconds_text(s), ratio_text(s / each[0])) for case, s in zip(cases, each, strict=True)]
    return Table(
        ("system", "DoF", "bristles", "per step", "ratio"), tuple(found), (SYSTEMS_NOTE,), "Systems of the library"
    )


def _without_joint(system: System) -> dict[str, float]:
    return {name: value for name, value in system.parameters.items() if not name.startswith("joint_")}


def _parameters(rounds: int) -> Table:
    problem = mechanism.coupled(tensions=True)
    system = problem.system.with_effects(MORE)
    turn = mechanism.AMPLITUDE * np.sin(mechanism.OMEGA * problem.time)
    own = [k for k, p in enumerate(system.info.parameters) if p.name in system.parameters or p.name in SHARES]
    seeds = [("position", 0), ("velocity", 0), *(("parameter", k) for k in own)]
    numbers = [num for num in PARAMETERS if num <= len(seeds)]
    calls = [simulation(system, turn, problem.time, len(problem.time), seeds[:num]) for num in numbers]
    spent = alternate(calls, rounds=min(rounds, MOST_ROUNDS))
    found = [(str(num), seconds_text(s), ratio_text(s / spent[0])) for num, s in zip(numbers, spent, strict=True)]
    note = f"J2 with all friction of its joint, contacts and cables, 10 001 samples, tolerance {TOLERANCE:.0e}."
    return Table(("directions", "time", "ratio"), tuple(found), (note,), "Growth with parameters of the gradient")


def _samples(rounds: int) -> Table:
    problem = mass.driven(force=False)
    sine = np.sin(2.0 * np.pi * mass.FREQUENCY * problem.time)
    calls = [simulation(problem.system, sine, problem.time, num) for num in SAMPLES]
    spent = alternate(calls, rounds=min(rounds, MOST_ROUNDS))
    found = [(count_text(num), seconds_text(s), seconds_text(s / num)) for num, s in zip(SAMPLES, spent, strict=True)]
    note = f"J1a over 1 s, tolerance {TOLERANCE:.0e}."
    return Table(("samples", "time", "per sample"), tuple(found), (note,), "Growth with samples")


def _points(rounds: int) -> Table:
    whole = masses(POINTS[-1])
    parts = [whole.first(num) for num in POINTS]

    def call(part: Any) -> Call:
        given = {"experiment": whole.problem.experiment, "reduce": "rms", "tolerance": TOLERANCE, "progress": False}
        return lambda: tl.sweep(whole.problem.system, part.table, **given)

    spent = alternate([call(part) for part in parts], rounds=min(rounds, MOST_ROUNDS))
    found = [(count_text(num), seconds_text(s), seconds_text(s / num)) for num, s in zip(POINTS, spent, strict=True)]
    note = f'J1 through `tl.sweep` with `reduce="rms"`, 1001 samples, two outputs, tolerance {TOLERANCE:.0e}.'
    return Table(("points", "time", "per point"), tuple(found), (note,), "Growth with points of a sweep")
