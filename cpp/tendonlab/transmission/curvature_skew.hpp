#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Uneven curvature of a sheath: more of its wrap angle lies near the output, or near the input.
///
///   kappa(s) = theta/L (1 + k (2 s/L - 1))                                 (S3 eq. 11, 14 for linear curvature)
///
/// theta: wrap angle, rad; L: length, m. k > 0: bent more towards the output; the transmission's gain then rises above
/// the ratio of radii. k = 0 switches it off. No memory.
template <class T>
struct CurvatureSkew {
  static constexpr std::string_view name = "curvature_skew", noun = "uneven curvature", source = "S3 eq. 11, 14",
                                    equation = "kappa(s) = theta/L (1 + k (2 s/L - 1))",
                                    summary = "uneven curvature of a sheath: changes the gain of the pair";
  static constexpr unsigned roles = role::motion | role::refines, sees = sees_wrap;
  T curvature_skew;

  static constexpr auto parameters() {
    return std::tuple{parameter(&CurvatureSkew::curvature_skew, "curvature_skew", Dimension::ratio, Purpose::amplitude,
                                0.5, -1.0, 1.0, "curvature at the output end over its mean, less one")};
  }
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    at.skew = at.skew + lift<S>(curvature_skew);
    return at;
  }
  T half_gap() const { return T(0.0); }
};
}  // namespace tendonlab::transmission
