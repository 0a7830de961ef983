"""The [controller] table: how the rig closed its loop."""

import math
from collections.abc import Mapping

from tendonlab.data.schema import Table
from tendonlab.errors import expected_one_of
from tendonlab.simulation.catalog import SystemInfo
from tendonlab.simulation.records import Controller, SignalSpec

KEYS = ("kind", "kp", "kd", "measured", "reference", "limit", "derivative_on", "sample_time", "disturbance")


def read_controller(top: Table) -> Controller | None:
    """The controller as written, or None. Raises DatasetError at an unknown key or a value of the wrong type."""
    if "controller" not in top.values:
        return None
    table = top.table("controller")
    table.allow(KEYS)
    kind = table.choice("kind", ("pd", "cascade"))
    disturbance = table.text("disturbance") if "disturbance" in table.values else None
    controller = Controller(
        kind=kind,
        kp=table.number("kp"),
        kd=table.number("kd", 0.0 if kind == "pd" else None),
        measured=table.text("measured"),
        reference=table.text("reference"),
        limit=table.number("limit", math.inf, lower=0.0, infinite=True),
        derivative_on=table.choice("derivative_on", ("error", "measurement"), "error"),
        sample_time=table.number("sample_time", 0.0, lower=0.0),
        disturbance=disturbance,
    )
    if controller.limit == 0.0:
        raise table.error("limit", "0: expected a positive number")
    if disturbance == controller.reference:
        raise table.error("disturbance", f"{disturbance!r} is the reference already; expected another signal")
    return controller


def check_controller(top: Table, *, signals: Mapping[str, SignalSpec], info: SystemInfo) -> None:
    """Raise DatasetError unless the signals that the controller names are declared and fit their roles."""
    controller = read_controller(top)
    if controller is None:
        return
    table = top.table("controller")
    angles = [output.name for output in info.outputs if output.dimension == "displacement" and output.name in signals]
    if controller.measured not in angles:
        problem = f"{controller.measured!r} is no measured angle of {info.kind}"
        raise table.error("measured", f"{problem}; {expected_one_of(controller.measured, angles)}")
    for key, name in (("reference", controller.reference), ("disturbance", controller.disturbance)):
        if name is None:
            continue
        if name not in signals:
            raise table.error(key, f"{name!r} is not declared as [signals.{name}]; {expected_one_of(name, signals)}")
        if signals[name].role != key:
            problem = f"{name!r} is an {signals[name].role} of {info.kind}; expected a signal of its own"
            raise table.error(key, problem)
