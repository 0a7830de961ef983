"""The [system] tables: kind, axis, nominal effects and the simulator's parameters, checked against the catalog."""

import math
from collections.abc import Iterable, Mapping

from tendonlab.data.schema import Table
from tendonlab.errors import expected_one_of
from tendonlab.simulation.catalog import ParameterInfo, SystemInfo, kinds, system_info
from tendonlab.simulation.records import Experiment, NominalParameter


def read_system(top: Table) -> tuple[SystemInfo, str]:
    """The system and its axis. Raises DatasetError at an unknown kind, axis or key."""
    table = top.table("system")
    table.allow(("kind", "axis", "nominal_effects", "parameters"))
    kind = table.text("kind")
    if kind not in kinds():
        raise table.error("kind", f"{kind!r} is no system of the library; {expected_one_of(kind, kinds())}")
    return system_info(kind), table.choice("axis", ("rotary", "linear"), "rotary")


def read_nominal_effects(top: Table, info: SystemInfo) -> tuple[str, ...]:
    """What the simulator already contains; the system's default where nothing is said."""
    table = top.table("system")
    if "nominal_effects" not in table.values:
        return info.default_nominal_effects
    names = table.texts("nominal_effects")
    known = [effect.name for effect in info.effects]
    for name in names:
        if name not in known:
            raise table.error(
                "nominal_effects", f"{name!r} is no effect of {info.kind}; {expected_one_of(name, known)}"
            )
    return names


def read_parameters(top: Table, info: SystemInfo, *, nominal_effects: tuple[str, ...]) -> dict[str, NominalParameter]:
    """The nominal values by name, of everything that the simulator contains. Raises DatasetError: unknown, not nominal,
    outside its bounds, or absent where no value would mean that it is not there."""
    tables = top.table("system").table("parameters", optional=True)
    for name in tables.values:
        find_parameter(tables, name, info=info, nominal_effects=nominal_effects)
    nominal = {}
    for parameter in info.parameters:
        if parameter.name in tables.values:
            nominal[parameter.name] = _read_parameter(tables.table(parameter.name), parameter)
        elif _is_nominal(parameter, info, nominal_effects):
            nominal[parameter.name] = _assume(tables, parameter, info)
    return nominal


def assumptions(
    top: Table,
    parameters: Mapping[str, NominalParameter],
    experiments: Iterable[Experiment],
    info: SystemInfo,
    *,
    command_is_effort: bool,
) -> list[str]:
    """A warning for every parameter without a value in the file or in the conditions of every experiment; none for a
    gain of the command where the command is an effort."""
    written = set(top.table("system").table("parameters", optional=True).values)
    stated = set.intersection(*(set(experiment.conditions) for experiment in experiments))
    gain = info.with_role("command_gain")
    silent = written | stated | ({gain.name} if gain is not None and command_is_effort else set())
    return [
        f"No nominal value given for {name}; {parameter.value:g} is assumed"
        + (", exactly" if parameter.sd == 0.0 else "")
        for name, parameter in parameters.items()
        if name not in silent
    ]


def find_parameter(table: Table, name: str, *, info: SystemInfo, nominal_effects: tuple[str, ...]) -> ParameterInfo:
    """The parameter that the key `name` of `table` means. Raises DatasetError where it is unknown or not nominal."""
    usable = [p.name for p in info.parameters if _is_nominal(p, info, nominal_effects)]
    parameter = next((p for p in info.parameters if p.name == name), None)
    if parameter is None:
        raise table.error(name, f"{name!r} is no parameter of {info.kind}; {expected_one_of(name, usable)}")
    if name not in usable:
        effects = " or ".join(repr(effect) for effect in _effects_with(parameter, info))
        raise table.error(name, f"belongs to {effects}, which is not among system.nominal_effects; expected it there")
    return parameter


def require_within(table: Table, key: str, value: float, *, lower: float, upper: float) -> None:
    """Raise DatasetError unless lower <= value <= upper."""
    if not lower <= value <= upper:
        raise table.error(key, f"{value:g} is outside its bounds; expected a value in [{lower:g}, {upper:g}]")


def _read_parameter(table: Table, parameter: ParameterInfo) -> NominalParameter:
    table.allow(("value", "sd", "min", "max"))
    value = table.number("value")
    sd = table.number("sd", lower=0.0, infinite=True) if "sd" in table.values else None
    lower = max(table.number("min", -math.inf, infinite=True), parameter.lower)
    upper = min(table.number("max", math.inf, infinite=True), parameter.upper)
    if lower > upper:
        raise table.error("min", f"{lower:g} is above the upper bound {upper:g}; expected min <= max")
    require_within(table, "value", value, lower=lower, upper=upper)
    return NominalParameter(value=value, sd=sd, lower=lower, upper=upper)


def _assume(table: Table, parameter: ParameterInfo, info: SystemInfo) -> NominalParameter:
    """What an absent value means: that part of the simulator is not there, or is as the table has it."""
    structural = {effect.name for effect in info.effects if effect.structural}
    own = parameter.effect is None or not structural.isdisjoint(_effects_with(parameter, info))
    counted = parameter.purpose == "shape" and parameter.dimension in ("ratio", "time")
    usual = own and (parameter.typical == 0.0 or parameter.role == "command_gain")
    if parameter.purpose in ("condition", "share") or usual:
        value, known = parameter.typical, True
    elif not own and counted:
        value, known = parameter.typical, False
    elif not own and parameter.lower <= 0.0 <= parameter.upper:
        value, known = 0.0, False
    else:
        raise table.error(parameter.name, f"is missing; expected the nominal value ({parameter.meaning})")
    return NominalParameter(value=value, sd=0.0 if known else None, lower=parameter.lower, upper=parameter.upper)


def _effects_with(parameter: ParameterInfo, info: SystemInfo) -> list[str]:
    return [effect.name for effect in info.effects if parameter.name in effect.parameters]


def _is_nominal(parameter: ParameterInfo, info: SystemInfo, nominal_effects: tuple[str, ...]) -> bool:
    """Whether the simulator has it: of the system itself, or of an effect that it contains."""
    contained = {effect.name for effect in info.effects if effect.structural} | set(nominal_effects)
    return parameter.effect is None or not contained.isdisjoint(_effects_with(parameter, info))
