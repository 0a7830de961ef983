#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

namespace tendonlab::bindings {
namespace py = pybind11;
using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;

void bind_tables(py::module_& module);
void bind_laws(py::module_& module);
void bind_pair(py::module_& module);
void bind_systems(py::module_& module);
void bind_batch(py::module_& module);
void bind_routing(py::module_& module);
void bind_identify(py::module_& module);

/// The numbers of `values` as a numpy array of the given shape, without a copy.
Array to_array(std::vector<double> values, std::vector<py::ssize_t> shape);
}  // namespace tendonlab::bindings
