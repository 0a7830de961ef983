#include <pybind11/eigen.h>

#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/bindings/convert.hpp"
#include "tendonlab/bindings/record.hpp"
#include "tendonlab/core/error.hpp"
#include "tendonlab/identify/fit.hpp"
#include "tendonlab/identify/regression.hpp"

namespace tendonlab::bindings {
namespace {
using identify::ChannelNoise;
using identify::Free;
using identify::RowMatrix;
using identify::Task;
using identify::Whitening;
using Signals = Eigen::Ref<const RowMatrix>;
using Conditions = std::vector<std::pair<std::size_t, double>>;
using ReleaseGil = py::call_guard<py::gil_scoped_release>;

/// Outlives the fits that poll it, whoever sets it.
struct Cancel {
  identify::Cancel flag{false};
};

std::shared_ptr<Whitening> make_whitening(std::vector<std::vector<double>> ar, const std::vector<double>& sd,
                                          const Signals& measured, const Eigen::Ref<const Eigen::MatrixXd>& directions,
                                          const std::vector<double>& spread) {
  if (ar.size() != sd.size())
    throw ParameterError(sentence("ar of ", ar.size(), " channels: expected ", sd.size(), ", as in sd"));
  std::vector<ChannelNoise> noise;
  for (std::size_t c = 0; c < sd.size(); ++c) noise.push_back({std::move(ar[c]), sd[c]});
  return std::make_shared<Whitening>(std::move(noise), measured, directions, spread);
}

Eigen::MatrixXd apply_many(const Whitening& whitening, const Array& many) {
  if (many.ndim() != 3 || many.shape(1) != whitening.channels() || many.shape(2) != whitening.samples())
    throw ParameterError(sentence("signals with ", many.ndim(), " dimensions: expected shape (m, ",
                                  whitening.channels(), ", ", whitening.samples(), ")"));
  Eigen::MatrixXd all(whitening.rows(), many.shape(0));
  for (py::ssize_t k = 0; k < many.shape(0); ++k)
    whitening.filter(Eigen::Map<const RowMatrix>(many.data(k), whitening.channels(), whitening.samples()), all.col(k));
  whitening.shrink(all);
  return all;
}

Free make_free(std::string name, std::size_t index, bool log, double scale, double start, double mean, double sd,
               double lower, double upper) {
  return {std::move(name), index, log, scale, start, mean, sd, lower, upper};
}

/// Whitened rows, (rows,) or (rows, m), in the shape in which they came.
py::array whitened(const identify::RandomEffect& effect, const Array& rows) {
  const py::ssize_t columns = rows.ndim() == 2 ? rows.shape(1) : 1;
  if (rows.ndim() < 1 || rows.ndim() > 2 || rows.shape(0) != effect.rows())
    throw ParameterError(sentence("rows of shape (", rows.ndim() ? rows.shape(0) : 0, ", …): expected (", effect.rows(),
                                  ") or (", effect.rows(), ", m)"));
  Eigen::MatrixXd all = Eigen::Map<const RowMatrix>(rows.data(), effect.rows(), columns);
  effect.whiten(all);
  if (rows.ndim() == 1) return py::cast(Eigen::VectorXd(all.col(0)));
  return py::cast(RowMatrix(all));
}

Task make_task(const integrate::Experiment& experiment, std::shared_ptr<Whitening> whitening,
               const std::map<std::size_t, double>& fixed, const std::map<std::size_t, double>& added,
               const std::vector<std::pair<std::string, int>>& initial, const std::vector<double>& initial_sd,
               const std::vector<std::pair<std::vector<std::size_t>, double>>& scatter) {
  if (initial.size() != initial_sd.size())
    throw ParameterError(
        sentence(initial_sd.size(), " initial_sd: expected ", initial.size(), ", one an initial state"));
  Task task{std::make_shared<integrate::Experiment>(experiment),
            std::move(whitening),
            Conditions(fixed.begin(), fixed.end()),
            Conditions(added.begin(), added.end()),
            {},
            {}};
  const auto seeds = make_seeds(initial);
  for (std::size_t k = 0; k < seeds.size(); ++k) task.initial.push_back({seeds[k], initial_sd[k]});
  for (const auto& [parameters, sd] : scatter) task.scatter.push_back({parameters, sd});
  return task;
}

identify::Problem make_problem(const std::string& kind, const std::vector<double>& values,
                               const std::vector<bool>& active, const std::vector<Task>& tasks,
                               const std::vector<Free>& free, const std::vector<std::vector<double>>& initial,
                               const integrate::Settings& settings) {
  const Model& of = model(kind);
  return {of, make_configuration(of, values, active), tasks, free, initial, settings};
}

py::dict to_dict(identify::Result of) {
  py::list residuals, jacobian, jacobian_initial;
  for (const auto& task : of.tasks) {
    residuals.append(py::cast(Eigen::VectorXd(task.residual())));
    jacobian.append(py::cast(RowMatrix(task.by_free())));
    jacobian_initial.append(py::cast(RowMatrix(task.by_initial())));
  }
  return py::dict(py::arg("values") = of.values, py::arg("x") = of.x, py::arg("initial") = of.initial,
                  py::arg("cost") = of.cost, py::arg("prior_cost") = of.prior_cost, py::arg("converged") = of.converged,
                  py::arg("message") = of.message, py::arg("iterations") = of.iterations,
                  py::arg("at_bound") = of.at_bound, py::arg("residuals") = residuals, py::arg("jacobian") = jacobian,
                  py::arg("jacobian_initial") = jacobian_initial);
}

template <class Solve>
py::dict without_gil(Solve solve) {
  identify::Result result;
  {
    py::gil_scoped_release release;
    result = solve();
  }
  return to_dict(std::move(result));
}

void bind_whitening(py::module_& module) {
  py::class_<Whitening, std::shared_ptr<Whitening>>(
      module, "Whitening",
      "Turns residuals of one experiment into independent ones of unit variance: a filter a channel, innovation\n"
      "(r_t - sum_k ar[k] r_{t-1-k}) / sd (sd infinite or <= 0: not scored), then (I + V diag(spread^2) V')^(-1/2) "
      "with\n"
      "V = directions, shape (rows, k), already filtered. measured: (channels, samples), NaN where nothing was "
      "measured.\n"
      "Rows: channel by channel, time increasing; a sample counts where it and those its filter needs were measured.")
      .def(py::init([](std::vector<std::vector<double>> ar, const std::vector<double>& sd, const Signals& measured,
                       const std::optional<Eigen::MatrixXd>& directions, const std::vector<double>& spread) {
             return make_whitening(std::move(ar), sd, measured, directions ? *directions : Eigen::MatrixXd(), spread);
           }),
           py::arg("ar"), py::arg("sd"), py::arg("measured"), py::arg("directions") = py::none(),
           py::arg("spread") = std::vector<double>())
      .def("rows", &Whitening::rows, "Number of rows of what it gives.")
      .def("cells", &Whitening::cells, "Channel and sample of each row, (2, rows).")
      .def("apply", &Whitening::apply, py::arg("signals"), ReleaseGil(),
           "Whitened signals, (channels, samples) -> (rows,).")
      .def("apply_many", &apply_many, py::arg("signals"), "Whitened signals, (m, channels, samples) -> (rows, m).")
      .def("residual", &Whitening::residual, py::arg("outputs"), ReleaseGil(),
           "Whitened differences of `outputs` from what was measured, (channels, samples) -> (rows,).");
}

void bind_random_effect(py::module_& module) {
  py::class_<identify::RandomEffect>(
      module, "RandomEffect",
      "Along `directions`, shape (rows, k), residuals differ by independent normal amounts of unit variance.")
      .def(py::init<const Eigen::Ref<const Eigen::MatrixXd>&>(), py::arg("directions"))
      .def("whiten", &whitened, py::arg("rows"), "(I + V V')^(-1/2) rows, (rows,) or (rows, m), for directions V.")
      .def_property_readonly("volume", &identify::RandomEffect::volume, "log det(I + V V').");
}

py::dict regress(const Signals& residual, const Signals& columns, const std::vector<double>& belief,
                 const std::vector<bool>& logarithm, const std::vector<bool>& positive, const Eigen::VectorXd& share,
                 const Eigen::VectorXd& level, int steps) {
  const auto require = [](std::string_view name, auto size, auto expected) {
    if (static_cast<Eigen::Index>(size) != static_cast<Eigen::Index>(expected))
      throw ParameterError(sentence(name, " of size ", size, ": expected ", expected));
  };
  require("columns: rows", columns.cols(), residual.size());
  require("belief", belief.size(), columns.rows());
  require("logarithm", logarithm.size(), columns.rows());
  require("positive", positive.size(), columns.rows());
  require("share", share.size(), residual.rows());
  require("level", level.size(), residual.rows());
  identify::Regression of{residual, columns, {}, share};
  for (std::size_t i = 0; i < belief.size(); ++i) of.unknowns.push_back({belief[i], logarithm[i], positive[i]});
  identify::Regressed found;
  {
    py::gil_scoped_release release;
    found = identify::regress(of, level, steps);
  }
  return py::dict(py::arg("finite") = found.finite, py::arg("x") = found.x, py::arg("level") = found.level,
                  py::arg("residual") = found.residual, py::arg("weight") = found.weight,
                  py::arg("information") = found.information);
}

void bind_regression(py::module_& module) {
  module.def("regress", &regress, py::arg("residual"), py::arg("columns"), py::arg("belief"), py::arg("logarithm"),
             py::arg("positive"), py::arg("share"), py::arg("level"), py::arg("steps"),
             "Most probable x for residual (equations, samples) + amounts of columns (unknowns, equations*samples) =\n"
             "Student-t noise of 4 degrees of freedom. belief: 1/sd^2 of each x about 0; logarithm: the amount is\n"
             "exp(x) - 1; positive: x cannot be negative; share: of the samples of an equation that count as\n"
             "independent; level: first guess of each scale. A dict: finite, x, level (equations,), residual and\n"
             "weight (equations, samples), information (unknowns, unknowns).");
}

void bind_problem(py::module_& module) {
  py::class_<Cancel>(module, "Cancel", "Stops the fits that it was given to, from any thread.")
      .def(py::init<>())
      .def(
          "set", [](Cancel& cancel) { cancel.flag = true; }, "From now on, those fits return at once.")
      .def("is_set", [](const Cancel& cancel) { return cancel.flag.load(); });
  py::class_<Task>(
      module, "Task",
      "One experiment of a fit: fixed {parameter index: value there}, added {parameter index: by how much it is\n"
      "larger there}; initial: free states [(\"position\" | \"velocity\", axis) | (\"reading\", output)], initial_sd: "
      "their prior standard\n"
      "deviations about the experiment's own initial state; scatter [([parameter indices], sd)]: parameters that\n"
      "differ there by a common factor, sd of its logarithm.")
      .def(py::init(&make_task), py::arg("experiment"), py::arg("whitening"), py::kw_only(),
           py::arg("fixed") = std::map<std::size_t, double>(), py::arg("added") = std::map<std::size_t, double>(),
           py::arg("initial") = std::vector<std::pair<std::string, int>>(),
           py::arg("initial_sd") = std::vector<double>(),
           py::arg("scatter") = std::vector<std::pair<std::vector<std::size_t>, double>>())
      .def(
          "rows", [](const Task& task) { return task.whitening->rows(); }, "Number of its residuals.");
  bind_record<Free>(
      module, "Free",
      "A fitted parameter: coordinate x = log(value / scale) or value / scale; start, lower, upper are values;\n"
      "mean and sd of the normal prior belong to x (sd infinite: no prior).",
      {field("name", &Free::name, "Name of the parameter."),
       field("index", &Free::index, "Its place in the table of the system."),
       field("log", &Free::log, "Is its coordinate a logarithm?"),
       field("scale", &Free::scale, "Unit of the coordinate."), field("start", &Free::start, "Value at the start."),
       field("mean", &Free::mean, "Mean of the prior."), field("sd", &Free::sd, "Standard deviation of the prior."),
       field("lower", &Free::lower, "Smallest value."), field("upper", &Free::upper, "Largest value.")})
      .def(py::init(&make_free), py::kw_only(), py::arg("name"), py::arg("index"), py::arg("log"), py::arg("scale"),
           py::arg("start"), py::arg("mean") = 0.0, py::arg("sd") = inf, py::arg("lower") = -inf,
           py::arg("upper") = inf)
      .def("value", &Free::value, py::arg("x"), "Value at the coordinate x, within the bounds.")
      .def("started", &Free::started, py::arg("value"),
           "The same, started at the value inside the bounds that is nearest; a logarithm starts above 0.")
      .def("coordinate", &Free::coordinate, py::arg("value"), "Coordinate of a value.")
      .def("slope", &Free::slope, py::arg("x"), "Derivative of the value by the coordinate, at x.");
}
}  // namespace

void bind_identify(py::module_& module) {
  bind_whitening(module);
  bind_random_effect(module);
  bind_regression(module);
  bind_problem(module);
  module.def(
      "linearise",
      [](const std::string& kind, const std::vector<double>& values, const std::vector<bool>& active,
         const std::vector<Task>& tasks, const std::vector<Free>& free, const integrate::Settings& settings,
         const std::vector<std::vector<double>>& initial) {
        const auto problem = make_problem(kind, values, active, tasks, free, initial, settings);
        return without_gil([&] { return identify::linearise(problem); });
      },
      py::arg("kind"), py::arg("values"), py::arg("active"), py::arg("tasks"), py::arg("free"), py::arg("settings"),
      py::kw_only(), py::arg("initial") = std::vector<std::vector<double>>(),
      "What `fit` returns, at the start and unsolved. `initial`: values of the free states and logarithms of the\n"
      "factors, a list a task (default: their prior means).");
  module.def(
      "fit",
      [](const std::string& kind, const std::vector<double>& values, const std::vector<bool>& active,
         const std::vector<Task>& tasks, const std::vector<Free>& free, const integrate::Settings& settings,
         const std::vector<std::vector<double>>& initial, int max_iterations, double tolerance, const Cancel* cancel,
         double goal, int goal_within) {
        const auto problem = make_problem(kind, values, active, tasks, free, initial, settings);
        return without_gil([&] {
          return identify::fit(problem,
                               {max_iterations, tolerance, cancel ? &cancel->flag : nullptr, goal, goal_within});
        });
      },
      py::arg("kind"), py::arg("values"), py::arg("active"), py::arg("tasks"), py::arg("free"), py::arg("settings"),
      py::kw_only(), py::arg("initial") = std::vector<std::vector<double>>(), py::arg("max_iterations") = 50,
      py::arg("tolerance") = 1e-8, py::arg("cancel").none(true) = py::none(), py::arg("goal") = inf,
      py::arg("goal_within") = 1,
      "Minimises half the sum of squared whitened residuals and priors. Returns a dict: values (all parameters), x\n"
      "(coordinates of the free ones), initial (free states, logarithms of factors, a list a task), cost, prior_cost, "
      "converged, message,\n"
      "iterations, at_bound; per task: residuals (rows,), jacobian (rows, free) by x, jacobian_initial (rows, states) "
      "by\n"
      "(state - prior mean) / sd. Stops early where the cost is not below `goal` after `goal_within` iterations, or\n"
      "would not be after as many like the last two. Raises NumericalError if a simulation fails at the start.");
}
}  // namespace tendonlab::bindings
