#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Backlash: play in the motion; inside the gap nothing touches, on a flank the stretch counts from the flank.
///
///   x -> x - b side / 2,  v -> v   on a flank (side = +1, -1);   0 inside (side = 0)     (Nordin and Gutman 2002)
///
/// x: stretch of the transmission, m (rad), v its rate. b: whole gap, m (rad). b = 0 switches it off. No memory:
/// `side` is a mode of the stepper.
template <class T>
struct Backlash {
  static constexpr std::string_view name = "backlash", noun = "backlash",
                                    source = "Nordin and Gutman, Automatica 38 (2002), dead zone",
                                    equation = "x - b sgn(x)/2 where |x| > b/2, else 0",
                                    summary = "backlash: play in the motion, whatever the load";
  static constexpr unsigned roles = role::motion, sees = sees_position;
  T backlash;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Backlash::backlash, "backlash", Dimension::displacement, Purpose::amplitude, 0.5, 0.0,
                                inf, "whole width of the gap")};
  }
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    const Plain<S> touches = at.side * at.side;
    at.position = touches * (at.position - (0.5 * at.side) * backlash);
    at.velocity = touches * at.velocity;
    return at;
  }
  T half_gap() const { return 0.5 * backlash; }
};
}  // namespace tendonlab::transmission
