#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::actuation {
/// Gain error: the effort differs from command times torque constant.
///
///   u -> (1 + e) u                                                        (EMPS benchmark, drive gain)
///
/// u: effort by the torque constant, N (N·m). e: relative error, 1. e = 0 switches it off.
template <class T>
struct GainError {
  static constexpr std::string_view name = "gain_error", noun = "gain error", source = "EMPS benchmark, drive gain",
                                    equation = "(1 + e) u",
                                    summary =
                                        "actuation gain error: the effort differs from command times torque constant";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T error;

  static constexpr auto parameters() {
    return std::tuple{parameter(&GainError::error, "gain_error", Dimension::ratio, Purpose::amplitude, 0.1, -0.9, inf,
                                "relative error of the torque constant")};
  }
  template <class S>
  S apply(const Passing<S>& at) const {
    return at.signal + error * at.signal;
  }
};
}  // namespace tendonlab::actuation
