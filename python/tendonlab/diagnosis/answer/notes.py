"""What a reader must know beside the numbers: warnings, and how the numbers came about."""

from __future__ import annotations

from typing import Any

from tendonlab.diagnosis.answer import where
from tendonlab.diagnosis.search.select import Search
from tendonlab.fitting.case import Case
from tendonlab.fitting.fitted import Fitted
from tendonlab.fitting.floor import RUN_TO_RUN_UNKNOWN
from tendonlab.fitting.noise import Floor
from tendonlab.fitting.uncertainty import FEWEST_EXPERIMENTS
from tendonlab.simulation.catalog import unit

UNSTEADY = 0.03  # relative sd of friction from run to run beyond which repeatability is the limit


def warnings(case: Case, floor: Floor, search: Search) -> list[str]:
    """What weakens the answer."""
    said = list(case.dataset.warnings)
    if not floor.repeated:
        said.append(
            "no repeats: the floor is the sensors' noise and an assumed run-to-run variation of friction of "
            f"{RUN_TO_RUN_UNKNOWN:.0%}; what the model leaves counts as noise, so that what is found is established "
            "conservatively and what is not found may still be there"
        )
    if not case.test:
        few = "" if len(case.train) > 1 else "; with a single experiment they are those of the experiment fitted"
        said.append(f"no experiment is held out: gaps and shrinkage leave one experiment out of the fit in turn{few}")
    if len(case.train) < FEWEST_EXPERIMENTS:
        said.append(
            f"{len(case.train)} training experiment{'s' if len(case.train) > 1 else ''}: contiguous blocks of at least "
            "2 s stand for experiments where one is left out"
        )
    silent = search.final.not_informed
    bound = [
        f.name for f, at in zip(search.final.free, search.final.at_bound, strict=True) if at and f.name not in silent
    ]
    if bound:
        said.append(f"at a bound or the edge of its range: {', '.join(bound)}")
    if silent:
        said.append(f"not informed by these data and held at the nominal value: {', '.join(silent)}")
    if floor.repeated and floor.tau > UNSTEADY:
        said.append(f"friction differs by {floor.tau:.1%} from run to run: repeatability limits what can be said")
    for model in {m.added: m for m in (search.tuned, search.final)}.values():
        if not model.converged:
            said.append(
                f"the fit of {', '.join(model.added) or 'the refitted simulator'} stopped early: {model.message}"
            )
    return said


def units(case: Case) -> dict[str, str]:
    """Unit of every output and of every coordinate of the where-map."""
    info, axis = case.system.info, case.system.axis
    found = {s.name: unit(s.dimension, axis) for s in info.outputs}
    for port in info.ports:
        own = info.element_axes.get(port.element, axis)
        found |= {f"{port.name}_{q}": unit(where.dimension(port, q), own) for q in where.COORDINATES}
    return found | {"time": "s"}


def details(case: Case, floor: Floor, nominal: Fitted, search: Search) -> dict[str, Any]:
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
    }


def _parameter(case: Case, best: Fitted, name: str) -> dict[str, Any]:
    value, interval = best.value(name)
    return {
        "value": value,
        "ci95": list(interval),
        "unit": best.system.unit(name),
        "nominal": case.system.parameters.get(name),
        "informed": name not in best.not_informed,
    }
