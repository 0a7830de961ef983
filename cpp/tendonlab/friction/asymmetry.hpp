#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Friction that differs by direction.
///
///   g -> g (1 + a s),   F = b |v|,   s = direction of sliding             (EMPS benchmark, second published model)
///
/// v: sliding velocity, m/s (rad/s). a: share of the dry level, 1. b: half the difference of the viscous coefficients,
/// N·s/m (N·m·s/rad). While it slides, a alone looks like a constant offset. a = b = 0 switches it off. No memory.
template <class T>
struct Asymmetry {
  static constexpr std::string_view name = "asymmetry", noun = "direction-dependent friction",
                                    source = "EMPS benchmark, second model",
                                    equation = "g (1 + a sgn(v)) sgn(v) + b |v|",
                                    summary =
                                        "direction-dependent friction: level and viscous friction differ by direction";
  static constexpr unsigned roles = role::factor | role::force, sees = sees_velocity;
  static constexpr double most = 0.999;  ///< without any friction one way, rounding alone decides what rests
  T level_asymmetry, viscous_asymmetry;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&Asymmetry::level_asymmetry, "level_asymmetry", Dimension::ratio, Purpose::amplitude, 0.1, -most,
                  most, "share by which the dry level is larger forwards"),
        parameter(&Asymmetry::viscous_asymmetry, "viscous_asymmetry", Dimension::damping, Purpose::amplitude, 0.03,
                  -inf, inf, "half the difference of viscous friction, forwards minus backwards")};
  }
  template <class S>
  S factor(const Sliding<S>& at) const {
    return lift<S>(1.0 + at.direction * level_asymmetry);
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    return viscous_asymmetry * at.speed();
  }
};
}  // namespace tendonlab::friction
