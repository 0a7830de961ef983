#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Hold by stiction: friction of a guide keeps the sense of the last move while the drive rests, whatever the small
/// motion behind the elastic cable.
///
///   F = h (F_held - F_moving)                                    (S2 fig. 12a, b: the time shift of the force jump)
///
/// F_held: friction in the sense of the drive's last motion, N (N·m). F_moving: friction in the sense of the motion at
/// the guide, N (N·m). The port gives their difference as its load. h: share of it, 1: all. h = 0 switches it off. No
/// memory of its own: the senses are modes.
template <class T>
struct Hold {
  static constexpr std::string_view name = "hold", noun = "hold by stiction", source = "S2 fig. 12a, b",
                                    equation = "h (F_held - F_moving)",
                                    summary = "hold by stiction: at rest friction keeps the sense of the last move";
  static constexpr unsigned roles = role::force, sees = sees_load | sees_direction;
  T share;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Hold::share, "hold", Dimension::ratio, Purpose::amplitude, 1.0, 0.0, 1.0,
                                "share of the friction that keeps its sense at rest")};
  }
  template <class S>
  S force(const Sliding<S>& at) const {
    return share * at.load;
  }
};
}  // namespace tendonlab::transmission
