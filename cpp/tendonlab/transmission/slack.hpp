#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Slack: above the torque that the pretension holds the returning tendon is loose, and friction grows with the torque.
///
///   g -> g (1 + a max(0, |tau|/P - 1)),   P = 2 r T_s                      (S3 eq. 15, 17 where T_3 = 0)
///
/// tau: torque carried, N·m. P: torque that the pretension holds, N·m. a: 1 where the loose tendon carries nothing
/// and the other one all of the torque. a = 0 switches it off. No memory.
template <class T>
struct Slack {
  static constexpr std::string_view name = "slack", noun = "tendon slack", source = "S3 eq. 15, 17 where T_3 = 0",
                                    equation = "g (1 + a max(0, |tau|/(2 r T_s) - 1)) sgn(v)",
                                    summary =
                                        "slack: friction grows with the torque once the returning tendon is loose";
  static constexpr unsigned roles = role::factor, sees = sees_load | sees_preload;
  T slack;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Slack::slack, "slack", Dimension::ratio, Purpose::amplitude, 1.0, 0.0, 10.0,
                                "growth of friction per torque beyond the pretension's, 1: the loose tendon carries "
                                "nothing")};
  }
  template <class S>
  S factor(const Sliding<S>& at) const {
    constexpr double smallest = 1e-12;  // without pretension any torque leaves one tendon loose
    const S beyond = abs(at.load) / (at.preload + smallest) - 1.0;
    return 1.0 + slack * select(plain(beyond) > 0.0, beyond, constant<S>(0.0));
  }
};
}  // namespace tendonlab::transmission
