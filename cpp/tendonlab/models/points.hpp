#pragma once
// The points of a sweep: many configurations of one system.
#include <cstdint>
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
/// Where the outputs of points go.
class PointSink {
 public:
  virtual ~PointSink() = default;
  /// A row for the samples of each output, null where nobody wants them. Asked for when the point begins.
  virtual integrate::Trajectory::Rows rows(std::size_t point) = 0;
  /// The point has ended; `message` says why it failed, or is empty.
  virtual void done(std::size_t point, const std::string& message) = 0;
};
}  // namespace tendonlab
