#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Load-dependent friction: dry friction in proportion to the effort that the element carries.
///
///   g = c |F_load|                                                        (S1 eq. 11; S0 eq. 11 with exponent 1)
///
/// F_load: torque or tension carried, N (N·m), from the system. g: its share of the dry level, N (N·m). Where the
/// system states the load as a ratio (`friction_map`), c is an effort per unit of it. A level of its own, so that it
/// also acts where no Coulomb friction does; c = 0 switches it off. No memory.
template <class T>
struct LoadDependence {
  static constexpr std::string_view name = "load_dependence", noun = "load-dependent friction", source = "S1 eq. 11",
                                    equation = "c |F_load| sgn(v)",
                                    summary =
                                        "load-dependent friction: dry friction in proportion to the effort carried";
  static constexpr unsigned roles = role::level, sees = sees_load;
  T load_dependence;

  static constexpr auto parameters() {
    return std::tuple{parameter(&LoadDependence::load_dependence, "load_dependence", Dimension::effort_per_load,
                                Purpose::amplitude, 0.05, 0.0, 1.0, "dry friction per load carried")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return load_dependence * abs(at.load);
  }
};
}  // namespace tendonlab::friction
