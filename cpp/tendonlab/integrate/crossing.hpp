#pragma once
namespace tendonlab::integrate {
/// The first guard that a step passes; mode -1: none.
struct Crossing {
  int mode = -1;
  double share = 2;    ///< of the step, where it lies
  double toward = 0;   ///< which way a gap is crossed
  bool stale = false;  ///< the step began on its guard, in a mode that does not hold
  bool past = false;   ///< it began beyond its guard, by more than rounding
};
}  // namespace tendonlab::integrate
