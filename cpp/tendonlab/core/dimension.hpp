#pragma once
// Dimensions: one row each, with name, units and the scale of the rig in which typical values count.
#include <cstddef>
#include <iterator>
#include <string_view>

namespace tendonlab {
/// Effort and flow are N·m and rad/s on a rotary axis, N and m/s on a linear one; those up to `stiffness` follow from
/// them. The others mean the same on every axis. `effort_per_load` is what a law loses per load that its port sees: a
/// ratio, but an effort without upper bound where that load is itself a ratio (systems::Port::load).
enum class Dimension {
  effort,
  flow,
  displacement,
  inertia,
  damping,
  stiffness,
  ratio,
  time,
  command,
  effort_per_command,
  output,
  force,
  length,
  speed,
  line_stiffness,
  line_damping,
  mass,
  angle,
  angular_speed,
  torque,
  voltage,
  current,
  resistance,
  inductance,
  torque_per_current,
  acceleration,
  line_compliance,
  per_flow_squared,
  inverse_flow,
  effort_per_load,
  voltage_per_displacement,
  count
};
/// What a rig was seen to do: its rms effort, its rms speed, the spread of its position.
enum class Scale { one, effort, flow, displacement };

/// `rotary` and `linear`: the unit on such an axis. A typical value counts in units of the rig's `scale` over `per`.
struct DimensionInfo {
  Dimension dimension;
  std::string_view name, rotary, linear;
  Scale scale = Scale::one, per = Scale::one;
};
/// Unless a dataset says otherwise, the command is the effort itself.
inline constexpr DimensionInfo dimensions[] = {
    {Dimension::effort, "effort", "N*m", "N", Scale::effort},
    {Dimension::flow, "flow", "rad/s", "m/s", Scale::flow},
    {Dimension::displacement, "displacement", "rad", "m", Scale::displacement},
    {Dimension::inertia, "inertia", "kg*m^2", "kg"},
    {Dimension::damping, "damping", "N*m*s/rad", "N*s/m", Scale::effort, Scale::flow},
    {Dimension::stiffness, "stiffness", "N*m/rad", "N/m", Scale::effort, Scale::displacement},
    {Dimension::ratio, "ratio", "1", "1"},
    {Dimension::time, "time", "s", "s"},
    {Dimension::command, "command", "N*m", "N"},
    {Dimension::effort_per_command, "effort_per_command", "N*m", "N"},
    {Dimension::output, "output", "unit of its signal", "unit of its signal", Scale::displacement},
    {Dimension::force, "force", "N", "N"},
    {Dimension::length, "length", "m", "m"},
    {Dimension::speed, "speed", "m/s", "m/s"},
    {Dimension::line_stiffness, "line_stiffness", "N/m", "N/m"},
    {Dimension::line_damping, "line_damping", "N*s/m", "N*s/m"},
    {Dimension::mass, "mass", "kg", "kg"},
    {Dimension::angle, "angle", "rad", "rad"},
    {Dimension::angular_speed, "angular_speed", "rad/s", "rad/s"},
    {Dimension::torque, "torque", "N*m", "N*m"},
    {Dimension::voltage, "voltage", "V", "V"},
    {Dimension::current, "current", "A", "A"},
    {Dimension::resistance, "resistance", "ohm", "ohm"},
    {Dimension::inductance, "inductance", "H", "H"},
    {Dimension::torque_per_current, "torque_per_current", "N*m/A", "N*m/A"},
    {Dimension::acceleration, "acceleration", "m/s^2", "m/s^2"},
    {Dimension::line_compliance, "line_compliance", "m/N", "m/N"},
    {Dimension::per_flow_squared, "per_flow_squared", "s^2/rad^2", "s^2/m^2"},
    {Dimension::inverse_flow, "inverse_flow", "s/rad", "s/m"},
    {Dimension::effort_per_load, "effort_per_load", "1", "1"},
    {Dimension::voltage_per_displacement, "voltage_per_displacement", "V/rad", "V/m"}};

constexpr bool dimensions_are_in_order() {
  for (std::size_t i = 0; i < std::size(dimensions); ++i)
    if (dimensions[i].dimension != static_cast<Dimension>(i)) return false;
  return std::size(dimensions) == static_cast<std::size_t>(Dimension::count);
}
static_assert(dimensions_are_in_order(), "one row per dimension, in the order of the enumeration");

constexpr const DimensionInfo& facts(Dimension dimension) {
  return dimensions[static_cast<std::size_t>(dimension)];
}
}  // namespace tendonlab
