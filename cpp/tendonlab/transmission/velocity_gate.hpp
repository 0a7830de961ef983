#pragma once
#include "tendonlab/transmission/transmitted_effort.hpp"

namespace tendonlab::transmission {
/// Velocity gate, the dead zone of S3: below a threshold velocity the transmission holds its output, above it the
/// output follows.
///
///   h = tanh(s_v (v² - v_t²))/2 + 1/2                                      (S3 eq. 20)
///   tau[k] = h target[k] + (1 - h) tau[k-1]                                (S3 eq. 21)
///
/// v: velocity of the drive, rad/s. h: share of one period of the control loop that passes, 1. Over n periods (1 - h)^n
/// is kept, so that a log at another rate means the same. a: share of (1 - h) that acts where no bristle takes its
/// place; a = 0 switches it off. State: tau.
template <class T>
struct VelocityGate {
  static constexpr std::string_view name = "velocity_gate", noun = "velocity gate", source = "S3 eq. 20, 21",
                                    equation = "h target[k] + (1 - h) tau[k-1], h = tanh(s_v (v^2 - v_t^2))/2 + 1/2",
                                    summary = "velocity gate: below a threshold velocity the output is held";
  static constexpr unsigned roles = role::signal, sees = sees_nothing;
  static constexpr double period = 1e-3;  ///< s, of the control loop whose steps the gate speaks of
  template <class S>
  using Signal = TransmittedEffort<S>;
  T threshold, slope, share;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&VelocityGate::threshold, "threshold_velocity", Dimension::flow, Purpose::structure, 0.1, 0.0, inf,
                  "speed of the drive at which half of a step gets through the gate"),
        parameter(&VelocityGate::slope, "threshold_slope", Dimension::per_flow_squared, Purpose::structure, 1e3, 1e-9,
                  inf, "steepness of the gate over the square of the speed"),
        parameter(&VelocityGate::share, "gate_share", Dimension::ratio, Purpose::share, 1.0, 0.0, 1.0,
                  "share of the gate that acts")};
  }
  template <class S>
  struct State {
    S output{};
  };
  template <class S>
  State<S> next(const State<S>& before, const TransmittedEffort<S>& at) const {
    const bool first = at.dt == 0.0;
    const S held = (share * (1.0 - at.bristle_share)) * kept(at.velocity, first ? 1.0 : at.dt / period);
    return {held * (first ? at.start : before.output) + (1.0 - held) * at.signal};
  }
  template <class S>
  S apply(const TransmittedEffort<S>&, const State<S>& now) const {
    return now.output;
  }
  template <class S>
  S steepness(const S& velocity) const {
    return slope * (square(velocity) - square(threshold));
  }
  /// h at `velocity`.
  template <class S>
  S open(const S& velocity) const {
    return 0.5 + 0.5 * tanh(steepness(velocity));
  }
  /// (1 - h)^n: the share of the output that is kept over n = `periods` of the loop.
  template <class S>
  S kept(const S& velocity, double periods) const {
    const S a = steepness(velocity), size = abs(a), rest = exp(-2.0 * size);  // no cancellation on either side
    const S shut = select(plain(a) < 0.0, constant<S>(1.0), rest) / (1.0 + rest);
    return periods == 1.0 ? shut : S(power(shut, S(periods)));
  }
};
}  // namespace tendonlab::transmission
