#include "tendonlab/identify/random_effect.hpp"

#include <Eigen/Eigenvalues>

#include "tendonlab/core/error.hpp"

namespace tendonlab::identify {
RandomEffect::RandomEffect(const Eigen::Ref<const Eigen::MatrixXd>& directions) : basis(directions) {
  if (directions.cols() == 0) return;
  if (!directions.allFinite()) throw ParameterError("directions: not finite; expected finite numbers");
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gram(directions.transpose() * directions);
  basis = directions * gram.eigenvectors();
  const Eigen::ArrayXd square = gram.eigenvalues().array().max(0.0);
  const Eigen::ArrayXd root = (1.0 + square).sqrt();
  gain = -1.0 / (root * (1.0 + root));  // (1/root - 1) / s^2, finite where s = 0
  log_volume = square.log1p().sum();
}

void RandomEffect::whiten(Eigen::Ref<Eigen::MatrixXd> columns) const {
  if (gain.size() == 0) return;
  const Eigen::MatrixXd along = gain.asDiagonal() * (basis.transpose() * columns);
  columns.noalias() += basis * along;
}
}  // namespace tendonlab::identify
