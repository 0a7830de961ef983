#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::sensing {
/// Sensor bias: a constant added to the reading.
///
///   y -> y + y_0                                                          (S0, calibration of the load cells)
///
/// y: reading, unit of its signal. y_0 = 0 switches it off.
template <class T>
struct Bias {
  static constexpr std::string_view name = "bias", noun = "bias", source = "S0, calibration of the load cells",
                                    equation = "y + y_0", summary = "sensor bias: a constant added to the reading";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T added;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Bias::added, "bias", Dimension::output, Purpose::amplitude, 0.05, -inf, inf,
                                "constant added to the reading")};
  }
  template <class S>
  S apply(const Passing<S>& at) const {
    return at.signal + added;
  }
};
}  // namespace tendonlab::sensing
