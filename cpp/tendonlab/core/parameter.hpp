#pragma once
// The facts about a parameter, stated once beside its law or system; Python, messages, priors and docs read them here.
#include <limits>
#include <string_view>
#include <tuple>

#include "tendonlab/core/dual.hpp"

namespace tendonlab {
inline constexpr double inf = std::numeric_limits<double>::infinity();

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
  effort_per_load
};
enum class Purpose {
  structure,  ///< of the system itself
  amplitude,  ///< the effect vanishes where it is 0; fitted
  share,      ///< the effect vanishes where it is 0; held at `typical` unless asked for
  shape,      ///< has no meaning while the amplitude is 0; fitted
  condition   ///< of the experiment, which states it; `typical` where none does; never fitted
};

/// `typical` is in units of the rig's own scale of that dimension (its rms effort, speed, travel), or absolute for a
/// ratio or a time: it starts fits and sets the width of priors.
template <class Owner, class Field>
struct Parameter {
  Field Owner::*field;
  std::string_view name;
  Dimension dimension;
  Purpose purpose;
  double typical, lower, upper;
  std::string_view meaning;
};
template <class Owner, class Field>
constexpr Parameter<Owner, Field> parameter(Field Owner::*field, std::string_view name, Dimension dimension,
                                            Purpose purpose, double typical, double lower, double upper,
                                            std::string_view meaning) {
  return {field, name, dimension, purpose, typical, lower, upper, meaning};
}
/// Visits the parameters of `Owner` in the order of its table.
template <class Owner, class F>
constexpr void for_each_parameter(F&& f) {
  std::apply([&](const auto&... p) { (f(p), ...); }, Owner::parameters());
}
}  // namespace tendonlab
