#pragma once
// Many simulations of one experiment: the points of a sweep.
#include <cstdint>

#include "tendonlab/models/model.hpp"

namespace tendonlab {
/// The points of a sweep, one row each: a value per parameter, a flag per effect, the initial state.
struct Points {
  std::size_t count;
  const double* values;        ///< [point][parameter]
  const std::uint8_t* active;  ///< [point][effect]
  const double* position;      ///< [point][degree of freedom]
  const double* velocity;      ///< [point][degree of freedom]
};
/// Where the outputs go, [point][channel][sample], of the channels listed. `Real`: double or float.
template <class Real>
struct Outputs {
  const std::vector<std::size_t>& channels;
  Real* to;
};

/// Simulates each point. Gives a message per point: empty, or why it failed; the outputs of that point are then NaN.
/// Throws ParameterError for a value outside its bounds.
template <class Real>
std::vector<std::string> simulate_batch(const Model& model, const Points& points,
                                        const integrate::Experiment& experiment, const integrate::Settings& settings,
                                        const Outputs<Real>& out);
}  // namespace tendonlab
