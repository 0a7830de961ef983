#pragma once
// How long explicit steps may be, learnt from those that were taken.
#include <algorithm>
#include <cmath>

namespace tendonlab::integrate {
class ExplicitReach {
 public:
  /// The fewest equal explicit steps that are exact enough to get as far as `length`.
  double parts(double length) const { return std::max(1.0, std::ceil(length / longest)); }
  void failed(double shorter) { longest = shorter, has_failed = true; }
  /// From an accepted step, which wishes to grow by `wish`. Until an explicit one has failed, it may be as long as a
  /// Rosenbrock step was.
  void learn(bool explicitly, double length, double wish) {
    if (explicitly)
      longest = std::max(longest, length * wish);
    else
      longest = has_failed ? GROWTH * longest : std::max(longest, length);
  }

 private:
  static constexpr double GROWTH = 1.03;
  double longest = 0;
  bool has_failed = false;
};
}  // namespace tendonlab::integrate
