#include "tendonlab/bindings/bind.hpp"
#include "tendonlab/bindings/processor.hpp"
#include "tendonlab/core/error.hpp"

namespace tendonlab::bindings {
Array to_array(std::vector<double> values, std::vector<py::ssize_t> shape) {
  auto* kept = new std::vector<double>(std::move(values));
  const py::capsule owner(kept, [](void* p) { delete static_cast<std::vector<double>*>(p); });
  return Array(std::move(shape), kept->data(), owner);
}
}  // namespace tendonlab::bindings

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  if (const char* lacking = tendonlab::bindings::lacking_instructions())
    throw py::import_error(std::string("this build of tendonlab needs a processor with ") + lacking);
  module.doc() = "The compiled core of tendonlab: laws, systems, simulation, identification.";
  // The Python package owns the error types; the core only raises them.
  py::register_exception_translator([](std::exception_ptr thrown) {
    const auto raise = [](const char* type, const char* what) {
      py::set_error(py::module_::import("tendonlab.errors").attr(type), what);
    };
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const tendonlab::ParameterError& e) {
      raise("ParameterError", e.what());
    } catch (const tendonlab::NumericalError& e) {
      raise("NumericalError", e.what());
    }
  });
  tendonlab::bindings::bind_tables(module);
  tendonlab::bindings::bind_laws(module);
  tendonlab::bindings::bind_pair(module);
  tendonlab::bindings::bind_systems(module);
  tendonlab::bindings::bind_batch(module);
  tendonlab::bindings::bind_routing(module);
  tendonlab::bindings::bind_identify(module);
}
