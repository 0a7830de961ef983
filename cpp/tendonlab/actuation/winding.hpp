#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::actuation {
/// Winding of a motor: its current is a state, its torque turns the shaft.
///
///   i' = (V - R i - k omega) / L,   F = -k i                              (S2 eq. 1)
///
/// V: voltage at the terminals, which the port gives as its load. omega: speed of the shaft, rad/s. i: current, A, the
/// state. F: effort against the motion, N·m, so that the torque of the motor is k i. k = 0 switches it off.
template <class T>
struct Winding {
  static constexpr std::string_view name = "winding", noun = "current dynamics", source = "S2 eq. 1",
                                    equation = "-k i, i' = (V - R i - k omega) / L",
                                    summary = "winding of a motor: resistance, inductance and back-EMF";
  static constexpr unsigned roles = role::memory, sees = sees_velocity | sees_load;
  T torque_constant, resistance;
  Divisor<T> inductance;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Winding::torque_constant, "torque_constant", Dimension::torque_per_current,
                                Purpose::amplitude, 1.0, 0.0, inf, "torque per current, and voltage per speed"),
                      parameter(&Winding::resistance, "resistance", Dimension::resistance, Purpose::shape, 1.0, 0.0,
                                inf, "resistance of the winding"),
                      parameter(&Winding::inductance, "inductance", Dimension::inductance, Purpose::shape, 1.0, 1e-12,
                                inf, "inductance of the winding")};
  }
  template <class S>
  S state_rate(const Sliding<S>& at, const S&, const S& current) const {
    return (at.load - resistance * current - torque_constant * at.velocity) / inductance;
  }
  template <class S>
  S state_force(const Sliding<S>&, const S& current, const S&) const {
    return -(torque_constant * current);
  }
  /// Scale of the current in the error of a step, A.
  Plain<T> state_scale(const Plain<T>&) const { return Plain<T>(1.0); }
};
}  // namespace tendonlab::actuation
