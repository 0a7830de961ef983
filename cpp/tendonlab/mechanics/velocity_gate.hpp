#pragma once
#include "tendonlab/core/dual.hpp"

namespace tendonlab::mechanics {
/// The dead zone of S3: below a threshold velocity the transmission holds its output, above it the output follows.
///
///   h = tanh(s_v (v² - v_t²))/2 + 1/2                                      (S3 eq. 20)
///   tau[k] = h target[k] + (1 - h) tau[k-1]                                (S3 eq. 21)
///
/// v: velocity of the drive, rad/s. h: share of one step of the control loop that passes, 1. Over n of its periods
/// (1 - h)^n is kept, so that a log at another rate means the same.
template <class T>
struct VelocityGate {
  T threshold, slope;

  T steepness(const T& velocity) const { return slope * (square(velocity) - square(threshold)); }
  /// h at `velocity`.
  T open(const T& velocity) const { return 0.5 + 0.5 * tanh(steepness(velocity)); }
  /// The share of the output that is kept over `periods` periods of the loop.
  T kept(const T& velocity, double periods) const {
    const T a = steepness(velocity), size = abs(a), rest = exp(-2.0 * size);  // no cancellation on either side
    const T shut = select(plain(a) < 0.0, T(1.0), rest) / (1.0 + rest);
    return periods == 1.0 ? shut : T(power(shut, T(periods)));
  }
  /// The output after `periods` periods: it moves from `previous` to `target`, less the share that is kept, and stays
  /// bit for bit where all is kept. `acting`: share of the gate that acts, 1 unless a bristle takes its place.
  T output(const T& target, const T& previous, const T& velocity, double periods, const T& acting = T(1.0)) const {
    const T same = acting * kept(velocity, periods);
    return same * previous + (1.0 - same) * target;
  }
};
}  // namespace tendonlab::mechanics
