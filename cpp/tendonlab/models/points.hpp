#pragma once
// The points of a sweep: many configurations of one system.
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tendonlab/integrate/experiment.hpp"

namespace tendonlab {
/// One row for each point: a value per parameter, a flag per effect, the initial state.
struct Points {
  std::size_t count;
  const double* values;        ///< [point][parameter]
  const std::uint8_t* active;  ///< [point][effect]
  const double* position;      ///< [point][degree of freedom]
  const double* velocity;      ///< [point][degree of freedom]
};
/// Gets each point as soon as its simulation ends: its number, the outputs, and why it failed (empty: it did not).
using PointDone = std::function<void(std::size_t, const integrate::Trajectory&, const std::string&)>;
}  // namespace tendonlab
