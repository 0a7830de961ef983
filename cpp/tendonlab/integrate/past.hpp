#pragma once
// The past of the looped axis, for loops with a delay: the dense output of the steps taken, as far back as needed.
#include <deque>
#include <tuple>

#include "tendonlab/integrate/step.hpp"

namespace tendonlab::integrate {
template <class T>
class Past {
 public:
  /// Delays below this, in s, are expanded to first order about the present instead of bounding every step.
  static constexpr double shortest = 1e-4;

  template <class Y>
  void add(const Step<Y>& s, double start, double h, double taken, int axis, double keep) {
    const auto j = static_cast<std::size_t>(axis);
    const auto part = [&](const auto& of) { return Curve{of(s.from.at), of(s.to.at), of(s.first.at), of(s.second.at)}; };
    pieces.push_back({start, start + taken, h, part([&](const auto& at) { return at.position[j]; }),
                      part([&](const auto& at) { return at.velocity[j]; })});
    acceleration = (s.to.at.velocity[j] - s.from.at.velocity[j]) * (1.0 / h);
    while (pieces.size() > 1 && pieces.front().end < start - 2 * keep) pieces.pop_front();
  }
  /// Position and velocity at time `then`; `y`, `rate` are those at `now`.
  template <class S>
  std::tuple<S, S> reading(const S& then, const S& y, const S& rate, const S& now) const {
    if (plain(now) - plain(then) <= shortest)
      return {y - (now - then) * rate, rate - (now - then) * lift<S>(acceleration)};
    if (pieces.empty() || plain(then) <= pieces.front().start) return first(y, rate);
    auto p = pieces.rbegin();
    while (p + 1 != pieces.rend() && p->start > plain(then)) ++p;
    const S s = (then - p->start) * (1.0 / p->h);
    return {p->position.template at<S>(s), p->velocity.template at<S>(s)};
  }

 private:
  struct Curve {
    T from, to, first, second;
    template <class S>
    S at(const S& s) const {
      const S u = 1.0 - s;
      return u * lift<S>(from) + s * (lift<S>(to) + u * (lift<S>(first) + s * lift<S>(second)));
    }
  };
  struct Piece {
    double start, end, h;
    Curve position, velocity;
  };
  /// Before the start everything was as it was at the start.
  template <class S>
  std::tuple<S, S> first(const S& y, const S& rate) const {
    if (pieces.empty()) return {y, rate};
    return {lift<S>(pieces.front().position.from), lift<S>(pieces.front().velocity.from)};
  }
  std::deque<Piece> pieces;
  T acceleration{};
};
}  // namespace tendonlab::integrate
