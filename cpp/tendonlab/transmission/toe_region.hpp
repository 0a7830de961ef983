#pragma once
#include "tendonlab/transmission/taut_compliance.hpp"

namespace tendonlab::transmission {
/// Toe region of a cable of fibres: they straighten before they stretch, so below a tension it is softer.
///
///   F = L                    L >= F_s:   k, as above the tension F_s        (S2 sec. IV-B.2: only data above 200 N)
///   F = (L + F_s)^2 / 4 F_s  |L| < F_s:  k sqrt(F/F_s), quadratic           (reconstructed)
///   F = L + F_s              L <= -F_s:  slack
///   L = k x + L_0,   L_0 so that F = T at x = 0
///
/// x: elongation beyond the preloaded state, m (rad); it leaves as that of a linear cable of equal tension. T: preload,
/// N (N·m), one parameter with the compliance, as k. F_s: tension where the toe ends; F_s = 0 switches it off. No
/// memory.
template <class T>
struct ToeRegion {
  static constexpr std::string_view name = "toe_region", noun = "soft toe region", source = "S2 sec. IV-B.2",
                                    equation = "T + k x -> (T + k x + F_s)^2 / 4 F_s below F_s",
                                    summary = "toe region: a cable of fibres is softer below a tension";
  static constexpr unsigned roles = role::motion, sees = sees_position;
  using Partner = TautCompliance<T>;  ///< its parameters of equal names are those of this law
  T pretension, stiffness, toe_tension;

  static constexpr auto parameters() {
    return std::tuple{parameter(&ToeRegion::pretension, "pretension", Dimension::effort, Purpose::shape, 1.0, 0.0, inf,
                                "effort in the preloaded state"),
                      parameter(&ToeRegion::stiffness, "stiffness", Dimension::stiffness, Purpose::shape, 10.0, 0.0,
                                inf, "effort per elongation above the toe"),
                      parameter(&ToeRegion::toe_tension, "toe_tension", Dimension::effort, Purpose::amplitude, 4.0, 0.0,
                                inf, "effort below which the cable is softer")};
  }
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    const S longer = at.position + more(at.position) / stiffness;
    at.position = select(plain(stiffness) > 0.0, longer, at.position);
    return at;
  }

 private:
  /// F - (T + k x)
  template <class S>
  S more(const S& elongation) const {
    constexpr double smallest = 1e-24;  // without preload the root has no slope
    const auto end = plain(toe_tension);
    const T root = sqrt(pretension * toe_tension + smallest), early = 2.0 * root - toe_tension - pretension;
    const T start = select(plain(pretension) < end, early, T(0.0));
    const S line = start + (pretension + stiffness * elongation), left = line - toe_tension;
    const S bent = square(left) / (4.0 * toe_tension), slack = lift<S>(toe_tension);
    return start + select(plain(line) >= end, constant<S>(0.0), select(plain(line) > -end, bent, slack));
  }
};
}  // namespace tendonlab::transmission
