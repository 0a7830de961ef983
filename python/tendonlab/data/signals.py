"""The [signals] tables: role, unit and holding of each signal."""

from tendonlab.data.schema import Table
from tendonlab.data.units import COMMAND_UNITS, base_unit, convert_difference, require_dimension, same_dimension
from tendonlab.errors import DatasetError, nearest_name
from tendonlab.simulation.catalog import InputInfo, OutputInfo, SystemInfo, unit
from tendonlab.simulation.records import Controller, SignalSpec

KEYS = ("column", "unit", "hold", "noise_sd", "resolution")


def read_signals(top: Table, info: SystemInfo, *, axis: str, controller: Controller | None) -> dict[str, SignalSpec]:
    """Every declared signal by name. Raises DatasetError: unknown key, unit of the wrong dimension, a required input
    that is missing, no output."""
    tables = top.table("signals")
    command = _command_unit(tables, info, axis=axis)
    specs = {}
    for name in tables.values:
        table = tables.table(name)
        table.allow(KEYS)
        role = _role(name, info, controller)
        expected = _expected_unit(name, info, axis=axis, controller=controller, command=command)
        specs[name] = _read_signal(table, name, role=role, expected=expected, hold=_holds(name, role, info))
    _require_inputs(tables, info)
    _require_own_columns(tables, specs)
    if not any(spec.role == "output" for spec in specs.values()):
        names = ", ".join(output.name for output in info.outputs)
        raise top.error("signals", f"no output of {info.kind} is measured; expected at least one of {names}")
    return specs


def _read_signal(table: Table, name: str, *, role: str, expected: str | None, hold: bool) -> SignalSpec:
    if role == "output" and "hold" in table.values:
        raise table.error("hold", f"{name} is an output; hold is expected at inputs only")
    written = table.text("unit", expected or "1")
    try:
        if expected is not None:
            require_dimension(written, expected)
        si_unit = base_unit(written) if expected is None else expected
    except DatasetError as error:
        raise table.error("unit", str(error)) from error
    spread = {
        key: convert_difference(table.number(key, lower=0.0), unit=written, to=si_unit) if key in table.values else None
        for key in ("noise_sd", "resolution")
    }
    return SignalSpec(
        name=name,
        column=table.text("column", name),
        unit=written,
        role=role,
        hold=table.flag("hold", hold),
        noise_sd=spread["noise_sd"],
        resolution=spread["resolution"],
        si_unit=si_unit,
        hold_stated="hold" in table.values,
    )


def _role(name: str, info: SystemInfo, controller: Controller | None) -> str:
    if any(signal.name == name for signal in info.inputs):
        return "input"
    if any(signal.name == name for signal in info.outputs):
        return "output"
    if controller is not None and name in (controller.reference, controller.disturbance):
        return "reference" if name == controller.reference else "disturbance"
    return "covariate"


def _holds(name: str, role: str, info: SystemInfo) -> bool:
    """The default: commands, targets and disturbances are held between samples, what is measured is not."""
    held = {signal.name: signal.between == "hold" for signal in info.inputs}
    return held.get(name, role in ("reference", "disturbance"))


def _expected_unit(
    name: str, info: SystemInfo, *, axis: str, controller: Controller | None, command: str
) -> str | None:
    """The unit that the samples are converted to; None: whatever SI has for a covariate's own."""
    if controller is not None and name == controller.disturbance:
        return command
    if controller is not None and name == controller.reference:
        return unit("displacement", axis)
    signal = _find(name, info)
    if signal is None:
        return None
    return command if signal.dimension == "command" else unit(signal.dimension, axis)


def _command_unit(tables: Table, info: SystemInfo, *, axis: str) -> str:
    """The unit of the command: of an effort, or A, V or 1, which a gain of the command converts."""
    effort = unit("effort", axis)
    command = info.command
    if command is None or command.name not in tables.values:
        return effort
    table = tables.table(command.name)
    written = table.text("unit", effort)
    if written in COMMAND_UNITS:
        return written
    try:
        if same_dimension(written, effort):
            return effort
        converted = next((allowed for allowed in COMMAND_UNITS if same_dimension(written, allowed)), None)
        if converted is not None:
            return converted
        require_dimension(written, effort)
    except DatasetError as error:
        raise table.error("unit", str(error)) from error
    return effort


def _find(name: str, info: SystemInfo) -> InputInfo | OutputInfo | None:
    return next((signal for signal in info.signals if signal.name == name), None)


def _require_own_columns(tables: Table, specs: dict[str, SignalSpec]) -> None:
    """Raise DatasetError where an output is read from the column of another output or of an input."""
    outputs = [spec for spec in specs.values() if spec.role == "output"]
    for output in outputs:
        for other in specs.values():
            if other.name != output.name and other.role in ("input", "output") and other.column == output.column:
                problem = f"{output.column!r} is the column of {other.name} too; expected one column per output"
                raise tables.table(output.name).error("column", problem)


def _require_inputs(tables: Table, info: SystemInfo) -> None:
    for signal in info.inputs:
        if signal.required and signal.name not in tables.values and signal.replaced_by not in tables.values:
            match = nearest_name(signal.name, tables.values)
            hint = f"; the file has {match!r}" if match is not None else ""
            raise tables.error(signal.name, f"is missing; expected this input, which {info.kind} requires{hint}")
