#pragma once
// The input and the result of a simulation: plain data, the same for every system.
#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "tendonlab/integrate/signal.hpp"

namespace tendonlab::integrate {
/// How the command of the actuator comes about. u: command, r: reference, y: reading of the looped sensor. Before the
/// record began all was as at its first sample: so a command that is late starts with the first one, and a loop that
/// looks back finds the initial state.
struct Loop {
  enum class Kind {
    open,       ///< u as logged
    injection,  ///< u as logged, and what pulls the simulated sensor to the logged one (a replay, not part of the rig)
    controller  ///< u = clip(P (r - y) + D (w r' - y')) + disturbance, in continuous or sampled time
  };
  Kind kind = Kind::open;
  int axis = 0, output = 0;  ///< the degree of freedom that is fed back, and its output
  double proportional = 0, derivative = 0;
  double reference_weight = 1;  ///< w: 1 where the error is differentiated, 0 where the measurement is
  double limit = std::numeric_limits<double>::infinity();
  double sample_time = 0;  ///< s; 0: continuous
  Signal reference, disturbance;
};

/// The initial position of a degree of freedom that a sensor told: `share` times its reading, less what it adds.
struct TakenReading {
  int axis = 0, output = 0;
  double share = 1;
};

/// One experiment as the simulator needs it.
struct Experiment {
  std::vector<double> time;    ///< instants of the samples, s, increasing
  std::vector<Signal> inputs;  ///< in the order of the system's inputs; empty ones are zero
  Loop loop;
  std::vector<double> position, velocity;  ///< initial state, one number per degree of freedom
  std::vector<TakenReading> taken;         ///< positions that are not yet freed of the bias of their sensors
  std::vector<double> reading;             ///< of the sensor of each output before the first sample; NaN: not known
  double sense = 1;                        ///< in which what rests at the start has moved last
};

/// A number by which outputs are differentiated: a parameter or part of the initial state. Seed k gives column k of the
/// gradient.
struct Seed {
  enum class Of { parameter, position, velocity, reading } of = Of::parameter;
  int index = 0;
};
/// The numbers of the initial state that a seed is one of.
template <class Begun>
auto& numbers_of(Seed::Of of, Begun& from) {
  return of == Seed::Of::position ? from.position : of == Seed::Of::velocity ? from.velocity : from.reading;
}

/// Which quantities of ports are recorded.
struct PortRows {
  enum Quantity { velocity, position, load, force };
  static constexpr int all = 4;
  static constexpr std::array<std::string_view, all> names{"velocity", "position", "load", "force"};
  std::uint32_t wanted = 0;  ///< a bit per quantity
  bool has(int quantity) const { return (wanted >> quantity & 1u) != 0; }
  bool any() const { return wanted != 0; }
  std::size_t count() const { return before(all); }
  /// How many wanted ones stand before a quantity: where its row lies.
  std::size_t before(int quantity) const {
    std::size_t n = 0;
    for (int k = 0; k < quantity; ++k) n += has(k);
    return n;
  }
};

struct Settings {
  double tolerance = 1e-6;
  double position_scale = 1e-2, velocity_scale = 1e-2;  ///< error is relative to scale + |value|
  long max_attempts = 20'000'000;
  PortRows ports;               ///< what to record of each port
  std::uint32_t outputs = ~0u;  ///< a bit per output that is recorded; the others stay 0
  /// A velocity below a tenth of what a step may err by at rest is nothing but the stepper's error.
  double unresolved_velocity() const { return 0.1 * tolerance * velocity_scale; }
};

struct Trajectory {
  int channels = 0, samples = 0, width = 0;
  std::vector<double> value;     ///< [channel][sample]
  std::vector<double> gradient;  ///< [column][channel][sample]
  std::vector<double> port;      ///< [port][wanted quantity][sample]
  long attempts = 0, rejected = 0, events = 0;

  /// Where the samples of each output go; null: nobody wants them.
  using Rows = std::vector<double*>;
  /// A bit per output that is wanted.
  Rows rows(std::uint32_t wanted) {
    Rows all;
    for (int c = 0; c < channels; ++c)
      all.push_back((wanted >> c & 1u) != 0 ? value.data() + static_cast<std::ptrdiff_t>(c) * samples : nullptr);
    return all;
  }
  /// Where the samples of one quantity of a port go.
  double* port_row(std::size_t of, const PortRows& shown, int quantity) {
    return port.data() + (of * shown.count() + shown.before(quantity)) * static_cast<std::size_t>(samples);
  }
  /// Writes the derivatives of one output at one sample into `width` columns of the gradient from `column` on.
  template <class T>
  TENDONLAB_INLINE void write_derivatives(std::size_t channel, std::size_t sample, const T& of, int column, int width) {
    if constexpr (!std::is_same_v<T, double>) {
      const auto stride = static_cast<std::size_t>(channels) * static_cast<std::size_t>(samples);
      const std::size_t place = channel * static_cast<std::size_t>(samples) + sample;
      double* cell = &gradient[static_cast<std::size_t>(column) * stride + place];
      of.each_derivative(width, [&](double d) {
        *cell = d;
        cell += stride;
      });
    }
  }
};
}  // namespace tendonlab::integrate
