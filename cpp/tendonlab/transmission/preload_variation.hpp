#pragma once
#include "tendonlab/transmission/taut_compliance.hpp"

namespace tendonlab::transmission {
/// Preload that varies with the angle of the joint: the path of the cable is longer where the joint bends it.
///
///   x -> x + (P/k) (1 - cos(theta)), so that T becomes T + P (1 - cos(theta))
///                                               (S2 eq. 11: half the sum of both directions; the even form
///                                               reconstructed)
///
/// x: elongation, m (rad). theta: angle by which the joint bends the cable, rad. k: stiffness, N/m (N·m/rad), one
/// parameter with that of the compliance. P: tension added at a right angle, N (N·m); P < 0: taken away. P = 0 switches
/// it off. No memory. `slope` is the lever of the tension on the joint, which the system counts, so that the path takes
/// from the joint what it gives to the cable.
template <class T>
struct PreloadVariation {
  static constexpr std::string_view name = "preload_variation", noun = "preload that varies with the angle",
                                    source = "S2 eq. 11", equation = "T -> T + P (1 - cos(theta))",
                                    summary = "preload variation: the path of a cable grows as its joint bends it";
  static constexpr unsigned roles = role::motion, sees = sees_position | sees_wrap;
  using Partner = TautCompliance<T>;  ///< its parameters of equal names are those of this law
  T stiffness, variation;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&PreloadVariation::stiffness, "stiffness", Dimension::stiffness, Purpose::shape, 10.0, 0.0, inf,
                  "effort per elongation"),
        parameter(&PreloadVariation::variation, "preload_variation", Dimension::effort, Purpose::amplitude, 0.2, -inf,
                  inf, "effort added where the joint bends by 90 degrees")};
  }
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    at.position = at.position + reach() * (1.0 - cos(at.wrap));
    return at;
  }
  /// Path per angle, m/rad, where the joint bends the cable by `angle`.
  template <class S>
  S slope(const S& angle) const {
    return reach() * sin(angle);
  }

 private:
  T reach() const {
    const T longer = variation / stiffness;
    return select(plain(stiffness) > 0.0, longer, T(0.0));
  }
};
}  // namespace tendonlab::transmission
