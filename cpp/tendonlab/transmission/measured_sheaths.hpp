#pragma once
// The laws of S3 in sheaths of a measured shape: the output torque sample by sample.
#include "tendonlab/mechanics/sheaths.hpp"
#include "tendonlab/transmission/sheath_capstan.hpp"
#include "tendonlab/transmission/velocity_gate.hpp"

namespace tendonlab::transmission {
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
/// The whole law (S3 eq. 18-21); `start`: the output before the first sample.
inline Transmitted transmit(const mechanics::Sheaths& of, const std::vector<double>& torque,
                            const std::vector<double>& velocity, const SheathCapstan<double>& capstan,
                            const Gating& gating, double start) {
  const std::size_t count = torque.size();
  Transmitted all{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
  bool is_open = false;
  double last = -1.0, gain = 0.0, offset = 0.0;
  TransmittedEffort<double> at;
  at.dt = gating.periods * VelocityGate<double>::period;
  VelocityGate<double>::State<double> state{start};
  for (std::size_t k = 0; k < count; ++k) {
    const double v = velocity[k], direction = static_cast<double>((v > 0) - (v < 0));
    const double mu = capstan.coefficient(Sliding<double>{v});
    if (mu != last) {
      const mechanics::TendonPair<double> pair = of.at(mu);
      last = mu, gain = pair.torque_gain(), offset = pair.offset();
    }
    VelocityGate<double> gate = gating.gate;
    if (is_open) gate.threshold *= gating.release;
    is_open = gate.steepness(v) >= 0.0;
    at.signal = gain * torque[k] + direction * offset, at.velocity = v;
    state = gate.next(state, at);
    all.output[k] = state.output, all.open[k] = gate.open(v), all.coefficient[k] = mu;
  }
  return all;
}
}  // namespace tendonlab::transmission
