"""Inputs that a rig may lack and that were not logged: a warning where a measured output depends on them."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from tendonlab.data.dataset import Dataset
from tendonlab.data.schema import FILE
from tendonlab.errors import DatasetError, NumericalError, ParameterError

if TYPE_CHECKING:
    from tendonlab.simulation.system import System

TIME = np.linspace(0.0, 1.0, 9)
SHARE = 1e-3  # of its typical size that every effect has here: none is left out, none outweighs what is there


def absent_inputs(dataset: Dataset) -> list[str]:
    """A warning for inputs that count as 0 although a measured output depends on them, directly or through an effect
    that may be added. Raises DatasetError for an output that depends on such inputs only."""
    system, logged = dataset.system(), set(dataset.inputs)
    absent = [s.name for s in system.info.inputs if s.warn_if_absent and s.name not in logged]
    if not absent:
        return []
    try:
        missed = {name: _moved(system, [name]) & set(dataset.outputs) for name in absent}
        seen = _moved(system, logged)
    except (NumericalError, ParameterError):  # of these values; a simulation with them raises it
        return []
    remedy = "log them, or add columns of zeros"
    outputs = [name for name in dataset.outputs if any(name in of for of in missed.values())]
    for name in outputs:
        if name not in seen:
            causes = ", ".join(cause for cause, of in missed.items() if name in of)
            raise DatasetError(
                f"{FILE}, key signals.{name}: depends only on inputs that were not logged: {causes}; {remedy}"
            )
    causes = ", ".join(cause for cause, of in missed.items() if of)
    assumed = f"{FILE}, key signals: inputs that were not logged are taken as 0: {causes}"
    return [f"{assumed}; outputs that depend on them: {', '.join(outputs)}; {remedy}"] if causes else []


def _moved(system: System, inputs: Collection[str]) -> set[str]:
    """The outputs that change where `inputs` stop, all others moving."""
    before, after = _outputs(system, ()), _outputs(system, inputs)
    differ = np.max(np.abs(after - before), axis=1) > 1e-12 * np.max(np.abs(before), axis=1)
    return {s.name for s, one in zip(system.info.outputs, differ, strict=True) if one}


def _outputs(system: System, still: Collection[str]) -> np.ndarray:
    """Outputs of the simulator with a little of every effect, driven for a second by inputs that have nothing in
    common, except those that are held `still`."""
    from tendonlab import _core
    from tendonlab.simulation.signals import linear

    info = system.info
    little = [min(max(SHARE * p.typical, p.lower), p.upper) if p.amplitude else 0.0 for p in info.parameters]
    values = [value or more for value, more in zip(system.values(), little, strict=True)]
    moving = [linear(TIME, np.sin((k + 2.0) * TIME + 1.0)) for k in range(len(info.inputs))]
    experiment = _core.Experiment(
        kind=info.kind,
        time=TIME.tolist(),
        inputs=[_core.Signal() if s.name in still else one for s, one in zip(info.inputs, moving, strict=True)],
        loop=_core.Loop(),
        position=[0.0] * info.dof,
        velocity=[0.0] * info.dof,
    )
    active = [True] * len(info.effects)
    found = _core.simulate(info.kind, values, active, experiment, [], _core.Settings())
    return np.asarray(found["outputs"])
