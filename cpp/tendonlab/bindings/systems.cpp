#include <algorithm>
#include <optional>

#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/bindings/convert.hpp"
#include "tendonlab/bindings/pickle.hpp"
#include "tendonlab/core/error.hpp"

namespace tendonlab::bindings {
namespace {
using integrate::Experiment;
using integrate::Loop;
using integrate::Signal;

Signal make_signal(const Array& knots, const Array& coefficients, bool holds) {
  const auto pieces = static_cast<std::size_t>(knots.size());
  if (coefficients.ndim() != 2 || coefficients.shape(1) != 4 ||
      static_cast<std::size_t>(coefficients.shape(0)) != pieces)
    throw ParameterError(sentence("signal with ", pieces, " knots: expected coefficients of shape (", pieces, ", 4)"));
  Signal s;
  s.holds = holds;
  s.knots.assign(knots.data(), knots.data() + pieces);
  s.coefficients.resize(pieces);
  for (std::size_t i = 0; i < pieces; ++i)
    for (std::size_t k = 0; k < 4; ++k) s.coefficients[i][k] = coefficients.data()[4 * i + k];
  s.prepare();
  return s;
}

Loop make_loop(const std::string& kind, int axis, int output, double proportional, double derivative,
               double reference_weight, double limit, double sample_time, const Signal& reference,
               const Signal& disturbance) {
  Loop loop;
  if (kind == "injection")
    loop.kind = Loop::Kind::injection;
  else if (kind == "controller")
    loop.kind = Loop::Kind::controller;
  else if (kind != "open")
    throw ParameterError(sentence("loop kind = \"", kind, "\": expected open, injection or controller"));
  loop.axis = axis, loop.output = output, loop.proportional = proportional, loop.derivative = derivative;
  loop.reference_weight = reference_weight, loop.limit = limit, loop.sample_time = sample_time;
  loop.reference = reference, loop.disturbance = disturbance;
  return loop;
}

Experiment make_experiment(const std::string& kind, std::vector<double> time, std::vector<Signal> inputs,
                           const Loop& loop, std::vector<double> position, std::vector<double> velocity,
                           const ReadingRows& taken, std::vector<double> reading) {
  const SystemInfo& info = model(kind).info();
  const auto dof = static_cast<std::size_t>(info.dof);
  if (time.size() < 2) throw ParameterError(sentence("experiment with ", time.size(), " samples: expected at least 2"));
  for (std::size_t i = 1; i < time.size(); ++i)
    if (!(time[i] > time[i - 1]))
      throw ParameterError(sentence("time[", i, "] = ", time[i], " s: expected more than ", time[i - 1], " s"));
  if (inputs.size() != info.inputs.size())
    throw ParameterError(sentence(inputs.size(), " inputs: ", kind, " expects ", info.inputs.size()));
  if (position.size() != dof || velocity.size() != dof)
    throw ParameterError(sentence("initial state: ", kind, " expects ", dof, " positions and as many velocities"));
  for (const auto& [axis, output, share] : taken)
    if (axis < 0 || axis >= info.dof || output < 0 || output >= static_cast<int>(info.outputs.size()) ||
        !std::isfinite(share))
      throw ParameterError(sentence("taken = (", axis, ", ", output, ", ", share, "): expected one of ", info.dof,
                                    " degrees of freedom, one of ", info.outputs.size(), " outputs, a finite share"));
  if (reading.empty()) reading.assign(info.outputs.size(), std::nan(""));
  if (reading.size() != info.outputs.size())
    throw ParameterError(sentence(reading.size(), " readings: ", kind, " expects ", info.outputs.size()));
  return {std::move(time),    std::move(inputs), loop, std::move(position), std::move(velocity),
          to_readings(taken), std::move(reading)};
}

Experiment last_moved(Experiment of, double sense) {
  if (sense != 1 && sense != -1) throw ParameterError(sentence("sense = ", sense, ": expected 1 or -1"));
  of.sense = sense;
  return of;
}

Experiment started(Experiment of, std::vector<double> position, std::vector<double> velocity,
                   std::vector<double> reading) {
  if (position.size() != of.position.size() || velocity.size() != of.velocity.size() ||
      reading.size() != of.reading.size())
    throw ParameterError(sentence("initial state: expected ", of.position.size(), " positions, as many velocities and ",
                                  of.reading.size(), " readings"));
  of.position = std::move(position), of.velocity = std::move(velocity), of.reading = std::move(reading);
  return of;
}

py::dict simulate(const std::string& kind, const std::vector<double>& values, const std::vector<bool>& active,
                  const Experiment& experiment, const std::vector<std::pair<std::string, int>>& seeds,
                  const integrate::Settings& settings) {
  const Model& of = model(kind);
  const Configuration configuration = make_configuration(of, values, active);
  const auto wanted = make_seeds(seeds);
  const std::size_t channels = of.info().outputs.size();
  if (settings.outputs != ~0u && settings.outputs >> channels != 0)
    throw ParameterError(
        sentence("outputs: ", 31 - __builtin_clz(settings.outputs), ": ", kind, " has ", channels, " outputs"));
  integrate::Trajectory run;
  {
    py::gil_scoped_release release;
    run = of.simulate(configuration, experiment, wanted, settings);
  }
  const auto samples = static_cast<py::ssize_t>(run.samples);
  py::dict out(py::arg("attempts") = run.attempts, py::arg("rejected") = run.rejected, py::arg("events") = run.events);
  out["outputs"] = to_array(std::move(run.value), {run.channels, samples});
  if (!seeds.empty()) out["gradient"] = to_array(std::move(run.gradient), {run.width, run.channels, samples});
  if (settings.ports.any())
    out["ports"] = to_array(std::move(run.port), {static_cast<py::ssize_t>(of.info().ports.size()),
                                                  static_cast<py::ssize_t>(settings.ports.count()), samples});
  return out;
}

/// What is recorded of ports, by its names.
integrate::PortRows rows_named(const std::vector<std::string>& names) {
  using integrate::PortRows;
  const auto& known = PortRows::names;
  PortRows rows;
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw ParameterError(sentence("ports: \"", name, "\": expected velocity, position, load or force"));
    rows.wanted |= 1u << (found - known.begin());
  }
  return rows;
}
/// A bit for each; the last bit is set only where all are wanted.
std::uint32_t wanted_outputs(const std::optional<std::vector<unsigned>>& outputs) {
  if (!outputs) return ~0u;
  std::uint32_t bits = 0;
  for (const unsigned c : *outputs) {
    if (c >= 31) throw ParameterError(sentence("outputs: ", c, ": expected the index of an output"));
    bits |= 1u << c;
  }
  return bits;
}

/// Rows of values: the equation of motion with each.
py::dict balance(const std::string& kind, const Array& values, const std::vector<bool>& active,
                 const Experiment& experiment, const Array& position, const Array& velocity) {
  const Model& of = model(kind);
  const auto width = static_cast<py::ssize_t>(of.info().parameters.size());
  if (values.ndim() != 2 || values.shape(1) != width)
    throw ParameterError(sentence("values: ", values.ndim(), " dimensions of ", values.size(),
                                  " numbers in all; expected shape (m, ", width, ")"));
  const integrate::MeasuredMotion motion{{position.data(), position.data() + position.size()},
                                         {velocity.data(), velocity.data() + velocity.size()}};
  std::vector<integrate::Balance> found;
  {
    py::gil_scoped_release release;
    for (py::ssize_t k = 0; k < values.shape(0); ++k) {
      const std::vector<double> row(values.data() + k * width, values.data() + (k + 1) * width);
      found.push_back(of.balance(make_configuration(of, row, active), experiment, motion));
    }
  }
  const auto samples = static_cast<py::ssize_t>(experiment.time.size());
  const auto rows = [&](std::vector<double> integrate::Balance::*part) {
    std::vector<double> of_all;
    for (const auto& one : found) of_all.insert(of_all.end(), (one.*part).begin(), (one.*part).end());
    const auto count = found.empty() ? 0 : static_cast<py::ssize_t>((found[0].*part).size()) / samples;
    return to_array(std::move(of_all), {values.shape(0), count, samples});
  };
  py::dict out;
  out["effort"] = rows(&integrate::Balance::effort), out["inertia"] = rows(&integrate::Balance::inertia);
  out["outputs"] = rows(&integrate::Balance::output);
  return out;
}
/// What `simulate` is asked.
void bind_experiments(py::module_& module) {
  py::class_<Signal>(module, "Signal",
                     "A piecewise cubic in time, from knots (m,) and coefficients (m, 4) about each knot.")
      .def(py::init<>())
      .def(pickled_signal())
      .def(py::init(&make_signal), py::arg("knots"), py::arg("coefficients"), py::arg("holds"));
  py::class_<Loop>(module, "Loop", "How the command comes about: open, injection or controller.")
      .def(py::init<>())
      .def(pickled_loop())
      .def(py::init(&make_loop), py::kw_only(), py::arg("kind"), py::arg("axis"), py::arg("output"),
           py::arg("proportional"), py::arg("derivative"), py::arg("reference_weight"), py::arg("limit"),
           py::arg("sample_time"), py::arg("reference"), py::arg("disturbance"));
  py::class_<Experiment>(module, "Experiment", "One experiment as the simulator needs it.")
      .def(pickled_experiment())
      .def(py::init(&make_experiment), py::kw_only(), py::arg("kind"), py::arg("time"), py::arg("inputs"),
           py::arg("loop"), py::arg("position"), py::arg("velocity"), py::arg("taken") = ReadingRows(),
           py::arg("reading") = std::vector<double>(),
           "`taken`: (degree of freedom, output, share) of initial positions that are a share of what a sensor reads;\n"
           "the simulation begins there less that share of what the sensor adds. `reading`: of the sensor of each\n"
           "output before the first sample, NaN where it is not known (default).")
      .def("started", &started, py::arg("position"), py::arg("velocity"), py::arg("reading"),
           "The same experiment from another initial state.")
      .def("last_moved", &last_moved, py::arg("sense"),
           "The same experiment where what rests at the start has moved last in this sense, 1 or -1.")
      .def(
          "until",
          [](const Experiment& of, std::size_t samples) {
            if (samples < 2 || samples > of.time.size())
              throw ParameterError(sentence("samples = ", samples, ": expected 2 to ", of.time.size()));
            Experiment other = of;
            other.time.resize(samples);
            return other;
          },
          py::arg("samples"), "The first samples of the experiment.")
      .def_readonly("time", &Experiment::time)
      .def_readonly("position", &Experiment::position)
      .def_readonly("velocity", &Experiment::velocity)
      .def_readonly("reading", &Experiment::reading)
      .def_readonly("sense", &Experiment::sense);
  py::class_<integrate::Settings>(module, "Settings", "Tolerance and scales of the integration.")
      .def(py::init([](double tolerance, double position_scale, double velocity_scale, long max_attempts,
                       const std::vector<std::string>& ports, const std::optional<std::vector<unsigned>>& outputs) {
             require_within("tolerance", tolerance, 1e-14, 0.1);
             require_within("position_scale", position_scale, 1e-300, 1e300);
             require_within("velocity_scale", velocity_scale, 1e-300, 1e300);
             return integrate::Settings{tolerance,    position_scale,    velocity_scale,
                                        max_attempts, rows_named(ports), wanted_outputs(outputs)};
           }),
           py::kw_only(), py::arg("tolerance") = 1e-6, py::arg("position_scale") = 1e-2,
           py::arg("velocity_scale") = 1e-2, py::arg("max_attempts") = 20'000'000L,
           py::arg("ports") = std::vector<std::string>{}, py::arg("outputs") = py::none(),
           "`ports`: what to record of each port: velocity, position, load, force. `outputs`: indices of those to\n"
           "record, default all; the others stay 0.");
}
}  // namespace

void bind_systems(py::module_& module) {
  module.def(
      "rigid_motion",
      [](const std::string& kind, const std::vector<double>& values, const std::vector<bool>& active) {
        const Model& of = model(kind);
        const RigidMotion r = of.rigid_motion(make_configuration(of, values, active));
        return py::make_tuple(r.shape, r.inertia, r.effort_per_command);
      },
      py::arg("kind"), py::arg("values"), py::arg("active"),
      "Motion of each degree of freedom with the first if nothing stretched, inertia and effort per unit of command.");
  bind_experiments(module);
  module.def(
      "port_quantities",
      [] {
        const auto& names = integrate::PortRows::names;
        return std::vector<std::string>(names.begin(), names.end());
      },
      "What can be recorded of each port.");
  module.def("simulate", &simulate, py::arg("kind"), py::arg("values"), py::arg("active"), py::arg("experiment"),
             py::arg("seeds"), py::arg("settings"),
             "Outputs (channels, samples), their gradient (seeds, channels, samples), ports (ports, wanted quantities, "
             "samples).");
  module.def(
      "balance", &balance, py::arg("kind"), py::arg("values"), py::arg("active"), py::arg("experiment"),
      py::arg("position"), py::arg("velocity"),
      "The equation of motion along a measured motion (dof, samples), for each of m rows of values: what acts on "
      "each degree of freedom, its inertia (m, dof, samples), and the outputs (m, channels, samples).");
}
}  // namespace tendonlab::bindings
