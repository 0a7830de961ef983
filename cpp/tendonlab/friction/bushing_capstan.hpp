#pragma once
#include "tendonlab/core/law.hpp"
#include "tendonlab/core/terms.hpp"

namespace tendonlab::friction {
/// Friction of a cable in a bushing by the capstan law: tension grows along the wrap.
///
///   g = |T| (exp(mu |theta_w|) - 1)                                       (Euler and Eytelwein; compare S2 eq. 10)
///
/// T: tension that `load` names, N, on the slack side. theta_w: wrap angle, rad. mu = 0 switches it off. No memory.
template <class T>
struct BushingCapstan {
  static constexpr std::string_view name = "bushing_capstan", noun = "capstan friction",
                                    source = "Euler and Eytelwein, compare S2 eq. 10",
                                    equation = "|T| (exp(mu |theta_w|) - 1) sgn(v)",
                                    summary = "bushing: friction that grows along the wrap";
  static constexpr unsigned roles = role::level, sees = sees_load | sees_wrap;
  T friction_coefficient;

  static constexpr auto parameters() {
    return std::tuple{parameter(&BushingCapstan::friction_coefficient, "capstan_coefficient", Dimension::ratio,
                                Purpose::amplitude, 0.1, 0.0, 10.0, "friction coefficient of cable and bushing")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return abs(at.load) * wrap_loss(S(friction_coefficient * abs(at.wrap)), -1.0);
  }
};
}  // namespace tendonlab::friction
