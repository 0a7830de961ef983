#pragma once
// Many simulations of one experiment: the points of a sweep.
#include "tendonlab/models/model.hpp"

namespace tendonlab {
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
