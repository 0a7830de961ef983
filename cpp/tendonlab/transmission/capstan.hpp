#pragma once
#include "tendonlab/core/law.hpp"
#include "tendonlab/core/terms.hpp"

namespace tendonlab::transmission {
/// Capstan: the tension that a cable loses as it slides over a pulley, as a level of dry friction.
///
///   g = |T (1 - exp(-mu theta_w s))| + eps,   T_out = T - g s                (S4 eq. 28, with the magnitude)
///
/// T: tension on the side that `load` names, N. s: direction of sliding, + towards that side: so the loss differs by
/// direction. theta_w: wrap angle, rad. mu: friction coefficient. eps, N, keeps a bristle's level above zero on a slack
/// cable. mu = eps = 0 switches it off. No memory.
template <class T>
struct Capstan {
  static constexpr std::string_view name = "capstan", noun = "capstan friction", source = "S4 eq. 28",
                                    equation = "|T (1 - exp(-mu theta_w sgn(v)))| + eps",
                                    summary = "capstan: tension lost along the wrap of a cable on a pulley";
  static constexpr unsigned roles = role::level, sees = sees_load | sees_wrap;
  T friction_coefficient, smallest;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Capstan::friction_coefficient, "friction_coefficient", Dimension::ratio,
                                Purpose::amplitude, 0.15, 0.0, 10.0, "kinetic friction coefficient of the contact"),
                      parameter(&Capstan::smallest, "smallest_level", Dimension::force, Purpose::share, 1e-3, 0.0, inf,
                                "level that is left without tension")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return abs(at.load) * wrap_loss(S(friction_coefficient * at.wrap), at.direction) + smallest;
  }
};
}  // namespace tendonlab::transmission
