// The points of a sweep, from numpy and back into it.
#include "tendonlab/models/batch.hpp"

#include <algorithm>

#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/core/error.hpp"

namespace tendonlab::bindings {
namespace {
template <class Number>
using PointRows = py::array_t<Number, py::array::c_style | py::array::forcecast>;
/// Numbers of the points of a sweep, `width` of them a row.
template <class Number>
const Number* rows_of(const char* name, const PointRows<Number>& all, py::ssize_t count, std::size_t width) {
  if (all.ndim() != 2 || all.shape(0) != count || all.shape(1) != static_cast<py::ssize_t>(width))
    throw ParameterError(sentence(name, ": expected shape (", count, ", ", width, ")"));
  return all.data();
}
template <class Real>
std::vector<std::string> fill_outputs(const Model& of, const Points& points, const integrate::Experiment& experiment,
                                      const integrate::Settings& settings, const std::vector<std::size_t>& channels,
                                      py::array_t<Real, py::array::c_style>& out) {
  const auto samples = static_cast<py::ssize_t>(experiment.time.size());
  if (out.ndim() != 3 || out.shape(0) != static_cast<py::ssize_t>(points.count) ||
      out.shape(1) != static_cast<py::ssize_t>(channels.size()) || out.shape(2) != samples)
    throw ParameterError(
        sentence("out: expected shape (", points.count, ", ", channels.size(), ", ", samples, "), C-contiguous"));
  Real* to = out.mutable_data();
  py::gil_scoped_release release;
  return simulate_batch<Real>(of, points, experiment, settings, {channels, to});
}
std::vector<std::string> simulate_many(const std::string& kind, const PointRows<double>& values,
                                       const PointRows<std::uint8_t>& active, const integrate::Experiment& experiment,
                                       const PointRows<double>& position, const PointRows<double>& velocity,
                                       const integrate::Settings& settings, const std::vector<std::size_t>& channels,
                                       const py::array& out) {
  const Model& of = model(kind);
  const SystemInfo& info = of.info();
  const py::ssize_t count = values.ndim() > 0 ? values.shape(0) : 0;
  const auto dof = static_cast<std::size_t>(info.dof);
  for (const std::size_t c : channels) {
    if (c >= info.outputs.size())
      throw ParameterError(sentence("channel ", c, ": ", kind, " has ", info.outputs.size(), " outputs"));
    if (std::count(channels.begin(), channels.end(), c) > 1) throw ParameterError(sentence("channel ", c, ": twice"));
  }
  const Points points{static_cast<std::size_t>(count), rows_of("values", values, count, info.parameters.size()),
                      rows_of("active", active, count, info.effects.size()), rows_of("position", position, count, dof),
                      rows_of("velocity", velocity, count, dof)};
  const auto filled = [&](auto into) { return fill_outputs(of, points, experiment, settings, channels, into); };
  if (py::isinstance<py::array_t<double, py::array::c_style>>(out))
    return filled(py::reinterpret_borrow<py::array_t<double, py::array::c_style>>(out));
  if (py::isinstance<py::array_t<float, py::array::c_style>>(out))
    return filled(py::reinterpret_borrow<py::array_t<float, py::array::c_style>>(out));
  throw ParameterError("out: expected an array of float64 or float32, C-contiguous");
}
}  // namespace

void bind_batch(py::module_& module) {
  module.def("simulate_many", &simulate_many, py::arg("kind"), py::arg("values"), py::arg("active"),
             py::arg("experiment"), py::arg("position"), py::arg("velocity"), py::arg("settings"), py::arg("channels"),
             py::arg("out"),
             "Simulates one experiment at many points, one row of `values` (points, parameters), `active` (points,\n"
             "effects), `position` and `velocity` (points, dof) each, and writes outputs of `channels` into `out`\n"
             "(points, channels, samples), float64 or float32. Gives a message per point: empty, or why it failed.");
}
}  // namespace tendonlab::bindings
