#pragma once
// What an experiment is made of, as tuples: results that hold experiments can be pickled and copied.
#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/integrate/experiment.hpp"

namespace tendonlab::bindings {
inline auto pickled_signal() {
  using integrate::Signal;
  return py::pickle([](const Signal& s) { return py::make_tuple(s.knots, s.coefficients, s.holds); },
                    [](const py::tuple& state) {
                      Signal s;
                      s.knots = state[0].cast<std::vector<double>>();
                      s.coefficients = state[1].cast<std::vector<std::array<double, 4>>>();
                      s.holds = state[2].cast<bool>();
                      s.prepare();
                      return s;
                    });
}

inline auto pickled_loop() {
  using integrate::Loop;
  using integrate::Signal;
  return py::pickle(
      [](const Loop& l) {
        return py::make_tuple(static_cast<int>(l.kind), l.axis, l.output, l.proportional, l.derivative,
                              l.reference_weight, l.limit, l.sample_time, l.reference, l.disturbance);
      },
      [](const py::tuple& state) {
        Loop l;
        l.kind = static_cast<Loop::Kind>(state[0].cast<int>());
        l.axis = state[1].cast<int>(), l.output = state[2].cast<int>();
        l.proportional = state[3].cast<double>(), l.derivative = state[4].cast<double>();
        l.reference_weight = state[5].cast<double>();
        l.limit = state[6].cast<double>(), l.sample_time = state[7].cast<double>();
        l.reference = state[8].cast<Signal>(), l.disturbance = state[9].cast<Signal>();
        return l;
      });
}

/// (axis, output, share) of positions that sensors told.
using ReadingRows = std::vector<std::tuple<int, int, double>>;
inline std::vector<integrate::TakenReading> to_readings(const ReadingRows& rows) {
  std::vector<integrate::TakenReading> all;
  for (const auto& [axis, output, share] : rows) all.push_back({axis, output, share});
  return all;
}
inline ReadingRows to_rows(const std::vector<integrate::TakenReading>& readings) {
  ReadingRows all;
  for (const auto& reading : readings) all.emplace_back(reading.axis, reading.output, reading.share);
  return all;
}
inline auto pickled_experiment() {
  using integrate::Experiment;
  return py::pickle(
      [](const Experiment& e) {
        return py::make_tuple(e.time, e.inputs, e.loop, e.position, e.velocity, to_rows(e.taken), e.reading, e.sense);
      },
      [](const py::tuple& state) {
        return Experiment{state[0].cast<std::vector<double>>(), state[1].cast<std::vector<integrate::Signal>>(),
                          state[2].cast<integrate::Loop>(),     state[3].cast<std::vector<double>>(),
                          state[4].cast<std::vector<double>>(), to_readings(state[5].cast<ReadingRows>()),
                          state[6].cast<std::vector<double>>(), state[7].cast<double>()};
      });
}
}  // namespace tendonlab::bindings
