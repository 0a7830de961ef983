#pragma once
// What a system reads from its inputs at an instant: logged signals, and the command that the loop makes of them.
#include <algorithm>

#include "tendonlab/integrate/experiment.hpp"
#include "tendonlab/integrate/past.hpp"
#include "tendonlab/systems/system.hpp"

namespace tendonlab::integrate {
using systems::Motion;

template <class T>
class Readings {
 public:
  static constexpr int max_inputs = 16;
  using Piece = PieceOf<T>;

  Readings(const Experiment& experiment, const T& command_delay, const T& sensor_delay, const T& sensor_bias)
      : from(experiment), late(command_delay), sensor_late(sensor_delay), bias(sensor_bias), remembers(needs_past()) {}

  /// The command that reaches the actuator, as a function of the motion. `S` may be without the derivatives of `T`: so
  /// modes are decided.
  template <class S, std::size_t n>
  S command_of(const std::array<S, n>& position, const std::array<S, n>& velocity, const S& now) const {
    const Loop& loop = from.loop;
    if (loop.kind == Loop::Kind::controller) {
      if (loop.sample_time > 0) return lift<S>(held);
      const S u = unlimited(position, velocity, now);
      const Plain<T> edge = edge_of(plain(u));
      const S limited = select(edge == 0.0, u, lift<S>(Plain<T>(edge * loop.limit)));
      return limited + loop.disturbance.value(S(now - lift<S>(late)), disturbance_piece);
    }
    const S u = from.inputs[0].value(S(now - lift<S>(late)), piece[0]);
    if (loop.kind == Loop::Kind::open) return u;
    // The sensor's model is inverted on the logged signal: its delay needs no past of the simulation.
    const S then = now + lift<S>(sensor_late);
    const auto axis = static_cast<std::size_t>(loop.axis);
    const S away = loop.reference.value(then, reference_piece) - lift<S>(bias) - position[axis];
    const S parting = loop.reference.slope(then, reference_piece) - velocity[axis];
    return u + lift<S>(pull) * (loop.proportional * away + loop.derivative * parting);
  }
  template <class S, int n>
  S command(const Motion<S, n>& at) const {
    return command_of(at.position, at.velocity, at.time);
  }
  template <int k, class S>
  S input(const S& now) const {
    return from.inputs[k].value(now, piece[k]);
  }
  /// The rate of an input, and its integral from the first sample.
  template <int k, class S>
  S slope(const S& now) const {
    return from.inputs[k].slope(now, piece[k]);
  }
  template <int k, class S>
  S integral(const S& now) const {
    return from.inputs[k].integral(now, piece[k]);
  }
  /// Was input k logged?
  template <int k>
  bool given() const {
    return !from.inputs[k].empty();
  }

  /// What a continuous controller would command if nothing clipped it: the guard of its saturation.
  template <class S, std::size_t n>
  S unlimited(const std::array<S, n>& position, const std::array<S, n>& velocity, const S& now) const {
    const Loop& loop = from.loop;
    const auto axis = static_cast<std::size_t>(loop.axis);
    const S then = now - lift<S>(late);
    S y = position[axis], rate = velocity[axis];
    if (remembers)  // copies, so that loops without a past keep theirs in registers
      std::tie(y, rate) = past.reading(S(then - lift<S>(sensor_late)), S(y), S(rate), S(now));
    const S r = loop.reference.value(then, reference_piece);
    const S dr = loop.reference_weight * loop.reference.slope(then, reference_piece);
    return loop.proportional * (r - (y + lift<S>(bias))) + loop.derivative * (dr - rate);
  }
  bool samples() const { return from.loop.kind == Loop::Kind::controller && from.loop.sample_time > 0; }

  const Experiment& from;
  T late, sensor_late, bias;
  bool remembers;     ///< does the loop (in lanes: that of any lane) read the past?
  Plain<T> side = 0;  ///< mode of the saturation: -1, 0, +1
  Plain<T> pull = 1;  ///< share of the injection: none where what a late sensor shows there was never logged
  Past<T> past;

 protected:
  /// A delay of 0 that is differentiated needs the past too: its derivative is the slope of the delayed signal.
  static bool is_late(const T& delay) { return any(plain(delay) > 0.0) || varies(delay); }
  bool needs_past() const {
    return from.loop.kind == Loop::Kind::controller && (is_late(sensor_late) || (is_late(late) && !samples()));
  }
  /// The limit that holds the command: a mode of the step, but where the loop reads the past.
  Plain<T> edge_of(const Plain<T>& u) const {
    if (!remembers) return side;
    if constexpr (in_lanes<T>)
      return past.choose(clipped(u), side);
    else
      return clipped(u);
  }
  template <class P>
  P clipped(const P& u) const {
    const double limit = from.loop.limit;
    return select(u > limit, P(1.0), select(u < -limit, P(-1.0), P(0.0)));
  }

  mutable std::array<Piece, max_inputs> piece{};
  mutable Piece reference_piece{}, disturbance_piece{};
  T held{};  ///< command of a sampled controller

  friend class LaneReadings;
};
}  // namespace tendonlab::integrate
