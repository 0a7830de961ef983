#include "tendonlab/identify/random_effect.hpp"

#include <Eigen/Jacobi>
#include <cmath>

#include "tendonlab/core/error.hpp"

namespace tendonlab::identify {
namespace {
/// Turns a small symmetric matrix into a diagonal one, V' A V, by Jacobi's rotations; returns V. Eigen's own solver
/// takes ten times as long to compile.
Eigen::MatrixXd diagonalise(Eigen::MatrixXd& a) {
  const Eigen::Index n = a.rows();
  Eigen::MatrixXd vectors = Eigen::MatrixXd::Identity(n, n);
  const double negligible = 1e-17 * a.norm();
  bool turns = true;
  for (int sweep = 0; turns && sweep < 50; ++sweep) {
    turns = false;
    for (Eigen::Index q = 1; q < n; ++q)
      for (Eigen::Index p = 0; p < q; ++p) {
        if (!(std::abs(a(p, q)) > negligible)) continue;
        turns = true;
        Eigen::JacobiRotation<double> turn;
        turn.makeJacobi(a, p, q);
        a.applyOnTheLeft(p, q, turn.adjoint());
        a.applyOnTheRight(p, q, turn);
        a(p, q) = a(q, p) = 0.0;
        vectors.applyOnTheRight(p, q, turn);
      }
  }
  return vectors;
}
}  // namespace

RandomEffect::RandomEffect(const Eigen::Ref<const Eigen::MatrixXd>& directions) : basis(directions) {
  if (directions.cols() == 0) return;
  if (!directions.allFinite()) throw ParameterError("directions: not finite; expected finite numbers");
  Eigen::MatrixXd gram = directions.transpose() * directions;
  basis = directions * diagonalise(gram);
  const Eigen::ArrayXd square = gram.diagonal().array().max(0.0);
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
