#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::actuation {
/// Deadband of the actuator: a small command has no effect, a larger one loses as much.
///
///   u -> 0 where |u| <= w,   u -> u - w sgn(u) beyond                     (dead zone of a drive)
///
/// u: effort by the command, N (N·m). w: half width. The effort is continuous at both edges, so no mode is needed and
/// derivatives are exact. w = 0 switches it off. No memory.
template <class T>
struct Deadband {
  static constexpr std::string_view name = "deadband", noun = "deadband", source = "dead zone of a drive",
                                    equation = "0 where |u| <= w, u - w sgn(u) beyond",
                                    summary = "actuation deadband: a small command has no effect";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T half_width;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Deadband::half_width, "deadband", Dimension::effort, Purpose::amplitude, 0.05, 0.0,
                                inf, "half width of the command in which nothing passes")};
  }
  template <class S>
  S apply(const Passing<S>& at) const {
    const Plain<S> u = plain(at.signal), sense = select(u < 0.0, Plain<S>(-1.0), Plain<S>(1.0));
    return select(sense * u >= plain(half_width), S(at.signal - sense * half_width), constant<S>(0.0));
  }
};
}  // namespace tendonlab::actuation
