#pragma once
// An experiment of a fit, as Ceres sees it.
#include <ceres/cost_function.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <vector>

#include "tendonlab/identify/predict.hpp"

namespace tendonlab::identify {
/// A square matrix R of these products, R'R: a Cholesky factor with pivots, by rows. Columns that depend on others but
/// for rounding give a row of 0. The last column comes last: what is left of it gives the last row.
inline RowMatrix rows_with(Eigen::MatrixXd products) {
  constexpr double rounding = 1e-14;
  const Eigen::Index last = products.cols() - 1;
  RowMatrix rows = RowMatrix::Zero(last + 1, last + 1);
  const Eigen::VectorXd size = products.diagonal().cwiseSqrt();
  const Eigen::VectorXd unit = size.unaryExpr([](double x) { return x > 0 ? 1.0 / x : 0.0; });
  products = unit.asDiagonal() * products * unit.asDiagonal();
  for (Eigen::Index row = 0; row < last; ++row) {
    Eigen::Index pivot = 0;
    const double left = products.diagonal().head(last).maxCoeff(&pivot);
    if (!(left > rounding)) break;
    rows.row(row) = products.row(pivot) / std::sqrt(left);
    products -= rows.row(row).transpose() * rows.row(row);
    products(pivot, pivot) = 0.0;
  }
  rows(last, last) = std::sqrt(std::max(0.0, products(last, last)));
  return rows * size.asDiagonal();
}

/// The cost of a point as Ceres sums it up, experiment by experiment. Where a part of it exceeds by far what a step may
/// cost, the step is rejected whatever the rest costs: that need not be simulated.
class Tally {
 public:
  explicit Tally(std::size_t num_tasks) : seen(num_tasks, false) {}
  /// A step was accepted: others may cost less.
  void accept(double cost) { most = far * cost; }
  /// Task e comes next. The same one again begins another point; Ceres may leave out tasks that nothing moves.
  void begin(std::size_t e) {
    if (seen[e]) restart();
    seen[e] = true;
  }
  bool is_lost() const { return sum > most; }
  void add(double square) { sum += 0.5 * square; }
  void restart() { sum = 0, seen.assign(seen.size(), false); }

 private:
  static constexpr double far = 2.0;  ///< times the cost: no interpolation along a step makes up for that
  std::vector<bool> seen;
  double sum = 0, most = std::numeric_limits<double>::infinity();
};

/// Hands one experiment to Ceres: as few rows as it has columns, of which all products are those of its thousands of
/// samples. No exception may cross it: the first one is kept, and told after the solve.
class TaskCost final : public ceres::CostFunction {
 public:
  TaskCost(Remembered& predicted, const Cancel* stop, std::exception_ptr& first, Tally& summed, std::size_t own)
      : prediction(predicted), cancel(stop), thrown(first), tally(summed), index(own) {
    const Prediction& of = prediction.of();
    set_num_residuals(static_cast<int>(of.num_free() + of.num_initial() + 1));
    if (of.num_free() > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(of.num_free()));
    if (of.num_initial() > 0) mutable_parameter_block_sizes()->push_back(static_cast<int>(of.num_initial()));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    if (cancel && cancel->load()) return false;
    Eigen::Map<Eigen::VectorXd> residual(residuals, num_residuals());
    tally.begin(index);
    if (!jacobians && tally.is_lost()) {
      residual.setZero();
      return true;
    }
    try {
      const Prediction& of = prediction.of();
      const std::size_t free_blocks = of.num_free() > 0 ? 1 : 0;
      const auto view = [&](std::size_t block, Eigen::Index size) {
        return size > 0 ? Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(blocks[block], size)) : Eigen::VectorXd();
      };
      const Linearised& at =
          prediction.at(view(0, of.num_free()), view(free_blocks, of.num_initial()), jacobians != nullptr);
      tally.add(at.residual().squaredNorm());
      if (!jacobians) {
        residual.setZero();
        residual(0) = at.residual().norm();
        return true;
      }
      const RowMatrix rows = rows_with(at.products);
      residual = rows.rightCols<1>();
      const auto fill = [&](std::size_t block, Eigen::Index first, Eigen::Index count) {
        if (count > 0 && jacobians[block])
          Eigen::Map<RowMatrix>(jacobians[block], rows.rows(), count) = rows.middleCols(first, count);
      };
      fill(0, 0, of.num_free());
      fill(free_blocks, of.num_free(), of.num_initial());
      return true;
    } catch (...) {
      if (!thrown) thrown = std::current_exception();
      tally.restart();
      return false;
    }
  }

 private:
  Remembered& prediction;
  const Cancel* cancel;
  std::exception_ptr& thrown;
  Tally& tally;
  std::size_t index;
};

}  // namespace tendonlab::identify
