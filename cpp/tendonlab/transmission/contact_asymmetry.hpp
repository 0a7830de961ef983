#pragma once
#include "tendonlab/transmission/capstan.hpp"

namespace tendonlab::transmission {
/// Friction coefficient of a contact that differs by direction, as strands make it: mu (1 + a) forwards, mu (1 - a)
/// backwards.
///
///   g -> g (1 - exp(-mu (1 + a s) theta_w s)) / (1 - exp(-mu theta_w s))                  (S4 section V, 0.178 and
///   0.155)
///
/// s: direction of sliding. theta_w: wrap angle, rad. mu: friction coefficient, one parameter with the law that makes
/// the level. a: half the relative difference, 1; a = 0 switches it off. No memory.
template <class T>
struct ContactAsymmetry {
  static constexpr std::string_view name = "asymmetry", noun = "direction-dependent friction",
                                    source = "S4 section V, identified coefficients", equation = "mu (1 + a sgn(v))",
                                    summary = "direction-dependent friction coefficient of a contact";
  static constexpr unsigned roles = role::factor | role::refines, sees = sees_wrap;
  using Partner = Capstan<T>;  ///< its parameters of equal names are those of this law
  T friction_coefficient, difference;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&ContactAsymmetry::friction_coefficient, "friction_coefficient", Dimension::ratio, Purpose::shape,
                  0.15, 1e-9, 10.0, "mean kinetic friction coefficient of the contact"),
        parameter(&ContactAsymmetry::difference, "coefficient_asymmetry", Dimension::ratio, Purpose::amplitude, 0.1,
                  -1.0, 1.0, "share by which the friction coefficient is larger forwards")};
  }
  template <class S>
  S factor(const Sliding<S>& at) const {
    constexpr double smallest = 1e-50;  // without wrap or direction nothing changes, and no derivative is inf - inf
    const S mean = friction_coefficient * at.wrap, own = (1.0 + at.direction * difference) * mean;
    return (wrap_loss(own, at.direction) + smallest) / (wrap_loss(mean, at.direction) + smallest);
  }
};
}  // namespace tendonlab::transmission
