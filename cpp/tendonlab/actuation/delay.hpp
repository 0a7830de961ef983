#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::actuation {
/// Actuation delay: the command takes effect later.
///
///   u(t) -> u(t - d)                                                      (time shift, S2 fig. 12)
///
/// d: delay, s. The stepper, which holds the past of the signal, applies it. d = 0 switches it off.
template <class T>
struct Delay {
  static constexpr std::string_view name = "delay", noun = "delay", source = "S2 fig. 12", equation = "u(t - d)",
                                    summary = "actuation delay: the command takes effect later";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T late;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Delay::late, "delay", Dimension::time, Purpose::amplitude, 0.005, 0.0, inf,
                                "time from command to effort")};
  }
  T lateness() const { return late; }
};
}  // namespace tendonlab::actuation
