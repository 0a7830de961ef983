#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Curvature of a sheath over its mean: 1 + k (2 u - 1) at the share u = s/L of its length from the input.
template <class S>
struct LinearCurvature {
  S skew{};  ///< k: how much more the sheath is bent at its output end than on average, 1
  S density(double share) const { return 1.0 + (2.0 * share - 1.0) * skew; }
  /// Share of the wrap angle on the first `share` of the length.
  S turned(double share) const { return share + (share * share - share) * skew; }
};
/// What the laws of a sheath see: sliding, and how unevenly the sheath is bent.
template <class S>
struct SheathSliding : Sliding<S> {
  LinearCurvature<S> curvature{};

  template <class F>
  static TENDONLAB_INLINE constexpr void for_each_field(F&& f) {
    Sliding<S>::for_each_field(f);
    f(
        "curvature_skew", sees_nothing, [](auto& port) -> auto& { return port.curvature.skew; });
  }
};

/// Uneven curvature of a sheath: more of its wrap angle lies near the output, or near the input.
///
///   kappa(s) = theta/L (1 + k (2 s/L - 1))                                 (S3 eq. 11, 14 for linear curvature)
///
/// theta: wrap angle, rad; L: length, m. k > 0: bent more towards the output; the transmission's gain then rises above
/// the ratio of radii. k adds to the skew of the sheath's known shape; k = 0 switches it off. No memory.
template <class T>
struct CurvatureSkew {
  static constexpr std::string_view name = "curvature_skew", noun = "uneven curvature", source = "S3 eq. 11, 14",
                                    equation = "kappa(s) = theta/L (1 + k (2 s/L - 1))",
                                    summary = "uneven curvature of a sheath: changes the gain of the pair";
  static constexpr unsigned roles = role::motion | role::refines, sees = sees_wrap;
  template <class S>
  using Port = SheathSliding<S>;
  T curvature_skew;

  static constexpr auto parameters() {
    return std::tuple{parameter(&CurvatureSkew::curvature_skew, "curvature_skew", Dimension::ratio, Purpose::amplitude,
                                0.5, -1.0, 1.0, "curvature at the output end over its mean, less one")};
  }
  template <class S>
  SheathSliding<S> motion(SheathSliding<S> at) const {
    at.curvature.skew = at.curvature.skew + lift<S>(curvature_skew);
    return at;
  }
};
}  // namespace tendonlab::transmission
