#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Arctangent friction, of a harmonic gear: smooth through zero, level at speed.
///
///   F = alpha arctan(beta v)                                              (S2 eq. 12)
///
/// v: sliding velocity, rad/s (m/s). F: N·m (N), against v, at most alpha pi/2; its slope at rest is alpha beta, so
/// nothing sticks. alpha = 0 switches it off. No memory.
template <class T>
struct Arctan {
  static constexpr std::string_view name = "arctan", noun = "arctangent friction", source = "S2 eq. 12",
                                    equation = "alpha arctan(beta v)",
                                    summary = "arctangent friction: smooth through zero, level at speed";
  static constexpr unsigned roles = role::force, sees = sees_velocity;
  T scale, slope;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Arctan::scale, "friction", Dimension::effort, Purpose::amplitude, 0.1, 0.0, inf,
                                "alpha: friction at high speed is pi/2 of it"),
                      parameter(&Arctan::slope, "friction_slope", Dimension::inverse_flow, Purpose::shape, 10.0, 0.0,
                                inf, "beta: inverse of the speed at which half of it is reached")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    return scale * atan(slope * at.velocity);
  }
};
}  // namespace tendonlab::friction
