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
  Eigen::Index num_initial() const { return static_cast<Eigen::Index>(task.initial.size() + task.scatter.size()); }
  /// At the coordinates x of the free parameters and z of the task's own unknowns. Throws NumericalError,
  /// ParameterError.
  Linearised at(const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives) const;
  /// Does one simulation give all derivatives?
  bool takes_one_simulation() const { return seeds.size() <= seeds_at_once(); }
  std::vector<double> states(const Eigen::VectorXd& z) const;
  Eigen::VectorXd coordinates(const std::vector<double>& states) const;

 private:
  /// Where the gradient of a parameter stands among the seeds; -1: it is not differentiated.
  Eigen::Index column(std::size_t parameter) const;
  double prior_mean(std::size_t own) const;
  double prior_sd(std::size_t own) const;
  /// The factor by which run-to-run scatter changes a parameter.
  double factor(std::size_t parameter, const Eigen::VectorXd& z) const;
  Configuration configuration_at(const Eigen::VectorXd& x, const Eigen::VectorXd& z) const;
  integrate::Experiment experiment_at(const Eigen::VectorXd& z) const;
  /// Fills the columns of the derivatives from those of a simulation.
  void differentiate(const integrate::Trajectory& run, const Configuration& with, const Eigen::VectorXd& x,
                     const Eigen::VectorXd& z, Linearised& out) const;

  const Problem& problem;
  const Task& task;
  integrate::Settings settings;        ///< records the outputs that are scored
  std::vector<std::size_t> moving;     ///< free parameters that no condition fixes here
  std::vector<integrate::Seed> seeds;  ///< of the moving parameters, the states, other scattered ones
  std::vector<std::pair<std::size_t, Eigen::Index>> column_of;  ///< of each parameter that is differentiated
};

/// A prediction that remembers the points where it was last made, with derivatives and without: a solver asks for the
/// same point several times. It mostly accepts the first point that it tries, and then asks for the derivatives there:
/// where one simulation gives them, they are computed at once. The value alone would take half as long.
class Remembered {
 public:
  Remembered(const Problem& problem, std::size_t task) : prediction(problem, task) {}
  const Prediction& of() const { return prediction; }
  /// As Prediction::at. The reference holds until the next call.
  const Linearised& at(const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives);

 private:
  struct Point {
    Eigen::VectorXd x, z;
    Linearised there;
    bool known = false;
    bool is(const Eigen::VectorXd& at_x, const Eigen::VectorXd& at_z) const { return known && x == at_x && z == at_z; }
  };
  const Linearised& make(Point& point, const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives);

  Prediction prediction;
  Point plain, sloped, ahead;  ///< ahead: with derivatives, which nobody has asked for yet
  bool accepts = false;        ///< was the last point that was tried accepted?
};
}  // namespace tendonlab::identify
