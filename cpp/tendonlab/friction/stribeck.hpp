#pragma once
#include "tendonlab/core/law.hpp"
#include "tendonlab/core/terms.hpp"

namespace tendonlab::friction {
/// Stribeck friction: the extra resistance at low speed, which fades as sliding sets in.
///
///   g = F_e exp(-(v/v_s)^2)                                               (S4 eq. 27)
///
/// v: sliding velocity, m/s (rad/s). g: its share of the dry level, N (N·m).
/// Adds to `coulomb` in its slot; F_e = 0 switches it off. No memory.
template <class T>
struct Stribeck {
  static constexpr std::string_view name = "stribeck", noun = "Stribeck friction", source = "S4 eq. 27",
                                    equation = "F_e exp(-(v/v_s)^2) sgn(v)",
                                    summary = "Stribeck friction: extra resistance at low speed";
  static constexpr unsigned roles = role::level | role::refines, sees = sees_velocity;
  T excess;
  Divisor<T> falloff;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Stribeck::excess, "static_excess", Dimension::effort, Purpose::amplitude, 0.05, 0.0,
                                inf, "static minus kinetic friction"),
                      parameter(&Stribeck::falloff, "stribeck_velocity", Dimension::flow, Purpose::shape, 0.1, 1e-9,
                                inf, "speed at which 1/e of the excess is left")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return excess * stribeck_decay(at.velocity, falloff);
  }
};
}  // namespace tendonlab::friction
