#pragma once
// Runs a sampled system through the samples of an experiment: no step, no event. Knows no physics.
#include <optional>

#include "tendonlab/integrate/experiment.hpp"
#include "tendonlab/integrate/rate.hpp"
#include "tendonlab/systems/sampled.hpp"

namespace tendonlab::integrate {
/// The inputs as a sampled system sees them.
template <class T>
class SampleInputs {
 public:
  SampleInputs(const Experiment& of, const std::vector<T>& outputs_before)
      : from(of), began(outputs_before), piece(of.inputs.size()) {}
  void move_to(std::size_t sample) {
    now = from.time[sample];
    dt = sample > 0 ? now - from.time[sample - 1] : 0.0;
    for (std::size_t k = 0; k < piece.size(); ++k)
      if (!from.inputs[k].empty()) piece[k] = from.inputs[k].locate(now, piece[k]);
  }
  template <std::size_t k>
  T input() const {
    return T(from.inputs[k].value(now, piece[k]));
  }
  template <std::size_t k>
  T slope() const {
    return T(from.inputs[k].slope(now, piece[k]));
  }
  template <std::size_t k>
  bool given() const {
    return !from.inputs[k].empty();
  }
  /// Output c before the first sample, where it is known.
  template <std::size_t c>
  std::optional<T> before() const {
    return std::isfinite(plain(began[c])) ? std::optional(began[c]) : std::nullopt;
  }
  double now = 0, dt = 0;

 private:
  const Experiment& from;
  const std::vector<T>& began;
  mutable std::vector<int> piece;
};

template <class System, class T>
class Sampling {
  static constexpr std::size_t channels = System::outputs.size(), ports = System::ports.size();

 public:
  /// Writes outputs, their derivatives in `columns` columns from the first, and what the ports saw. `before`: what the
  /// sensors read before the first sample.
  Sampling(const System& of, const Experiment& experiment, std::vector<T> before, Trajectory& into, int first_column,
           int columns, const PortRows& shown, std::uint32_t outputs)
      : system(of), time(experiment.time), out(into), column(first_column), width(columns) {
    std::vector<std::array<T, channels>> all(time.size());
    for (std::size_t c = 0; c < channels; ++c) before[c] = before[c] - system.sensor[c].bias();
    SampleInputs<T> inputs(experiment, before);
    systems::Memory<T, static_cast<std::size_t>(memories<System>), typename System::Carried> memory;
    for (std::size_t k = 0; k < time.size(); ++k) {
      inputs.move_to(k);
      const auto sample = system.evaluate(inputs, memory);
      all[k] = sample.output;
      if (shown.any()) write_ports(k, sample, shown);
    }
    out.attempts = static_cast<long>(time.size());
    const auto rows = out.rows(outputs);
    for (std::size_t c = 0; c < channels; ++c)
      for (std::size_t k = 0; rows[c] && k < time.size(); ++k) {
        const T shown = system.sensor[c].apply(seen(all, c, k));
        rows[c][k] = plain(shown);
        out.write_derivatives(c, k, shown, column, width);
      }
  }

 private:
  /// Output c at sample k as its sensor sees it: late ones straight between samples.
  T seen(const std::vector<std::array<T, channels>>& all, std::size_t c, std::size_t k) const {
    const T late = system.sensor[c].delay();
    if (!(plain(late) > 0 || varies(late))) return all[k][c];
    const double then = time[k] - plain(late);
    std::size_t i = k > 0 ? k - 1 : 0;
    while (i > 0 && time[i] > then) --i;
    if (then <= time.front() || k == 0) return all[0][c];
    const T share = ((time[k] - time[i]) - late) / (time[i + 1] - time[i]);
    return all[i][c] + share * (all[i + 1][c] - all[i][c]);
  }
  template <class Shown>
  void write_ports(std::size_t sample, const Shown& of, const PortRows& shown) {
    for (std::size_t i = 0; i < ports; ++i) {
      const auto& port = of.port[i];
      const double row[PortRows::all] = {plain(port.velocity), plain(port.position), plain(port.load),
                                         plain(of.force[i])};
      for (int k = 0; k < PortRows::all; ++k)
        if (shown.has(k)) out.port_row(i, shown, k)[sample] = row[k];
    }
  }

  const System& system;
  const std::vector<double>& time;
  Trajectory& out;
  const int column, width;
};
}  // namespace tendonlab::integrate
