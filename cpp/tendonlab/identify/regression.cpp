#include "tendonlab/identify/regression.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace tendonlab::identify {
namespace {
constexpr double CLOSE = 1e-4;   // step, relative to 1 + |x|, that ends the search
constexpr double LONGEST = 1.0;  // step in the logarithm of an unknown
constexpr double RIDGE = 1e-10;
constexpr double TINY = 1e-6;  // of its own size: no equation is satisfied better than this
constexpr int LEVEL_STEPS = 3;

class Search {
 public:
  Search(const Regression& regression, const Eigen::VectorXd& level) : of(regression) {
    found.x = Eigen::VectorXd::Zero(unknowns());
    found.level = level;
    found.weight.resize(of.residual.rows(), of.residual.cols());
    move();
  }
  Regressed run(int steps) {
    found.information = beliefs().asDiagonal();
    for (int k = 0; k < steps; ++k) {
      linearise();
      found.finite = found.information.allFinite() && gradient.allFinite();
      if (!found.finite) break;
      const Eigen::VectorXd by = step();
      found.x += by;
      move();
      if ((by.array().abs() < CLOSE * (1.0 + found.x.array().abs())).all()) break;
    }
    return std::move(found);
  }

 private:
  Eigen::Index unknowns() const { return of.columns.rows(); }
  const Unknown& unknown(Eigen::Index i) const { return of.unknowns[static_cast<std::size_t>(i)]; }
  Eigen::VectorXd beliefs() const {
    return Eigen::VectorXd::NullaryExpr(unknowns(), [&](Eigen::Index i) { return unknown(i).belief; });
  }
  /// The residual at x, its scale in each equation and the weight of each sample.
  void move() {
    const Eigen::RowVectorXd amount = Eigen::RowVectorXd::NullaryExpr(
        unknowns(), [&](Eigen::Index i) { return unknown(i).logarithm ? std::expm1(found.x[i]) : found.x[i]; });
    found.residual = of.residual;
    flat(found.residual).noalias() += amount * of.columns;
    for (Eigen::Index e = 0; e < found.residual.rows(); ++e) {
      const Eigen::ArrayXd square = found.residual.row(e).array().square();
      double& level = found.level[e];
      for (int k = 0; k < LEVEL_STEPS; ++k) {
        level = std::max(level, TINY);
        found.weight.row(e).array() =
            ((Regression::freedom + 1.0) / (Regression::freedom + square / (level * level))).transpose();
        level = std::sqrt((found.weight.row(e).array() * square.transpose()).mean());
      }
      level = std::max(level, TINY);
    }
  }
  void linearise() {
    RowMatrix root = found.weight;
    for (Eigen::Index e = 0; e < root.rows(); ++e)
      root.row(e).array() = (root.row(e).array() * (of.share[e] / (found.level[e] * found.level[e]))).sqrt();
    const RowMatrix left = found.residual.cwiseProduct(root);
    rows = of.columns.array().rowwise() * flat(root).array();
    for (Eigen::Index i = 0; i < unknowns(); ++i)
      if (unknown(i).logarithm) rows.row(i) *= std::exp(found.x[i]);
    const Eigen::VectorXd belief = beliefs();
    found.information = belief.asDiagonal();
    found.information.noalias() += rows * rows.transpose();
    gradient = belief.cwiseProduct(found.x);
    gradient.noalias() += rows * Eigen::Map<const Eigen::VectorXd>(left.data(), left.size());
  }
  /// Unknowns that would become negative and cannot are held at 0.
  Eigen::VectorXd step() const {
    Eigen::MatrixXd information = found.information;
    information.diagonal().array() += RIDGE * (information.diagonal().array() + 1.0);
    std::vector<bool> held(static_cast<std::size_t>(unknowns()), false);
    for (;;) {
      std::vector<Eigen::Index> free;
      Eigen::VectorXd by = Eigen::VectorXd::Zero(unknowns());
      for (Eigen::Index i = 0; i < unknowns(); ++i)
        if (held[static_cast<std::size_t>(i)])
          by[i] = -found.x[i];
        else
          free.push_back(i);
      const Eigen::VectorXd right = -(gradient + information * by);
      by(free) = information(free, free).llt().solve(right(free)).eval();
      bool below = false;
      for (const Eigen::Index i : free)
        if (unknown(i).positive && found.x[i] + by[i] < 0.0) held[static_cast<std::size_t>(i)] = below = true;
      if (below) continue;
      for (Eigen::Index i = 0; i < unknowns(); ++i)
        if (unknown(i).logarithm) by[i] = std::min(LONGEST, std::max(-LONGEST, by[i]));
      return by;
    }
  }
  static Eigen::Map<Eigen::RowVectorXd> flat(RowMatrix& of) { return {of.data(), of.size()}; }

  const Regression& of;
  Regressed found;
  RowMatrix rows;
  Eigen::VectorXd gradient;
};
}  // namespace

Regressed regress(const Regression& of, const Eigen::VectorXd& level, int steps) {
  return Search(of, level).run(steps);
}
}  // namespace tendonlab::identify
