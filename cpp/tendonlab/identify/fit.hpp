#pragma once
// The output-error fit: whitened residuals of simulated experiments and normal priors, minimised over bounds.
#include <atomic>
#include <memory>
#include <utility>

#include "tendonlab/identify/whitening.hpp"
#include "tendonlab/models/model.hpp"

namespace tendonlab::identify {
/// A parameter that is fitted, through the coordinate x = log(value / scale) or value / scale.
struct Free {
  std::string name;
  std::size_t index;  ///< into SystemInfo::parameters
  bool log;
  double scale;         ///< unit of the coordinate, > 0
  double start;         ///< value, not coordinate
  double mean, sd;      ///< normal prior of the coordinate x; infinite sd: none
  double lower, upper;  ///< bounds of the value

  double value(double x) const;  ///< within the bounds
  double coordinate(double value) const;
  double slope(double x) const;  ///< d value / d x
  /// The same, started at the value inside the bounds that is nearest. A logarithm starts at no 0, to which a long step
  /// of a fit may go.
  Free started(double value) const;
};

/// A part of the initial state that is fitted, in one experiment; prior: normal about the experiment's own value.
struct FreeState {
  integrate::Seed seed;
  double sd;  ///< m (rad) or m/s (rad/s), finite; the coordinate is (value - prior mean) / sd
};

/// Parameters that differ by a common factor from run to run, exp(sd z): friction is never twice the same.
struct Scatter {
  std::vector<std::size_t> parameters;
  double sd;  ///< of the factor's logarithm, finite; the coordinate is logarithm / sd
};

/// One experiment of the fit. Conditions: parameters `fixed` there, or larger there by what is `added`. Its own
/// unknowns: the free states, then the factors.
struct Task {
  std::shared_ptr<const integrate::Experiment> experiment;
  std::shared_ptr<const Whitening> whitening;
  std::vector<std::pair<std::size_t, double>> fixed, added;
  std::vector<FreeState> initial;
  std::vector<Scatter> scatter;
};

using Cancel = std::atomic<bool>;

/// What is fitted. `initial`: starting values of each task's own unknowns, states and logarithms of factors; empty:
/// their prior means.
struct Problem {
  const Model& model;
  Configuration configuration;
  std::vector<Task> tasks;
  std::vector<Free> free;
  std::vector<std::vector<double>> initial;
  integrate::Settings settings;
};
struct Options {
  int max_iterations = 50;
  double tolerance = 1e-8;  ///< relative change of the cost at which the fit has converged
  const Cancel* cancel = nullptr;
  /// The cost to get below within `goal_within` iterations. A fit that does not, or would not at its pace, stops.
  double goal = inf;
  int goal_within = 1;
};

/// Residuals of one experiment in noise standard deviations, with derivatives by the coordinates.
struct Linearised {
  Eigen::MatrixXd columns;   ///< derivatives by the free parameters, by the task's own unknowns, and the residuals
  Eigen::MatrixXd products;  ///< of all columns with one another; none without derivatives
  Eigen::Index num_free = 0;

  auto residual() const { return columns.rightCols<1>(); }
  auto by_free() const { return columns.leftCols(num_free); }
  auto by_initial() const { return columns.middleCols(num_free, columns.cols() - 1 - num_free); }
};
struct Result {
  std::vector<double> values, x;             ///< all parameters; coordinates of the free ones
  std::vector<std::vector<double>> initial;  ///< own unknowns, a list a task
  double cost = 0, prior_cost = 0;           ///< half the sum of squares, priors included; the priors' part
  bool converged = false;
  std::string message;
  int iterations = 0;
  std::vector<Linearised> tasks;
  std::vector<bool> at_bound;
};

/// The problem at its start, unsolved. Throws NumericalError where a simulation fails, ParameterError if ill-posed.
Result linearise(const Problem& problem);
/// Fits. Throws as `linearise`; one that stops early returns what it has, with the reason in `message`.
Result fit(const Problem& problem, const Options& options);
}  // namespace tendonlab::identify
