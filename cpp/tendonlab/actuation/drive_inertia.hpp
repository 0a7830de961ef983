#pragma once
#include "tendonlab/core/chain.hpp"

namespace tendonlab::actuation {
/// What laws of the effort of a drive see where its motion is an input of the system.
template <class S>
struct DriveEffort : Passing<S> {
  S slope{};         ///< rate of the effort where it enters the chain
  S acceleration{};  ///< of the drive

  template <class F>
  static constexpr void for_each_field(F&& f) {
    Passing<S>::for_each_field(f);
    f(
        "slope", sees_nothing, [](auto& at) -> auto& { return at.slope; });
    f(
        "acceleration", sees_nothing, [](auto& at) -> auto& { return at.acceleration; });
  }
};

/// Inertia of a drive whose torque was logged before it: the effort that accelerates the drive does not reach the
/// transmission.
///
///   u -> u - J dv/dt                                                      (balance of a drive, left out in S3)
///
/// u: effort of the drive, N·m (N). v: its velocity, an input of the system, rad/s (m/s). J: inertia, kg·m² (kg).
/// J = 0 switches it off. No memory.
template <class T>
struct DriveInertia {
  static constexpr std::string_view name = "drive_inertia", noun = "inertia",
                                    source = "balance of a drive, left out in S3", equation = "u - J dv/dt",
                                    summary = "inertia of the drive, whose torque was logged before it";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  template <class S>
  using Signal = DriveEffort<S>;
  T inertia;

  static constexpr auto parameters() {
    return std::tuple{parameter(&DriveInertia::inertia, "inertia", Dimension::inertia, Purpose::amplitude, 0.1, 0.0,
                                inf, "inertia between where the torque is known and the transmission")};
  }
  template <class S>
  S apply(const DriveEffort<S>& at) const {
    return at.signal - inertia * at.acceleration;
  }
};
}  // namespace tendonlab::actuation
