#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// What the laws of a pretensioned pair of cables see: sliding of the drive, and how the torque stretches the pair.
template <class S>
struct PairSliding : Sliding<S> {
  S load_rate{};   ///< rate of the torque that the pair carries, N·m/s
  S compliance{};  ///< c = L/(2 EA r²): angle of the drive per torque that stretches the whole pair, rad/(N·m)

  template <class F>
  static TENDONLAB_INLINE constexpr void for_each_field(F&& f) {
    Sliding<S>::for_each_field(f);
    f(
        "load_rate", sees_nothing, [](auto& port) -> auto& { return port.load_rate; });
    f(
        "compliance", sees_nothing, [](auto& port) -> auto& { return port.compliance; });
  }
};

/// Compliance of two pretensioned cables: while the torque changes, part of the drive's motion only stretches them and
/// slides through no sheath.
///
///   v -> v - a c dtau/dt,   c = L/(2 EA r²)                                (S3 eq. 7, 17: lost motion of the pair)
///
/// v: velocity of the drive, rad/s; behind the law, that of sliding. tau: torque that the pair carries, N·m. c:
/// compliance of the pair, rad/(N·m), by length L, m, axial stiffness EA, N, and radius r of the drive's pulley, m. a:
/// 1 where the whole length stretches. a = 0 switches it off. No memory.
template <class T>
struct CableStretch {
  static constexpr std::string_view name = "compliance", noun = "compliance", source = "S3 eq. 7, 17",
                                    equation = "v - a c dtau/dt, c = L/(2 EA r^2)",
                                    summary = "compliance: part of the drive's motion only stretches the cables";
  static constexpr unsigned roles = role::motion, sees = sees_velocity;
  template <class S>
  using Port = PairSliding<S>;
  T share;

  static constexpr auto parameters() {
    return std::tuple{parameter(&CableStretch::share, "stretch_share", Dimension::ratio, Purpose::amplitude, 1.0, 0.0,
                                10.0, "stretch over that of the whole length, by length and axial stiffness")};
  }
  template <class S>
  PairSliding<S> motion(PairSliding<S> at) const {
    at.velocity = at.velocity - share * (at.compliance * at.load_rate);
    return at;
  }
};
/// c: two cables of `length`, m, and axial stiffness EA, N, on a drive pulley of `radius`, m, side by side.
template <class T>
T pair_compliance(const T& length, const T& axial_stiffness, const T& radius) {
  return length / (2.0 * axial_stiffness * square(radius));
}
}  // namespace tendonlab::transmission
