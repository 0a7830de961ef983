#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Dry part of the static LuGre curve: friction that goes from its static to its kinetic level with speed.
///
///   g = F_c + (F_s - F_c) exp(-|v/v_s|^alpha)                             (S0 eq. 3)
///
/// v: sliding velocity, m/s (rad/s). g: dry level, N (N·m). F_s: at rest, F_c: at speed, N (N·m). F_s < F_c is allowed:
/// the curve then rises with speed and its level at rest may vanish, so no bristle may be put on it (S0, Tables 6 and
/// 7). Stands for the whole dry friction of its slot; F_c = F_s = 0 switches it off. No memory.
template <class T>
struct StaticLugre {
  static constexpr std::string_view name = "static_lugre", noun = "static LuGre friction", source = "S0 eq. 3",
                                    equation = "(F_c + (F_s - F_c) exp(-|v/v_s|^alpha)) sgn(v)",
                                    summary = "static LuGre curve: dry friction from static to kinetic with speed";
  static constexpr unsigned roles = role::level | role::whole, sees = sees_velocity;
  T coulomb, at_rest;
  Divisor<T> falloff;
  T exponent;

  static constexpr auto parameters() {
    return std::tuple{parameter(&StaticLugre::coulomb, "coulomb", Dimension::effort, Purpose::amplitude, 1.0, 0.0, inf,
                                "kinetic friction: the dry level at speed"),
                      parameter(&StaticLugre::at_rest, "static_friction", Dimension::effort, Purpose::amplitude, 1.0,
                                0.0, inf, "static friction: the dry level at rest"),
                      parameter(&StaticLugre::falloff, "stribeck_velocity", Dimension::flow, Purpose::shape, 0.2, 1e-9,
                                inf, "speed at which 1/e of the way from static to kinetic is left"),
                      parameter(&StaticLugre::exponent, "stribeck_exponent", Dimension::ratio, Purpose::shape, 2.0, 0.5,
                                10.0, "sharpness of the way from static to kinetic; 2: Gaussian")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return coulomb + (at_rest - coulomb) * exp(-power(S(at.speed() / falloff), exponent));
  }
};
}  // namespace tendonlab::friction
