#pragma once
// The past of the looped axis, for loops with a delay: the dense output of the steps taken, as far back as needed.
#include <algorithm>
#include <deque>
#include <limits>
#include <tuple>

#include "tendonlab/integrate/step.hpp"

namespace tendonlab::integrate {
template <class T>
class Past {
 public:
  /// Delays below this, in s, are expanded about the present instead of bounding every step.
  static constexpr double shortest = 1e-4;

  /// Before `now` the axis moved as it does now. `sampled`: readings happen at instants that no step straddles.
  void begin(const T& position, const T& velocity, double now, bool sampled) {
    first_position = position, first_velocity = velocity, beginning = now;
    segment_read = sampled ? std::numeric_limits<int>::max() : -1;
  }
  template <class Y>
  void add(const Step<Y>& s, double start, double h, double taken, int axis, double keep) {
    const auto j = static_cast<std::size_t>(axis);
    const auto part = [&](const auto& of) {
      return Curve{of(s.from.at), of(s.to.at), of(s.first.at), of(s.second.at), of(s.third.at)};
    };
    pieces.push_back({start, start + taken, h, segment_written, part([&](const auto& at) { return at.position[j]; }),
                      part([&](const auto& at) { return at.velocity[j]; })});
    while (pieces.size() > 1 && pieces.front().end < start - 2 * keep) pieces.pop_front();
  }
  /// Pieces added from now on lie beyond a kink of the motion.
  void split() { ++segment_written; }
  /// Readings have reached the next kink.
  void advance() { ++segment_read; }
  /// The acceleration at `now` and its rate.
  void arrive(const T& at_present, const T& rate, double now) { acceleration = at_present, jerk = rate, present = now; }

  /// Position and velocity at time `then`; `y`, `rate` are those at `now`.
  template <class S>
  std::tuple<S, S> reading(const S& then, const S& y, const S& rate, const S& now) const {
    const S late = now - then;
    if (plain(late) <= shortest) {
      const S change = lift<S>(acceleration) + lift<S>(jerk) * (now - present);
      return {y - late * (rate - 0.5 * late * change), rate - late * change};
    }
    if (segment_read < 0 || plain(then) <= beginning || pieces.empty())
      return {lift<S>(first_position) - (beginning - then) * lift<S>(first_velocity), lift<S>(first_velocity)};
    const auto p = piece_at(plain(then));
    const S s = (then - p->start) * (1.0 / p->h);
    return {p->position.template at<S>(s), p->velocity.template at<S>(s)};
  }

 private:
  struct Curve {
    T from, to, first, second, third;
    template <class S>
    S at(const S& s) const {
      return lift<S>(from) +
             s * (lift<S>(T(to - from)) + (1.0 - s) * (lift<S>(first) + s * (lift<S>(second) + s * lift<S>(third))));
    }
  };
  struct Piece {
    double start, end, h;
    int segment;  ///< how many kinks lie before it
    Curve position, velocity;
  };
  /// The piece that holds `then`, of the last stretch without a kink that readings have reached: never one beyond the
  /// kink that the stepper landed on. A loop that runs away has thousands of them.
  auto piece_at(double then) const {
    const auto end =
        std::partition_point(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.segment <= segment_read; });
    if (end == pieces.begin()) return end;
    const int segment = std::prev(end)->segment;
    const auto begin = std::partition_point(pieces.begin(), end, [&](const Piece& p) { return p.segment < segment; });
    const auto after = std::partition_point(begin, end, [&](const Piece& p) { return p.start <= then; });
    return after == begin ? begin : std::prev(after);
  }
  std::deque<Piece> pieces;
  T first_position{}, first_velocity{}, acceleration{}, jerk{};
  double beginning = 0, present = 0;
  int segment_written = -1, segment_read = -1;
};
/// Simulations whose loop reads the past do not run in lanes.
template <>
class Past<Lanes> {};
}  // namespace tendonlab::integrate
