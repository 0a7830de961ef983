#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Compliance of the sections of a cable beyond its pulleys, which a simulator may have taken for rigid.
///
///   T = T_p + x / c                                                       (S4 section VI, outlook)
///
/// x: stretch of an end section, m. c: its compliance, m/N. c = 0 is a rigid section: the system is then another one,
/// without the slips that follow from c, so this law only carries the number. No memory.
template <class T>
struct EndCompliance {
  static constexpr std::string_view name = "compliance", noun = "compliance", source = "S4 section VI, outlook",
                                    equation = "x / c", summary = "compliance of the end sections of the cables";
  static constexpr unsigned roles = role::force, sees = sees_position;
  Divisor<T> compliance;

  static constexpr auto parameters() {
    return std::tuple{parameter(&EndCompliance::compliance, "compliance", Dimension::line_compliance,
                                Purpose::amplitude, 2e-6, 0.0, inf, "stretch per tension of an end section")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    return at.position / compliance;
  }
};
}  // namespace tendonlab::transmission
