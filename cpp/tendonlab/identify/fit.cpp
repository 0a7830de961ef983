#include "tendonlab/identify/fit.hpp"

#include <ceres/ceres.h>
#include <ceres/normal_prior.h>
#if __has_include(<glog/logging.h>)
#include <glog/logging.h>
#endif

#include <algorithm>
#include <cmath>
#include <exception>

#include "tendonlab/core/error.hpp"
#include "tendonlab/identify/task_cost.hpp"

namespace tendonlab::identify {
namespace {
constexpr int along_bounds = 3, most_rounds = 10;  ///< steps along the same bounds that make a crawl; solves of a fit
constexpr double largest = 700.0;                  ///< logarithm beyond which no double follows
using Vector = Eigen::VectorXd;

/// Those of the free states, a stretch a task, in one piece of memory: Ceres sums over blocks in the order of their
/// addresses, and the same fit shall give the same bits.
class Coordinates {
 public:
  void append(const Vector& task) {
    const auto old = all.size();
    all.conservativeResize(old + task.size());
    all.tail(task.size()) = task;
    ends.push_back(all.size());
  }
  std::size_t size() const { return ends.size(); }
  Eigen::Map<Vector> operator[](std::size_t task) { return {all.data() + begin(task), ends[task] - begin(task)}; }
  Eigen::Map<const Vector> operator[](std::size_t task) const {
    return {all.data() + begin(task), ends[task] - begin(task)};
  }

 private:
  Eigen::Index begin(std::size_t task) const { return task == 0 ? 0 : ends[task - 1]; }
  Vector all;
  std::vector<Eigen::Index> ends;
};

/// Coordinates, by number.
using Places = std::vector<int>;

/// Those that lie on a bound: on its lower one for side -1, on its upper one for +1, on either for 0.
Places on_bound(const Problem& problem, const Vector& x, int side = 0) {
  Places on;
  for (std::size_t k = 0; k < problem.free.size(); ++k) {
    const Free& free = problem.free[k];
    const auto touches = [&](double bound) {
      return std::isfinite(bound) &&
             std::fabs(x(static_cast<Eigen::Index>(k)) - bound) <= 1e-9 * (1 + std::fabs(bound));
    };
    if ((side <= 0 && touches(free.coordinate(free.lower))) || (side >= 0 && touches(free.coordinate(free.upper))))
      on.push_back(static_cast<int>(k));
  }
  return on;
}

/// Keeps the best point, which Ceres forgets when a solve fails, and stops a solve that was cancelled, that moves along
/// the same bounds, other than the `fixed` ones, for `patience` steps, or that is too slow to reach the goal. `done`:
/// iterations of earlier solves.
class Watch final : public ceres::IterationCallback {
 public:
  Watch(const Problem& fitted, const Options& given, const Vector& free, const Coordinates& states, Tally& summed,
        const Places& fixed, int steps, int before)
      : problem(fitted),
        options(given),
        tally(summed),
        x(free),
        z(states),
        held(fixed),
        best_x(free),
        best_z(states),
        patience(steps),
        done(before) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (iteration.step_is_successful) {
      best_x = x, best_z = z;
      const Places now = on_bound(problem, x);
      along = now == bounds && now != held ? along + 1 : 0;
      bounds = now;
      const double change = iteration.cost_change;
      const double two = progress > 0 ? progress + change : 2 * std::max(change, promised(iteration));
      hopeless = iteration.iteration > 0 && options.goal_within * two < iteration.cost - options.goal;
      progress = change;
      cost = iteration.cost;
      tally.accept(cost);
    }
    hopeless = hopeless || (done + iteration.iteration >= options.goal_within && cost > options.goal);
    iterations = iteration.iteration;
    crawls = along >= patience;
    const bool ends = crawls || hopeless || (options.cancel && options.cancel->load());
    return ends ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }
  /// What the derivatives promised of a step.
  static double promised(const ceres::IterationSummary& step) {
    return step.relative_decrease > 0 ? step.cost_change / step.relative_decrease : inf;
  }
  const Problem& problem;
  const Options& options;
  Tally& tally;
  const Vector& x;
  const Coordinates& z;
  const Places& held;
  Vector best_x;
  Coordinates best_z;
  int patience, done, along = 0, iterations = 0;
  double cost = 0, progress = 0;  ///< after the last step that lowered the cost, and by how much that did
  bool crawls = false, hopeless = false;
  Places bounds;
};

void add_priors(const Problem& problem, Vector& x, Coordinates& z, ceres::Problem& to) {
  std::vector<Eigen::Index> known;
  for (std::size_t k = 0; k < problem.free.size(); ++k)
    if (std::isfinite(problem.free[k].sd)) known.push_back(static_cast<Eigen::Index>(k));
  ceres::Matrix weight = ceres::Matrix::Zero(static_cast<Eigen::Index>(known.size()), x.size());
  Vector mean = Vector::Zero(x.size());
  for (std::size_t row = 0; row < known.size(); ++row) {
    const Free& free = problem.free[static_cast<std::size_t>(known[row])];
    weight(static_cast<Eigen::Index>(row), known[row]) = 1.0 / free.sd;
    mean(known[row]) = free.mean;
  }
  if (!known.empty()) to.AddResidualBlock(new ceres::NormalPrior(weight, mean), nullptr, x.data());
  for (std::size_t e = 0; e < z.size(); ++e)
    if (const auto n = z[e].size(); n > 0)
      to.AddResidualBlock(new ceres::NormalPrior(ceres::Matrix::Identity(n, n), Vector::Zero(n)), nullptr, z[e].data());
}

void add_bounds(const Problem& problem, Vector& x, ceres::Problem& to) {
  for (std::size_t k = 0; k < problem.free.size(); ++k) {
    const Free& free = problem.free[k];
    const double lower = free.coordinate(free.lower), upper = free.coordinate(free.upper);
    if (std::isfinite(lower)) to.SetParameterLowerBound(x.data(), static_cast<int>(k), lower);
    if (std::isfinite(upper)) to.SetParameterUpperBound(x.data(), static_cast<int>(k), upper);
  }
}

ceres::Solver::Options solver_options(const Options& options, Vector& x, Coordinates& z) {
  ceres::Solver::Options with;
  with.max_num_iterations = options.max_iterations;
  with.function_tolerance = options.tolerance;
  with.parameter_tolerance = options.tolerance;
  with.gradient_tolerance = 1e-12;
  with.line_search_interpolation_type = ceres::QUADRATIC;  // a cubic one needs derivatives wherever a step ends
  with.max_num_line_search_step_size_iterations = 1;       // where that does not help, a smaller trust region does
  with.num_threads = 1;                                    // same bits; callers run several fits at once
  with.logging_type = ceres::SILENT;
  with.update_state_every_iteration = true;  // for Watch
  with.linear_solver_type = ceres::DENSE_QR;
  auto order = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t e = 0; e < z.size(); ++e)
    if (z[e].size() > 0) {
      order->AddElementToGroup(z[e].data(), 0);  // each couples only to x: eliminated first
      with.linear_solver_type = ceres::DENSE_SCHUR;
    }
  if (x.size() > 0) order->AddElementToGroup(x.data(), 1);
  if (with.linear_solver_type == ceres::DENSE_SCHUR && x.size() > 0) with.linear_solver_ordering = order;
  if (x.size() == 0) with.linear_solver_type = ceres::DENSE_QR;
  return with;
}

void silence_log() {
#if __has_include(<glog/logging.h>) && !defined(CERCES_INTERNAL_MINIGLOG_GLOG_LOGGING_H_)
  FLAGS_minloglevel = google::GLOG_FATAL;  // a library writes nothing to stderr; what happened is in the result
#endif
}

std::string words(const std::exception_ptr& thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

void tell(const ceres::Solver::Summary& summary, const Options& options, const std::exception_ptr& thrown, Result& of) {
  of.converged = summary.termination_type == ceres::CONVERGENCE;
  if (options.cancel && options.cancel->load())
    of.converged = false, of.message = "cancelled";
  else if (of.converged)
    of.message = "converged";
  else if (summary.termination_type == ceres::NO_CONVERGENCE || summary.termination_type == ceres::USER_SUCCESS)
    of.message = sentence("stopped after ", of.iterations, " iterations while the cost was still falling");
  else
    of.message = thrown ? "stopped where simulations fail: " + words(thrown) : "stopped: " + summary.message;
}

void require_sound(const Problem& problem) {
  const std::size_t count = problem.configuration.values.size();
  if (problem.tasks.empty()) throw ParameterError("tasks: none; expected at least one experiment");
  for (const Free& free : problem.free) {
    if (free.index >= count)
      throw ParameterError(sentence("free index = ", free.index, ": expected less than ", count));
    const std::string& name = free.name;
    require_within("scale of " + name, free.scale, 1e-300, 1e300);
    if (!(free.sd > 0)) throw ParameterError(sentence("prior sd of ", name, " = ", free.sd, ": expected more than 0"));
    if (std::isfinite(free.sd)) require_within("prior mean of " + name, free.mean, -1e300, 1e300);
    if (!(free.lower < free.upper))
      throw ParameterError(
          sentence("bounds of ", name, " = [", free.lower, ", ", free.upper, "]: expected lower < upper"));
    require_within("start of " + name, free.start, free.lower, free.upper);
    if (free.log && !(free.start > 0))
      throw ParameterError(
          sentence("start of ", name, " = ", free.start, ": expected more than 0 for a log coordinate"));
  }
  if (!problem.initial.empty() && problem.initial.size() != problem.tasks.size())
    throw ParameterError(
        sentence("initial states of ", problem.initial.size(), " tasks: expected ", problem.tasks.size()));
}

Vector start_of_free(const Problem& problem) {
  Vector x(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t k = 0; k < problem.free.size(); ++k)
    x(static_cast<Eigen::Index>(k)) = problem.free[k].coordinate(problem.free[k].start);
  return x;
}
using Predictions = std::vector<Remembered>;
Predictions predictions_of(const Problem& problem) {
  Predictions all;
  for (std::size_t e = 0; e < problem.tasks.size(); ++e) all.emplace_back(problem, e);
  return all;
}
Coordinates start_of_states(const Problem& problem, const Predictions& predictions) {
  Coordinates z;
  for (std::size_t e = 0; e < problem.tasks.size(); ++e) {
    const Prediction& of = predictions[e].of();
    z.append(problem.initial.empty() ? Vector(Vector::Zero(of.num_initial())) : of.coordinates(problem.initial[e]));
  }
  return z;
}

/// Everything about the point (x, z) that a caller asks for.
Result describe(const Problem& problem, Predictions& predictions, const Vector& x, const Coordinates& z) {
  Result of;
  of.at_bound.assign(problem.free.size(), false);
  for (const int k : on_bound(problem, x)) of.at_bound[static_cast<std::size_t>(k)] = true;
  of.values = problem.configuration.values;
  of.x.assign(x.data(), x.data() + x.size());
  for (std::size_t k = 0; k < problem.free.size(); ++k) {
    const Free& free = problem.free[k];
    const double at = of.x[k];
    of.values[free.index] = free.value(at);
    if (std::isfinite(free.sd)) of.prior_cost += 0.5 * std::pow((at - free.mean) / free.sd, 2);
  }
  of.cost = of.prior_cost;
  for (std::size_t e = 0; e < problem.tasks.size(); ++e) {
    of.tasks.push_back(predictions[e].at(x, z[e], true));
    of.initial.push_back(predictions[e].of().states(z[e]));
    of.prior_cost += 0.5 * z[e].squaredNorm();
    of.cost += 0.5 * (z[e].squaredNorm() + of.tasks.back().residual().squaredNorm());
  }
  return of;
}

/// The coordinates that are kept on a bound because the cost falls beyond it.
Places pressed(const Problem& problem, const Vector& x, const Result& at) {
  Places against;
  for (const int side : {-1, 1})
    for (const int k : on_bound(problem, x, side)) {
      const Free& free = problem.free[static_cast<std::size_t>(k)];
      double slope = std::isfinite(free.sd) ? (x(k) - free.mean) / (free.sd * free.sd) : 0.0;
      for (const Linearised& task : at.tasks) slope += task.products(k, task.products.cols() - 1);
      if (side * slope < 0) against.push_back(k);
    }
  std::sort(against.begin(), against.end());
  return against;
}
/// Fixes the coordinates `held`, and none else.
void hold(const Places& held, Vector& x, ceres::Problem& in) {
  if (x.size() == 0) return;
  in.SetParameterBlockVariable(x.data());
  in.SetManifold(x.data(), nullptr);
  if (static_cast<Eigen::Index>(held.size()) == x.size())
    in.SetParameterBlockConstant(x.data());
  else if (!held.empty())
    in.SetManifold(x.data(), new ceres::SubsetManifold(static_cast<int>(x.size()), held));
}
/// Solves to the end. Ceres projects its steps on the bounds and crawls along them: what is pressed against one is
/// fixed there while the rest is fitted, until nothing wants to move.
Result settle(const Problem& problem, Predictions& predictions, const Options& options, ceres::Problem& solved,
              Vector& x, Coordinates& z, Tally& tally, const std::exception_ptr& thrown) {
  Places held;
  int done = 0, patience = along_bounds;
  for (int round = 1;; ++round) {
    hold(held, x, solved);
    auto with = solver_options(options, x, z);
    with.max_num_iterations = options.max_iterations - done;
    Watch watch(problem, options, x, z, tally, held, patience, done);
    with.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(with, &solved, &summary);
    x = watch.best_x, z = watch.best_z, done += watch.iterations;
    Result of = describe(problem, predictions, x, z);
    const Places against = pressed(problem, x, of);
    const bool ends = done >= options.max_iterations || watch.hopeless || round == most_rounds ||
                      summary.termination_type == ceres::FAILURE || (options.cancel && options.cancel->load());
    if (ends || (against == held && !watch.crawls)) {
      of.iterations = done;
      tell(summary, options, thrown, of);
      return of;
    }
    if (against == held) patience = options.max_iterations + 1;  // along bounds, but not pressed against more of them
    held = against;
  }
}
}  // namespace

double Free::value(double x) const {
  return std::min(std::max(scale * (log ? std::exp(std::min(x, largest)) : x), lower), upper);
}
double Free::coordinate(double value) const {
  if (!log) return value / scale;
  return value > 0 ? std::log(value / scale) : -inf;
}
double Free::slope(double x) const {
  return log ? scale * std::exp(std::min(x, largest)) : scale;
}
Free Free::started(double value) const {
  Free other = *this;
  const double least = log ? std::max(lower, scale * std::exp(-largest)) : lower;
  other.start = std::min(std::max(value, least), upper);
  return other;
}

Result linearise(const Problem& problem) {
  require_sound(problem);
  Predictions predictions = predictions_of(problem);
  return describe(problem, predictions, start_of_free(problem), start_of_states(problem, predictions));
}

Result fit(const Problem& problem, const Options& options) {
  require_sound(problem);
  require_within("max_iterations", options.max_iterations, 0, 1e6);
  require_within("tolerance", options.tolerance, 1e-15, 1.0);
  Predictions predictions = predictions_of(problem);
  Vector x = start_of_free(problem);
  Coordinates z = start_of_states(problem, predictions);
  for (std::size_t e = 0; e < problem.tasks.size(); ++e) predictions[e].at(x, z[e], true);  // throws at the start
  Tally tally(problem.tasks.size());
  std::exception_ptr thrown;
  ceres::Problem solved;
  for (std::size_t e = 0; e < problem.tasks.size(); ++e) {
    std::vector<double*> blocks;
    if (x.size() > 0) blocks.push_back(x.data());
    if (z[e].size() > 0) blocks.push_back(z[e].data());
    if (blocks.empty()) continue;  // nothing moves this experiment
    solved.AddResidualBlock(new TaskCost(predictions[e], options.cancel, thrown, tally, e), nullptr, blocks);
  }
  if (solved.NumResidualBlocks() == 0)
    throw ParameterError("free: none; expected at least one free parameter or initial state");
  add_priors(problem, x, z, solved);
  add_bounds(problem, x, solved);
  silence_log();
  return settle(problem, predictions, options, solved, x, z, tally, thrown);
}
}  // namespace tendonlab::identify
