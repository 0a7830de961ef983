#pragma once
#include <cmath>

namespace tendonlab::integrate {
/// The first guard that a step passes; mode -1: none.
struct Crossing {
  int mode = -1;
  double share = 2;    ///< of the step, where it lies
  double toward = 0;   ///< which way a gap is crossed
  bool stale = false;  ///< the step began on its guard, in a mode that does not hold
  bool past = false;   ///< it began beyond its guard, by more than rounding
};

/// The share of a step at which `margin(share)` passes 0, by Illinois; ends on a point that the secant chose, never on
/// a midpoint.
template <class Margin>
double root(Margin&& margin, double low_value, double high_value) {
  double low = 0, high = 1, at = low_value / (low_value - high_value);
  int side = 0;
  for (int i = 0; i < 60 && high - low > 1e-15; ++i) {
    const double f = margin(at);
    if (std::fabs(f) <= 1e-14) break;
    if (f < 0) {
      if (side < 0) low_value *= 0.5;
      high = at, high_value = f, side = -1;
    } else {
      if (side > 0) high_value *= 0.5;
      low = at, low_value = f, side = 1;
    }
    at = low + (high - low) * (low_value / (low_value - high_value));
  }
  return at;
}
}  // namespace tendonlab::integrate
