"""The twin's maps as a dataset of the library, and simulators of them, on which S0's own gap is diagnosed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pandas as pd

from tendonlab.data import Dataset, Experiment, NominalParameter, SignalSpec
from tendonlab.papers.s0 import twin
from tendonlab.papers.s0.bearings import relative_load
from tendonlab.papers.s0.bench import LOADS, NUM_RUNS, Configuration, configuration, loaded
from tendonlab.papers.s0.maps import twin_map
from tendonlab.papers.s0.models import Lugre, Proposed, printed_lugre
from tendonlab.seed import generator
from tendonlab.simulation.system import System

LUGRE, PROPOSED = ("contact:static_lugre", "contact:viscous"), ("contact:load_and_ratio",)
PASSES = 4  # maps of each configuration; the runs of a point are dealt out among them
HELD_OUT = 1  # of them
INTERVAL = 0.2  # s from point to point: steady points have no time, and this gives them an order


def lugre_system(model: Lugre) -> System:
    """The static LuGre curve as a simulator of the library: friction without load dependence."""
    return System(kind="friction_map", effects=LUGRE, parameters=_lugre_values(model))


def proposed_system(model: Proposed, *, ratio: float) -> System:
    """The load-and-ratio model as a simulator of the library."""
    law = model.law(ratio)
    values = {row.name: float(getattr(law, row.name)) for row in law.parameters}
    return System(kind="friction_map", effects=PROPOSED, parameters=values)


def load_dataset(
    transmission: str,
    *,
    seed: int = 0,
    law: Callable[[Configuration, np.ndarray], np.ndarray] = twin.friction,
) -> Dataset:
    """Twin maps of a transmission under its four loads, and the static LuGre simulator with the values of S0 Table 6
    or 7: the load, that the simulator lacks, is withheld.

    Each load is mapped in four passes of five runs per point in both directions; the passes repeat one another, the
    last is held out. Everything is reconstructed. `law`: the friction of the twin, `twin.friction`, or
    `twin.proposed_friction`, which is S0 eq. 11."""
    rng = generator(seed)
    ratio = configuration(transmission).ratio()
    passes = [(load, k) for load in LOADS for k in range(1, PASSES + 1)]
    experiments = [_experiment(transmission, load, k, ratio=ratio, rng=rng, law=law) for load, k in passes]
    values = _lugre_values(printed_lugre(transmission))
    alpha = "contact_lugre_stribeck_exponent"
    parameters = {
        name: NominalParameter(value, sd=0.0 if name == alpha else None, lower=0.0) for name, value in values.items()
    }
    return Dataset(
        name=f"{transmission} under four loads",
        description="Twin of the bench of S0, reconstructed: steady points of four loads, both directions.",
        kind="friction_map",
        axis="rotary",
        nominal_effects=LUGRE,
        parameters=parameters,
        controller=None,
        signals={
            "speed": SignalSpec("speed", "speed", "rad/s", "input", hold=False, si_unit="rad/s"),
            "friction_torque": SignalSpec(
                "friction_torque",
                "friction_torque",
                "N*m",
                "output",
                hold=False,
                noise_sd=_noise(experiments),
                si_unit="N*m",
            ),
        },
        experiments=tuple(experiments),
        path=Path(),
    )


def held_out(rig: Dataset, models: Mapping[str, Callable[[np.ndarray, float], np.ndarray]]) -> pd.DataFrame:
    """RMS error of models of speed, rad/s, and relative load on the maps held out, N·m, and the `shrinkage` of the gap
    over the noise from the first model on."""
    noise = rig.signals["friction_torque"].noise_sd or 0.0
    errors = {
        name: np.concatenate([_error(model, experiment) for experiment in rig.test]) for name, model in models.items()
    }
    rms = pd.Series({name: float(np.sqrt(np.mean(np.square(e)))) for name, e in errors.items()})
    gap = np.sqrt(np.maximum(rms.to_numpy() ** 2 - noise**2, 0.0))
    return pd.DataFrame({"rms": rms, "shrinkage": 1 - gap / gap[0]})


def training_points(rig: Dataset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed rad/s, relative load 1 and friction torque N·m of all points to fit, shape (n,) each."""
    loads = [np.full(len(e.data), e.conditions["relative_load"]) for e in rig.train]
    speed, torque = (np.concatenate([e.data[name] for e in rig.train]) for name in ("speed", "friction_torque"))
    return speed, np.concatenate(loads), torque


def partial_correlations(rig: Dataset, model: Lugre) -> pd.Series[float]:
    """Of what `model` leaves on the maps to fit, along the motion: correlation with relative load, speed (magnitude)
    and direction, each at given values of the two others. A steady point has no position."""
    speed, load, torque = training_points(rig)
    residual = np.sign(speed) * (torque - model.torque(speed))
    causes = {"relative load": load, "speed": np.abs(speed), "direction": np.sign(speed)}
    found = {}
    for name, cause in causes.items():
        others = np.column_stack([np.ones_like(speed), *(c for other, c in causes.items() if other != name)])
        left = [y - others @ np.linalg.lstsq(others, y, rcond=None)[0] for y in (residual, cause)]
        found[name] = float(np.corrcoef(*left)[0, 1])
    return pd.Series(found)


def _error(model: Callable[[np.ndarray, float], np.ndarray], experiment: Experiment) -> np.ndarray:
    data = experiment.data
    found = model(data["speed"].to_numpy(), experiment.conditions["relative_load"])
    return np.asarray(found - data["friction_torque"].to_numpy())


def _experiment(
    transmission: str,
    load: str,
    k: int,
    *,
    ratio: float,
    rng: np.random.Generator,
    law: Callable[[Configuration, np.ndarray], np.ndarray],
) -> Experiment:
    of = loaded(transmission, load)
    points = twin_map(of, num_runs=NUM_RUNS // PASSES, seed=rng, law=law)
    frame = pd.DataFrame({"speed": points["speed"], "friction_torque": points["torque"]})
    frame.index = pd.Index(INTERVAL * np.arange(len(frame)), name="t")
    return Experiment(
        name=f"{of.name} pass {k}",
        data=frame,
        split="test" if k > PASSES - HELD_OUT else "train",
        repeat=of.name,
        conditions={"relative_load": relative_load(of), "transmission_ratio": ratio},
        holds={"speed": False},
    )


def _noise(experiments: list[Experiment]) -> float:
    """Sd of a point from how its passes differ, N·m."""
    labels = dict.fromkeys(e.repeat for e in experiments)
    rows = [np.array([e.data["friction_torque"] for e in experiments if e.repeat == label]) for label in labels]
    return float(np.sqrt(np.mean([r.var(axis=0, ddof=1) for r in rows])))


def _lugre_values(model: Lugre) -> dict[str, float]:
    return {
        "contact_lugre_coulomb": model.F_c,
        "contact_lugre_static_friction": model.F_s,
        "contact_lugre_stribeck_velocity": model.theta_s,
        "contact_lugre_stribeck_exponent": model.alpha,
        "contact_viscous": model.F_v,
    }
