#include "tendonlab/identify/predict.hpp"

#include <cmath>
#include <utility>

#include "tendonlab/core/columns.hpp"
#include "tendonlab/core/error.hpp"

namespace tendonlab::identify {
namespace {
using Of = integrate::Seed::Of;

void require_sound(const Problem& problem, const Task& task) {
  const SystemInfo& info = problem.model.info();
  const auto& time = task.experiment->time;
  if (task.whitening->channels() != static_cast<Eigen::Index>(info.outputs.size()) ||
      task.whitening->samples() != static_cast<Eigen::Index>(time.size()))
    throw ParameterError(sentence("whitening of (", task.whitening->channels(), ", ", task.whitening->samples(),
                                  ") measurements: expected (", info.outputs.size(), ", ", time.size(),
                                  "), outputs of ", info.kind, " and samples of the experiment"));
  for (const auto* conditions : {&task.fixed, &task.added})
    for (const auto& [index, value] : *conditions) {
      if (index >= info.parameters.size())
        throw ParameterError(
            sentence("condition on parameter ", index, ": expected less than ", info.parameters.size()));
      require_within("condition on " + info.parameters[index].name, value, -1e300, 1e300);
    }
  for (const FreeState& state : task.initial) {
    require_within("sd of an initial state", state.sd, 1e-300, 1e300);
    const auto count = state.seed.of == Of::parameter ? 0 : numbers_of(state.seed.of, *task.experiment).size();
    if (state.seed.index < 0 || static_cast<std::size_t>(state.seed.index) >= count)
      throw ParameterError(sentence("initial state ", state.seed.index, ": expected one of ", count,
                                    ", a position, a velocity or a reading"));
  }
  for (const Scatter& group : task.scatter) {
    require_within("sd of scatter", group.sd, 1e-300, 10.0);
    for (const std::size_t index : group.parameters)
      if (index >= info.parameters.size())
        throw ParameterError(sentence("scatter of parameter ", index, ": expected less than ", info.parameters.size()));
  }
}
bool fixes(const Task& task, std::size_t index) {
  for (const auto& condition : task.fixed)
    if (condition.first == index) return true;
  return false;
}
double& component(integrate::Experiment& of, const integrate::Seed& seed) {
  return numbers_of(seed.of, of)[static_cast<std::size_t>(seed.index)];
}
}  // namespace

Prediction::Prediction(const Problem& of, std::size_t index)
    : problem(of), task(of.tasks[index]), settings(of.settings) {
  require_sound(problem, task);
  settings.outputs = 0;
  for (std::size_t c = 0; c < problem.model.info().outputs.size(); ++c)
    if (task.whitening->scores(c)) settings.outputs |= 1u << c;
  const auto differentiate = [&](std::size_t parameter) {
    column_of.emplace_back(parameter, static_cast<Eigen::Index>(seeds.size()));
    seeds.push_back({Of::parameter, static_cast<int>(parameter)});
  };
  for (std::size_t k = 0; k < problem.free.size(); ++k)
    if (!fixes(task, problem.free[k].index)) {
      moving.push_back(k);
      differentiate(problem.free[k].index);
    }
  for (const FreeState& state : task.initial) seeds.push_back(state.seed);
  for (const Scatter& group : task.scatter)
    for (const std::size_t parameter : group.parameters)
      if (column(parameter) < 0) differentiate(parameter);
}

Eigen::Index Prediction::column(std::size_t parameter) const {
  for (const auto& [known, at] : column_of)
    if (known == parameter) return at;
  return -1;
}
double Prediction::prior_mean(std::size_t own) const {
  if (own >= task.initial.size()) return 0.0;
  const integrate::Seed& seed = task.initial[own].seed;
  return numbers_of(seed.of, *task.experiment)[static_cast<std::size_t>(seed.index)];
}
double Prediction::prior_sd(std::size_t own) const {
  return own < task.initial.size() ? task.initial[own].sd : task.scatter[own - task.initial.size()].sd;
}
std::vector<double> Prediction::states(const Eigen::VectorXd& z) const {
  std::vector<double> all;
  for (Eigen::Index k = 0; k < num_initial(); ++k) {
    const auto own = static_cast<std::size_t>(k);
    all.push_back(prior_mean(own) + prior_sd(own) * z(k));
  }
  return all;
}
Eigen::VectorXd Prediction::coordinates(const std::vector<double>& states) const {
  Eigen::VectorXd z(num_initial());
  if (static_cast<Eigen::Index>(states.size()) != z.size())
    throw ParameterError(sentence(states.size(), " initial values: expected ", z.size(),
                                  ", the states and factors that the task frees"));
  for (std::size_t k = 0; k < states.size(); ++k) {
    require_within("initial value", states[k], -1e300, 1e300);
    z(static_cast<Eigen::Index>(k)) = (states[k] - prior_mean(k)) / prior_sd(k);
  }
  return z;
}

double Prediction::factor(std::size_t parameter, const Eigen::VectorXd& z) const {
  double logarithm = 0;
  for (std::size_t g = 0; g < task.scatter.size(); ++g)
    for (const std::size_t one : task.scatter[g].parameters)
      if (one == parameter) logarithm += task.scatter[g].sd * z(static_cast<Eigen::Index>(task.initial.size() + g));
  return std::exp(logarithm);
}
Configuration Prediction::configuration_at(const Eigen::VectorXd& x, const Eigen::VectorXd& z) const {
  Configuration with = problem.configuration;
  for (Eigen::Index k = 0; k < num_free(); ++k) {
    const Free& free = problem.free[static_cast<std::size_t>(k)];
    with.values[free.index] = free.value(x(k));
  }
  for (const auto& [index, value] : task.fixed) with.values[index] = value;
  for (const auto& [index, value] : task.added) with.values[index] += value;
  const auto& parameters = problem.model.info().parameters;
  for (std::size_t i = 0; i < with.values.size(); ++i) {
    if (!task.scatter.empty()) with.values[i] *= factor(i, z);
    require_within(parameters[i].name, with.values[i], parameters[i].lower, parameters[i].upper);
  }
  return with;
}
integrate::Experiment Prediction::experiment_at(const Eigen::VectorXd& z) const {
  integrate::Experiment experiment = *task.experiment;
  const auto wanted = states(z);
  for (std::size_t k = 0; k < task.initial.size(); ++k) component(experiment, task.initial[k].seed) = wanted[k];
  return experiment;
}

void Prediction::differentiate(const integrate::Trajectory& run, const Configuration& with, const Eigen::VectorXd& x,
                               const Eigen::VectorXd& z, Linearised& out) const {
  const auto filtered = [&](Eigen::Index seed, double factor, Eigen::Ref<Eigen::VectorXd> into) {
    const double* from = run.gradient.data() + seed * run.channels * run.samples;
    task.whitening->filter(Eigen::Map<const RowMatrix>(from, run.channels, run.samples), into, factor);
  };
  Eigen::Index seed = 0;
  if (moving.size() < problem.free.size()) out.columns.leftCols(num_free()).setZero();  // what a condition fixes
  for (const std::size_t k : moving) {
    const Free& free = problem.free[k];
    const auto c = static_cast<Eigen::Index>(k);
    filtered(seed++, free.slope(x(c)) * factor(free.index, z), out.columns.col(c));
  }
  Eigen::Index own = num_free();
  for (const FreeState& state : task.initial) filtered(seed++, state.sd, out.columns.col(own++));
  Eigen::VectorXd part(task.scatter.empty() ? 0 : out.columns.rows());
  for (const Scatter& group : task.scatter) {
    auto by_factor = out.columns.col(own++);
    by_factor.setZero();
    for (const std::size_t p : group.parameters) {
      filtered(column(p), group.sd * with.values[p], part);
      by_factor += part;
    }
  }
  task.whitening->shrink(out.columns.leftCols(own));
}

Linearised Prediction::at(const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives) const {
  const Configuration with = configuration_at(x, z);
  const auto run = problem.model.simulate(with, experiment_at(z),
                                          with_derivatives ? seeds : std::vector<integrate::Seed>(), settings);
  Linearised out;
  out.num_free = with_derivatives ? num_free() : 0;
  const Eigen::Index rows = task.whitening->rows(), all = with_derivatives ? num_free() + num_initial() + 1 : 1;
  out.columns.resize(rows, all);
  out.columns.rightCols<1>() =
      task.whitening->residual(Eigen::Map<const RowMatrix>(run.value.data(), run.channels, run.samples));
  bool finite = true;
  if (with_derivatives) {
    differentiate(run, with, x, z, out);
    out.products.resize(all, all);
    multiply_columns(out.columns.data(), static_cast<std::size_t>(rows), static_cast<std::size_t>(all),
                     out.products.data());
    finite = out.products.diagonal().allFinite();
  } else {
    finite = out.columns.allFinite();
  }
  if (!finite)
    throw NumericalError(sentence(problem.model.info().kind,
                                  ": outputs or their derivatives are not finite; a parameter ",
                                  "may be far from its data, or the tolerance too large"));
  return out;
}

const Linearised& Remembered::make(Point& point, const Eigen::VectorXd& x, const Eigen::VectorXd& z,
                                   bool with_derivatives) {
  point.known = false;
  point.there = prediction.at(x, z, with_derivatives);
  point.x = x, point.z = z, point.known = true;
  return point.there;
}

const Linearised& Remembered::at(const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives) {
  if (with_derivatives) {
    if (ahead.is(x, z)) std::swap(ahead, sloped);
    accepts = true;
    return sloped.is(x, z) ? sloped.there : make(sloped, x, z, true);
  }
  for (const Point* point : {&sloped, &ahead, &plain})
    if (point->is(x, z)) return point->there;
  if (std::exchange(accepts, false) && prediction.takes_one_simulation()) {
    try {
      return make(ahead, x, z, true);
    } catch (const NumericalError&) {  // the residuals may have a value where their derivatives explode
    }
  }
  return make(plain, x, z, false);
}
}  // namespace tendonlab::identify
