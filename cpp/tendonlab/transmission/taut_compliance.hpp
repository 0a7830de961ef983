#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Compliance of a pretensioned cable: spring and damper in parallel, which pull and never push.
///
///   F = max(0, T + k x + c v)                                             (S2 eq. 3, with preload and slack)
///
/// x: elongation beyond the preloaded state, m (rad), v its rate. T: preload, N (N·m). No memory.
template <class T>
struct TautCompliance {
  static constexpr std::string_view name = "taut_compliance", noun = "tension-only compliance", source = "S2 eq. 3",
                                    equation = "max(0, T + k x + c v)",
                                    summary = "compliance of a pretensioned cable, which goes slack and never pushes";
  static constexpr unsigned roles = role::force, sees = sees_position | sees_velocity;
  T pretension, stiffness, damping;

  static constexpr auto parameters() {
    return std::tuple{parameter(&TautCompliance::pretension, "pretension", Dimension::effort, Purpose::amplitude, 1.0,
                                0.0, inf, "effort in the preloaded state"),
                      parameter(&TautCompliance::stiffness, "stiffness", Dimension::stiffness, Purpose::amplitude, 10.0,
                                0.0, inf, "effort per elongation"),
                      parameter(&TautCompliance::damping, "damping", Dimension::damping, Purpose::amplitude, 0.1, 0.0,
                                inf, "effort per rate of elongation")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    const S pull = pretension + (stiffness * at.position + damping * at.velocity);
    return select(plain(pull) > 0.0, pull, constant<S>(0.0));
  }
};
}  // namespace tendonlab::transmission
