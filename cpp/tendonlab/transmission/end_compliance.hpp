#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Compliance of the end section of a cable beyond its pulley, which a simulator may take for rigid.
///
///   F = x / c                                                             (S4 section VI, outlook)
///
/// x: stretch of the section, m. F: its tension beyond the pretension, N. c: its compliance, m/N. c = 0 switches it
/// off: a rigid section does not stretch and has no force of its own, its tension follows from that beyond the contact.
/// The system then has no slip of its own at its contacts. No memory.
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
    return select(plain(compliance.value) > 0.0, S(at.position / compliance), constant<S>(0.0));
  }
};
}  // namespace tendonlab::transmission
