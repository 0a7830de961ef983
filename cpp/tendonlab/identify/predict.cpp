#include "tendonlab/identify/predict.hpp"

#include <cmath>

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
      require_within("condition on " + info.parameters[index].name, value, -1e300, 1e300, "");
    }
  for (const FreeState& state : task.initial) {
    require_within("sd of an initial state", state.sd, 1e-300, 1e300, "");
    if (state.seed.of == Of::parameter || state.seed.index < 0 || state.seed.index >= info.dof)
      throw ParameterError(sentence("initial state ", state.seed.index, ": expected a position or velocity of one of ",
                                    info.dof, " degrees of freedom"));
  }
}
bool fixes(const Task& task, std::size_t index) {
  for (const auto& condition : task.fixed)
    if (condition.first == index) return true;
  return false;
}
double& component(integrate::Experiment& of, const integrate::Seed& seed) {
  return (seed.of == Of::position ? of.position : of.velocity)[static_cast<std::size_t>(seed.index)];
}
}  // namespace

Prediction::Prediction(const Problem& of, std::size_t index) : problem(of), task(of.tasks[index]) {
  require_sound(problem, task);
  for (std::size_t k = 0; k < problem.free.size(); ++k)
    if (!fixes(task, problem.free[k].index)) {
      moving.push_back(k);
      seeds.push_back({Of::parameter, static_cast<int>(problem.free[k].index)});
    }
  for (const FreeState& state : task.initial) seeds.push_back(state.seed);
}

double Prediction::prior_mean(const FreeState& state) const {
  const auto& from = state.seed.of == Of::position ? task.experiment->position : task.experiment->velocity;
  return from[static_cast<std::size_t>(state.seed.index)];
}
std::vector<double> Prediction::states(const Eigen::VectorXd& z) const {
  std::vector<double> all;
  for (std::size_t k = 0; k < task.initial.size(); ++k)
    all.push_back(prior_mean(task.initial[k]) + task.initial[k].sd * z(static_cast<Eigen::Index>(k)));
  return all;
}
Eigen::VectorXd Prediction::coordinates(const std::vector<double>& states) const {
  if (states.size() != task.initial.size())
    throw ParameterError(
        sentence(states.size(), " initial states: expected ", task.initial.size(), ", as the task frees"));
  Eigen::VectorXd z(num_initial());
  for (std::size_t k = 0; k < states.size(); ++k) {
    require_within("initial state", states[k], -1e300, 1e300, "");
    z(static_cast<Eigen::Index>(k)) = (states[k] - prior_mean(task.initial[k])) / task.initial[k].sd;
  }
  return z;
}

Configuration Prediction::configuration_at(const Eigen::VectorXd& x) const {
  Configuration with = problem.configuration;
  for (Eigen::Index k = 0; k < num_free(); ++k) {
    const Free& free = problem.free[static_cast<std::size_t>(k)];
    with.values[free.index] = free.value(x(k));
  }
  for (const auto& [index, value] : task.fixed) with.values[index] = value;
  for (const auto& [index, value] : task.added) with.values[index] += value;
  const auto& parameters = problem.model.info().parameters;
  for (std::size_t i = 0; i < with.values.size(); ++i)
    require_within(parameters[i].name, with.values[i], parameters[i].lower, parameters[i].upper, "");
  return with;
}
integrate::Experiment Prediction::experiment_at(const Eigen::VectorXd& z) const {
  integrate::Experiment experiment = *task.experiment;
  const auto wanted = states(z);
  for (std::size_t k = 0; k < wanted.size(); ++k) component(experiment, task.initial[k].seed) = wanted[k];
  return experiment;
}

Eigen::MatrixXd Prediction::whitened_gradient(const integrate::Trajectory& run) const {
  const Whitening& whitening = *task.whitening;
  Eigen::MatrixXd all(whitening.rows(), run.width);
  const Eigen::Index cells = static_cast<Eigen::Index>(run.channels) * run.samples;
  for (Eigen::Index k = 0; k < run.width; ++k)
    whitening.filter(Eigen::Map<const RowMatrix>(run.gradient.data() + k * cells, run.channels, run.samples),
                     all.col(k));
  whitening.shrink(all);
  return all;
}

Linearised Prediction::at(const Eigen::VectorXd& x, const Eigen::VectorXd& z, bool with_derivatives) const {
  const auto run = problem.model.simulate(configuration_at(x), experiment_at(z),
                                          with_derivatives ? seeds : std::vector<integrate::Seed>(), problem.settings);
  Linearised out;
  out.residual = task.whitening->residual(Eigen::Map<const RowMatrix>(run.value.data(), run.channels, run.samples));
  if (with_derivatives) {
    const Eigen::MatrixXd gradient = whitened_gradient(run);
    out.by_free = RowMatrix::Zero(out.residual.size(), num_free());
    out.by_initial.resize(out.residual.size(), num_initial());
    Eigen::Index column = 0;
    for (const std::size_t k : moving) {
      const auto to = static_cast<Eigen::Index>(k);
      out.by_free.col(to) = problem.free[k].slope(x(to)) * gradient.col(column++);
    }
    for (Eigen::Index k = 0; k < num_initial(); ++k)
      out.by_initial.col(k) = task.initial[static_cast<std::size_t>(k)].sd * gradient.col(column++);
  }
  if (!out.residual.allFinite() || !out.by_free.allFinite() || !out.by_initial.allFinite())
    throw NumericalError(sentence(problem.model.info().kind,
                                  ": outputs or their derivatives are not finite; a parameter ",
                                  "may be far from its data, or the tolerance too large"));
  return out;
}
}  // namespace tendonlab::identify
