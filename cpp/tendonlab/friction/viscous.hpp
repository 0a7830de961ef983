#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Viscous friction: in proportion to speed.
///
///   F = F_v v                                                             (S4 eq. 27)
///
/// v: sliding velocity, m/s (rad/s). F: N (N·m), against v. F_v = 0 switches it off. No memory.
template <class T>
struct Viscous {
  static constexpr std::string_view name = "viscous", noun = "viscous friction", source = "S4 eq. 27",
                                    equation = "F_v v", summary = "viscous friction: in proportion to speed";
  static constexpr unsigned roles = role::force, sees = sees_velocity;
  T viscous;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Viscous::viscous, "viscous", Dimension::damping, Purpose::amplitude, 0.1, 0.0, inf,
                                "friction per speed")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    return viscous * at.velocity;
  }
};
}  // namespace tendonlab::friction
