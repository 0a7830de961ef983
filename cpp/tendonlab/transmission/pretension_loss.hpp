#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Pretension loss: where the cable slides, a constant share of the stated pretension is missing.
///
///   P -> P (1 - c)                                                         (S3 eq. 12, T_s)
///
/// P: torque (tension) that the pretension holds, N·m (N). c < 0: more pretension than stated. c = 0 switches it off.
/// No memory. The later laws, friction and slack alike, see the pretension that is left.
template <class T>
struct PretensionLoss {
  static constexpr std::string_view name = "pretension_loss", noun = "loss of pretension", source = "S3 eq. 12, T_s",
                                    equation = "T_s (1 - c)",
                                    summary = "pretension loss: a share of the pretension is missing";
  static constexpr unsigned roles = role::motion | role::refines, sees = sees_preload;
  T pretension_loss;

  static constexpr auto parameters() {
    return std::tuple{parameter(&PretensionLoss::pretension_loss, "pretension_loss", Dimension::ratio,
                                Purpose::amplitude, 0.1, -10.0, 1.0, "share of the pretension that is missing")};
  }
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    at.preload = (1.0 - pretension_loss) * at.preload;
    return at;
  }
};
}  // namespace tendonlab::transmission
