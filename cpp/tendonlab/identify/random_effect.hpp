#pragma once
// Unknowns that differ from experiment to experiment and that nobody asks for: initial states, friction from run to
// run.
#include <Eigen/Core>

namespace tendonlab::identify {
/// Residuals e + V u, in which u and e are independent of unit variance, as independent rows of unit variance:
///   (I + V V')^(-1/2), never formed.
/// V: (rows, k), few columns.
class RandomEffect {
 public:
  RandomEffect() = default;
  /// Throws ParameterError unless the directions are finite.
  explicit RandomEffect(const Eigen::Ref<const Eigen::MatrixXd>& directions);

  /// Each column of (rows, m).
  void whiten(Eigen::Ref<Eigen::MatrixXd> columns) const;
  Eigen::Index rows() const { return basis.rows(); }
  /// log det(I + V V').
  double volume() const { return log_volume; }

 private:
  Eigen::MatrixXd basis;  ///< left singular vectors of V, each times its singular value s
  Eigen::VectorXd gain;   ///< (1/sqrt(1 + s^2) - 1) / s^2 for each of them
  double log_volume = 0;
};
}  // namespace tendonlab::identify
