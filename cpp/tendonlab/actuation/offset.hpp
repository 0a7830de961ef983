#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::actuation {
/// Offset of the actuator: an effort that is there at zero command.
///
///   u -> u + u_0                                                          (EMPS benchmark, first model)
///
/// u: effort, N (N·m). u_0 = 0 switches it off.
template <class T>
struct Offset {
  static constexpr std::string_view name = "offset", noun = "constant offset", source = "EMPS benchmark, first model",
                                    equation = "u + u_0",
                                    summary = "actuation offset: an effort that is there at zero command";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T offset;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Offset::offset, "offset", Dimension::effort, Purpose::amplitude, 0.05, -inf, inf,
                                "effort at zero command")};
  }
  template <class S>
  S apply(const Passing<S>& at) const {
    return at.signal + offset;
  }
};
}  // namespace tendonlab::actuation
