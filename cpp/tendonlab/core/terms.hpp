#pragma once
// Terms that several laws share.
#include "tendonlab/core/dual.hpp"

namespace tendonlab {
/// exp(-(v/v_s)^2): share of a Stribeck excess that is left at velocity v.
template <class S, class T>
S stribeck_decay(const S& velocity, const Divisor<T>& falloff) {
  return exp(-square(velocity / falloff));
}
/// s (1 - exp(-s mu theta)): share of the tension that a wrap takes, by direction s of sliding: of the tension where
/// the cable runs on for s = 1, where it leaves for s = -1. A magnitude without a kink; 0 for s = 0.
template <class S>
S wrap_loss(const S& friction_angle, const Plain<S>& direction) {
  return direction * (1.0 - exp(-(direction * friction_angle)));
}
}  // namespace tendonlab
