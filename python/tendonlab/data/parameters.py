"""The [system] tables: kind, axis, nominal effects and the simulator's parameters, checked against the catalog."""

import math
from collections.abc import Mapping

from tendonlab.catalog import Parameter, SystemInfo, kinds, system_info

from tendonlab.data.dataset import NominalParameter
from tendonlab.data.names import expected_one_of
from tendonlab.data.schema import Table


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
    """The nominal values by name. Raises DatasetError: unknown, not nominal, outside its bounds."""
    tables = top.table("system").table("parameters", optional=True)
    nominal = {}
    for name in tables.values:
        parameter = find_parameter(tables, name, info=info, nominal_effects=nominal_effects)
        nominal[name] = _read_parameter(tables.table(name), parameter)
    return nominal


def missing_values(
    parameters: Mapping[str, NominalParameter], info: SystemInfo, *, nominal_effects: tuple[str, ...]
) -> list[str]:
    """A warning for every nominal parameter without a value; that of `torque_constant` is 1 unless given."""
    return [
        f"{parameter.name}: no nominal value given; the library's typical value {parameter.typical:g} is assumed"
        for parameter in info.parameters
        if parameter.name not in parameters
        and parameter.name != "torque_constant"
        and _is_nominal(parameter, info, nominal_effects)
    ]


def find_parameter(table: Table, name: str, *, info: SystemInfo, nominal_effects: tuple[str, ...]) -> Parameter:
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


def _read_parameter(table: Table, parameter: Parameter) -> NominalParameter:
    table.allow(("value", "sd", "min", "max"))
    value = table.number("value")
    sd = table.number("sd", lower=0.0) if "sd" in table.values else None
    lower = max(table.number("min", -math.inf, infinite=True), parameter.lower)
    upper = min(table.number("max", math.inf, infinite=True), parameter.upper)
    if lower > upper:
        raise table.error("min", f"{lower:g} is above the upper bound {upper:g}; expected min <= max")
    require_within(table, "value", value, lower=lower, upper=upper)
    return NominalParameter(value=value, sd=sd, lower=lower, upper=upper)


def _effects_with(parameter: Parameter, info: SystemInfo) -> list[str]:
    return [effect.name for effect in info.effects if parameter.name in effect.parameters]


def _is_nominal(parameter: Parameter, info: SystemInfo, nominal_effects: tuple[str, ...]) -> bool:
    """Whether the simulator has it: always, or by an effect that it contains."""
    if parameter.effect is None:
        return True
    return any(effect in nominal_effects for effect in _effects_with(parameter, info))
