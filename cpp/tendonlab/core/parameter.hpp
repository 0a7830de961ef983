#pragma once
// The facts about a parameter, stated once beside its law or system; Python, messages, priors and docs read them here.
#include <limits>
#include <string_view>
#include <tuple>

#include "tendonlab/core/dimension.hpp"
#include "tendonlab/core/dual.hpp"

namespace tendonlab {
inline constexpr double inf = std::numeric_limits<double>::infinity();

enum class Purpose {
  structure,  ///< of the system itself
  amplitude,  ///< the effect vanishes where it is 0; fitted
  share,      ///< the effect vanishes where it is 0; held at `typical` unless asked for
  shape,      ///< has no meaning while the amplitude is 0; fitted
  condition   ///< of the experiment, which states it; `typical` where none does; never fitted
};
constexpr const char* word(Purpose purpose) {
  switch (purpose) {
    case Purpose::structure:
      return "structure";
    case Purpose::amplitude:
      return "amplitude";
    case Purpose::share:
      return "share";
    case Purpose::shape:
      return "shape";
    case Purpose::condition:
      return "condition";
  }
  return nullptr;
}
/// What a parameter is to every system that has one, whatever the system calls it.
enum class ParameterRole {
  none,
  command_gain,        ///< effort per unit of the command
  payload,             ///< largest effort of gravity on the joint, which a load that the joint carries adds to
  motor_inertia_share  ///< where friction that depends on the load sits; half of the inertia on each side unless stated
};
constexpr const char* word(ParameterRole role) {
  switch (role) {
    case ParameterRole::none:
      return "none";
    case ParameterRole::command_gain:
      return "command_gain";
    case ParameterRole::payload:
      return "payload";
    case ParameterRole::motor_inertia_share:
      return "motor_inertia_share";
  }
  return nullptr;
}

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
  ParameterRole role;
  std::string_view effect = {};  ///< of a system's own parameter: the effect that alone reads it; none: always read

  constexpr Parameter of_effect(std::string_view only) const {
    Parameter tied = *this;
    tied.effect = only;
    return tied;
  }
};
template <class Owner, class Field>
constexpr Parameter<Owner, Field> parameter(Field Owner::*field, std::string_view name, Dimension dimension,
                                            Purpose purpose, double typical, double lower, double upper,
                                            std::string_view meaning, ParameterRole role = ParameterRole::none) {
  return {field, name, dimension, purpose, typical, lower, upper, meaning, role};
}
/// Visits the parameters of `Owner` in the order of its table.
template <class Owner, class F>
constexpr void for_each_parameter(F&& f) {
  std::apply([&](const auto&... p) { (f(p), ...); }, Owner::parameters());
}
}  // namespace tendonlab
