#pragma once
#include "tendonlab/transmission/capstan.hpp"

namespace tendonlab::transmission {
/// Stribeck friction of a contact that states friction coefficients: at low speed the static one takes over.
///
///   g -> g (1 + p (mu_s / mu - 1) exp(-(v/v_s)^2))                        (S4 eqs 27, 29)
///
/// v: sliding velocity, m/s. mu: kinetic coefficient, one parameter with the law that makes the level. mu_s: static
/// coefficient. p: share of it, 1: all; p = 0 switches it off. No memory.
template <class T>
struct ContactStribeck {
  static constexpr std::string_view name = "stribeck", noun = "Stribeck friction", source = "S4 eqs 27, 29",
                                    equation = "g (1 + p (mu_s/mu - 1) exp(-(v/v_s)^2)) sgn(v)",
                                    summary = "Stribeck friction: a larger friction coefficient at low speed";
  static constexpr unsigned roles = role::factor | role::refines, sees = sees_velocity;
  using Partner = Capstan<T>;  ///< its parameters of equal names are those of this law
  T static_coefficient, share;
  Divisor<T> falloff, kinetic_coefficient;

  static constexpr auto parameters() {
    return std::tuple{parameter(&ContactStribeck::kinetic_coefficient, "friction_coefficient", Dimension::ratio,
                                Purpose::shape, 0.15, 1e-9, 10.0, "kinetic friction coefficient of the contact"),
                      parameter(&ContactStribeck::static_coefficient, "static_friction_coefficient", Dimension::ratio,
                                Purpose::shape, 0.18, 0.0, 10.0, "static friction coefficient of the contact"),
                      parameter(&ContactStribeck::falloff, "stribeck_velocity", Dimension::flow, Purpose::shape, 0.1,
                                1e-9, inf, "speed at which 1/e of the excess is left"),
                      parameter(&ContactStribeck::share, "stribeck_share", Dimension::ratio, Purpose::share, 1.0, 0.0,
                                1.0, "share of the excess that acts")};
  }
  template <class S>
  S factor(const Sliding<S>& at) const {
    const T ratio = select(plain(kinetic_coefficient.value) > 0.0, T(static_coefficient / kinetic_coefficient), T(1.0));
    return 1.0 + (share * (ratio - 1.0)) * stribeck_decay(at.velocity, falloff);
  }
};
}  // namespace tendonlab::transmission
