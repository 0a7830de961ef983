#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::sensing {
/// Sensor delay: the reading is old.
///
///   y(t) -> y(t - d)                                                      (time shift, S2 fig. 12)
///
/// d: delay, s. The recorder, which holds the past of the signal, applies it. d = 0 switches it off.
template <class T>
struct Delay {
  static constexpr std::string_view name = "delay", noun = "delay", source = "S2 fig. 12", equation = "y(t - d)",
                                    summary = "sensor delay: the reading is old";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T late;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&Delay::late, "delay", Dimension::time, Purpose::amplitude, 0.005, 0.0, inf, "age of the reading")};
  }
  T lateness() const { return late; }
};
}  // namespace tendonlab::sensing
