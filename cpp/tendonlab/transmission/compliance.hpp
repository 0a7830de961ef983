#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Compliance of a cable: spring and damper in parallel.
///
///   F = k x + c v                                                         (S2 eq. 3)
///
/// x: stretch, m (rad), v its rate, m/s (rad/s). F: N (N·m). No memory.
template <class T>
struct Compliance {
  static constexpr std::string_view name = "compliance", noun = "compliance", source = "S2 eq. 3",
                                    equation = "k x + c v", summary = "compliance: spring and damper in parallel";
  static constexpr unsigned roles = role::force, sees = sees_position | sees_velocity;
  T stiffness, damping;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Compliance::stiffness, "stiffness", Dimension::stiffness, Purpose::amplitude, 10.0,
                                0.0, inf, "effort per stretch"),
                      parameter(&Compliance::damping, "damping", Dimension::damping, Purpose::amplitude, 0.1, 0.0, inf,
                                "effort per rate of stretch")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    return stiffness * at.position + damping * at.velocity;
  }
};
}  // namespace tendonlab::transmission
