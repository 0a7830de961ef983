#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Compliance of two pretensioned cables: while the torque changes, part of the drive's motion only stretches them and
/// slides through no sheath.
///
///   v -> v - a L/(2 EA r²) dtau/dt                                         (S3 eq. 7, 17: lost motion of the pair)
///
/// v: velocity of the drive, rad/s, and of what slides. tau: torque that the pair carries, N·m. L: length of a cable,
/// m, EA: its axial stiffness, N, r: radius of the drive's pulley, m. a: 1 where the whole length stretches. a = 0
/// switches it off. No memory. The system knows the torque's rate.
template <class T>
struct CableStretch {
  static constexpr std::string_view name = "compliance", noun = "compliance", source = "S3 eq. 7, 17",
                                    equation = "v - a L/(2 EA r^2) dtau/dt",
                                    summary = "compliance: part of the drive's motion only stretches the cables";
  static constexpr unsigned roles = role::motion, sees = sees_velocity;
  T share;

  static constexpr auto parameters() {
    return std::tuple{parameter(&CableStretch::share, "stretch_share", Dimension::ratio, Purpose::amplitude, 1.0, 0.0,
                                10.0, "stretch over that of the whole length, by length and axial stiffness")};
  }
  /// `at.velocity`: rate at which the whole length would stretch.
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    at.position = share * at.position;
    at.velocity = share * at.velocity;
    return at;
  }
  T half_gap() const { return T(0.0); }
};
}  // namespace tendonlab::transmission
