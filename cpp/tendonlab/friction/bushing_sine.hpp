#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Friction of a cable in a bushing under the same tension on both sides: the reaction lies on the bisector.
///
///   g = 2 mu |T sin(theta_w/2)|                                           (S2 eq. 10)
///
/// T: tension that `load` names, N. theta_w: wrap angle, rad. For small angles this is mu T theta_w, as of the capstan.
/// mu = 0 switches it off. No memory.
template <class T>
struct BushingSine {
  static constexpr std::string_view name = "bushing_sine", noun = "equal-tension wrap friction", source = "S2 eq. 10",
                                    equation = "2 mu |T sin(theta_w/2)| sgn(v)",
                                    summary = "bushing: friction by the reaction on the bisector of the wrap";
  static constexpr unsigned roles = role::level, sees = sees_load | sees_wrap;
  T friction_coefficient;

  static constexpr auto parameters() {
    return std::tuple{parameter(&BushingSine::friction_coefficient, "sine_coefficient", Dimension::ratio,
                                Purpose::amplitude, 0.1, 0.0, 10.0, "friction coefficient of cable and bushing")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return (2.0 * friction_coefficient) * abs(at.load * sin(0.5 * at.wrap));
  }
};
}  // namespace tendonlab::friction
