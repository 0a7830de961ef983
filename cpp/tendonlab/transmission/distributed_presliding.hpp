#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Presliding spread along an elastic cable: at a reversal the cable gives way from its input on, and the output is
/// held until the friction of the whole sheath has turned over. Hysteresis in torque, where the gate of S3 is in
/// velocity.
///
///   dF/dm = 1 - max(0, F s/g)^n,  |F| <= g,   tau -> (1 - a) tau + a (m - F - F_v)      (Dahl's form; play for n ->
///   inf)
///
/// m: output torque without friction, N·m (N); s: the sign of its change. F: dry friction, g: its level, F_v: friction
/// without memory. n: 1 rounds the corners of the loop, large n makes a play (S4). a: share of it; 1: no gate. a = 0
/// switches it off. Memory: F, kept by the system.
template <class T>
struct DistributedPresliding {
  static constexpr std::string_view name = "distributed_presliding", source = "Dahl 1968 in torque; S3 sec. 6",
                                    equation = "(1 - a) tau + a (m - F - F_v), dF/dm = 1 - max(0, F s/g)^n",
                                    summary =
                                        "presliding spread along the cable: the output is held until the friction of "
                                        "the whole sheath has turned over";
  static constexpr unsigned roles = role::refines, sees = sees_nothing;
  T share, sharpness;

  static constexpr auto parameters() {
    return std::tuple{parameter(&DistributedPresliding::share, "distributed_share", Dimension::ratio,
                                Purpose::amplitude, 1.0, 0.0, 1.0, "share of the output that is held by torque"),
                      parameter(&DistributedPresliding::sharpness, "sharpness", Dimension::ratio, Purpose::shape, 10.0,
                                1.0, 1e3, "exponent of the approach to the level: large is a sharp corner")};
  }
  /// F after the torque without friction changed by `change`, where friction has this `level`.
  template <class S>
  S turned(S friction, const S& change, const S& level) const {
    constexpr int parts = 4;  // a sample may take it through the corner
    constexpr double smallest = 1e-12;
    const double sense = plain(change) < 0.0 ? -1.0 : 1.0;
    for (int i = 0; i < parts; ++i) {
      const S reached = sense * friction / (level + smallest);
      const S left = 1.0 - power(select(plain(reached) > 0.0, reached, constant<S>(0.0)), sharpness);
      friction = within(S(friction + (1.0 / parts) * change * left), level);
    }
    return friction;
  }

 private:
  template <class S>
  static S within(const S& friction, const S& level) {
    const S least = -level, above = select(plain(friction) < plain(least), least, friction);
    return select(plain(above) > plain(level), level, above);
  }
};
}  // namespace tendonlab::transmission
