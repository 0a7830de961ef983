#pragma once
// How dimensions and purposes are called outside, and in what units: the one place that says so.
#include "tendonlab/core/parameter.hpp"

namespace tendonlab::bindings {
struct DimensionWords {
  const char *name, *rotary, *linear;
};
/// In the order of `Dimension`. Unless a dataset says otherwise the command is the effort itself.
inline constexpr DimensionWords dimension_words[] = {{"effort", "N*m", "N"},
                                                     {"flow", "rad/s", "m/s"},
                                                     {"displacement", "rad", "m"},
                                                     {"inertia", "kg*m^2", "kg"},
                                                     {"damping", "N*m*s/rad", "N*s/m"},
                                                     {"stiffness", "N*m/rad", "N/m"},
                                                     {"ratio", "1", "1"},
                                                     {"time", "s", "s"},
                                                     {"command", "N*m", "N"},
                                                     {"effort_per_command", "N*m", "N"},
                                                     {"output", "unit of its signal", "unit of its signal"},
                                                     {"force", "N", "N"},
                                                     {"length", "m", "m"},
                                                     {"speed", "m/s", "m/s"},
                                                     {"line_stiffness", "N/m", "N/m"},
                                                     {"line_damping", "N*s/m", "N*s/m"},
                                                     {"mass", "kg", "kg"},
                                                     {"angle", "rad", "rad"},
                                                     {"angular_speed", "rad/s", "rad/s"},
                                                     {"torque", "N*m", "N*m"},
                                                     {"voltage", "V", "V"},
                                                     {"current", "A", "A"},
                                                     {"resistance", "ohm", "ohm"},
                                                     {"inductance", "H", "H"},
                                                     {"torque_per_current", "N*m/A", "N*m/A"},
                                                     {"acceleration", "m/s^2", "m/s^2"},
                                                     {"line_compliance", "m/N", "m/N"},
                                                     {"per_flow_squared", "s^2/rad^2", "s^2/m^2"},
                                                     {"inverse_flow", "s/rad", "s/m"},
                                                     {"effort_per_load", "1", "1"}};
inline constexpr const char* purpose_words[] = {"structure", "amplitude", "share", "shape", "condition"};

inline const DimensionWords& words(Dimension dimension) {
  return dimension_words[static_cast<int>(dimension)];
}
inline const char* word(Purpose purpose) {
  return purpose_words[static_cast<int>(purpose)];
}
}  // namespace tendonlab::bindings
