#pragma once
// The pair of S3 in sheaths of a measured shape, and its output torque sample by sample.
#include "tendonlab/core/error.hpp"
#include "tendonlab/mechanics/tendon_pair.hpp"
#include "tendonlab/mechanics/velocity_gate.hpp"

namespace tendonlab::mechanics {
/// Two pretensioned tendons in sheaths of one measured shape: `turning`, rad, at each `arc_length`, m, both from 0.
struct Sheaths {
  std::vector<double> arc_length, turning;
  double pretension, input_radius, output_radius;
  bool uniform_pretension;  ///< along the sheath; else friction has let it decay

  TendonPair<double> at(double coefficient) const {
    require_within("friction_coefficient", coefficient, 0.0, inf, "1");
    const AlongSheath<double> along = along_sheath(coefficient, arc_length, turning);
    return {along, input_radius, output_radius,
            pretension * (uniform_pretension ? arc_length.back() : along.psi_alpha)};
  }
};

/// Output torque, N·m, share of each step that passes the gate, and friction coefficient, at each sample.
struct Transmitted {
  std::vector<double> output, open, coefficient;
};
/// How a gate acts on a log: `periods` of its loop per sample. An open gate shuts at `release` times its threshold, so
/// that noise about the threshold does not make it chatter.
struct Gating {
  VelocityGate<double> gate;
  double periods, release;
};
/// The whole law sample by sample (S3 eq. 19-21). `coefficient`: friction coefficient at a velocity.
template <class Coefficient>
Transmitted transmit(const Sheaths& of, const std::vector<double>& torque, const std::vector<double>& velocity,
                     const Coefficient& coefficient, const Gating& gating, double start) {
  const std::size_t count = torque.size();
  Transmitted all{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
  bool is_open = false;
  double last = -1.0, gain = 0.0, offset = 0.0, held = start;
  for (std::size_t k = 0; k < count; ++k) {
    const double v = velocity[k], direction = static_cast<double>((v > 0) - (v < 0)), mu = coefficient(v);
    if (mu != last) {
      const TendonPair<double> pair = of.at(mu);
      last = mu, gain = pair.torque_gain(), offset = pair.offset();
    }
    VelocityGate<double> gate = gating.gate;
    if (is_open) gate.threshold *= gating.release;
    is_open = gate.steepness(v) >= 0.0;
    held = gate.output(gain * torque[k] + direction * offset, held, v, gating.periods);
    all.output[k] = held, all.open[k] = gate.open(v), all.coefficient[k] = mu;
  }
  return all;
}
}  // namespace tendonlab::mechanics
