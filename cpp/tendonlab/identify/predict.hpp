#pragma once
// What one experiment of a fit predicts: simulation and whitening, with derivatives by the coordinates. Knows no
// solver.
#include "tendonlab/identify/fit.hpp"

namespace tendonlab::identify {
class Prediction {
 public:
  /// Throws ParameterError where the task does not fit its model or its whitening. `problem` must outlive this.
  Prediction(const Problem& problem, std::size_t task);
  Eigen::Index num_free() const { return static_cast<Eigen::Index>(problem.free.size()); }
  Eigen::Index num_initial() const { return static_cast<Eigen::Index>(task.initial.size()); }
  /// At the coordinates x of the free parameters and z of the free states. Throws NumericalError, ParameterError.
  Linearised at(const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives) const;
  std::vector<double> states(const Eigen::VectorXd& z) const;
  Eigen::VectorXd coordinates(const std::vector<double>& states) const;

 private:
  double prior_mean(const FreeState& state) const;
  Configuration configuration_at(const Eigen::VectorXd& x) const;
  integrate::Experiment experiment_at(const Eigen::VectorXd& z) const;
  Eigen::MatrixXd whitened_gradient(const integrate::Trajectory& run) const;

  const Problem& problem;
  const Task& task;
  std::vector<std::size_t> moving;  ///< free parameters that no condition fixes here
  std::vector<integrate::Seed> seeds;
};
}  // namespace tendonlab::identify
