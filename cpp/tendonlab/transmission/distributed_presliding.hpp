#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Presliding spread along an elastic cable: at a reversal the cable gives way from its input on, and the output is
/// held until the friction of the whole sheath has turned over. A play in torque, where the gate of S3 is one in
/// velocity.
///
///   y[k] = min(max(y[k-1], m - g), m + g),   tau -> (1 - a) tau + a (y - F)          (play operator, S4)
///
/// m: output torque without friction, g: dry friction level, F: friction that has no memory, N·m (N). a: share of it;
/// 1: no gate. a = 0 switches it off. Memory: y, kept by the system.
template <class T>
struct DistributedPresliding {
  static constexpr std::string_view name = "distributed_presliding", source = "S4 play operator, in torque",
                                    equation = "(1 - a) tau + a (y - F), y = min(max(y, m - g), m + g)",
                                    summary =
                                        "presliding spread along the cable: the output is held until the friction of "
                                        "the whole sheath has turned over";
  static constexpr unsigned roles = role::refines, sees = sees_nothing;
  T share;

  static constexpr auto parameters() {
    return std::tuple{parameter(&DistributedPresliding::share, "distributed_share", Dimension::ratio,
                                Purpose::amplitude, 1.0, 0.0, 1.0, "share of the output that is held by torque")};
  }
  /// y after a sample in which friction of `level` acts about `middle`.
  template <class S>
  S held(const S& previous, const S& middle, const S& level) const {
    const S least = middle - level, most = middle + level;
    const S above = select(plain(previous) < plain(least), least, previous);
    return select(plain(above) > plain(most), most, above);
  }
};
}  // namespace tendonlab::transmission
