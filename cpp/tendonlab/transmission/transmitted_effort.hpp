#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::transmission {
/// What laws of the effort see that a transmission passes on. Its `signal` enters as the effort less all friction.
template <class S>
struct TransmittedEffort : Passing<S> {
  S start{};          ///< what was transmitted before the first sample
  S smooth{};         ///< the effort without dry friction
  S dry_level{};      ///< dry friction, a magnitude
  S bristle_share{};  ///< share of the dry friction that a bristle takes over
  S velocity{};       ///< at which the transmission slides

  template <class F>
  static constexpr void for_each_field(F&& f) {
    Passing<S>::for_each_field(f);
    f(
        "start", sees_nothing, [](auto& at) -> auto& { return at.start; });
    f(
        "smooth", sees_nothing, [](auto& at) -> auto& { return at.smooth; });
    f(
        "dry_level", sees_nothing, [](auto& at) -> auto& { return at.dry_level; });
    f(
        "bristle_share", sees_nothing, [](auto& at) -> auto& { return at.bristle_share; });
    f(
        "velocity", sees_nothing, [](auto& at) -> auto& { return at.velocity; });
  }
};
}  // namespace tendonlab::transmission
