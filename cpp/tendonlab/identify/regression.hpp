#pragma once
// Robust linear regression with beliefs: Student-t residuals, a scale per equation, unknowns with normal priors.
#include <vector>

#include "tendonlab/identify/whitening.hpp"

namespace tendonlab::identify {
/// What the regression may change from what is believed, 0 with a standard deviation of 1 / sqrt(belief).
struct Unknown {
  double belief;
  bool logarithm;  ///< its column counts exp(x) - 1 times instead of x times
  bool positive;   ///< it cannot be negative
};

/// residual + sum of columns·amounts = noise.
struct Regression {
  static constexpr double freedom = 4.0;  ///< of Student's t: outliers lose their say
  Eigen::Ref<const RowMatrix> residual;   ///< (equations, samples)
  Eigen::Ref<const RowMatrix> columns;    ///< (unknowns, equations * samples)
  std::vector<Unknown> unknowns;
  Eigen::VectorXd share;  ///< of the samples of each equation that count as independent
};

/// The most probable unknowns. Not `finite`: there are none, and nothing else counts.
struct Regressed {
  Eigen::VectorXd x, level;     ///< level: scale of the residual of each equation
  RowMatrix residual, weight;   ///< (equations, samples)
  Eigen::MatrixXd information;  ///< second derivatives of the negative log posterior at the last step
  bool finite = true;
};

/// Gauss-Newton, at most `steps`. `level`: a first guess of the scale of each residual.
Regressed regress(const Regression& of, const Eigen::VectorXd& level, int steps);
}  // namespace tendonlab::identify
