#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::loading {
/// Offset of the load: a constant unknown disturbance on the joint.
///
///   F -> F + F_0                                              (constant term of the equation of motion)
///
/// F: effort known to act on the joint, N (N·m), positive forwards. F_0 = 0 switches it off. A rigid joint cannot tell
/// it from an offset of the actuator; behind an elastic cable the stretch does.
template <class T>
struct Offset {
  static constexpr std::string_view name = "offset", noun = "constant disturbance",
                                    source = "constant term of the equation of motion", equation = "F + F_0",
                                    summary = "load offset: a constant disturbance on the joint";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  T offset;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Offset::offset, "offset", Dimension::effort, Purpose::amplitude, 0.05, -inf, inf,
                                "effort on the joint in addition to the known one")};
  }
  template <class S>
  S apply(const Passing<S>& at) const {
    return at.signal + offset;
  }
};
}  // namespace tendonlab::loading
