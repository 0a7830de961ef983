#pragma once
// Plain C++: a file that needs only this does not read pybind11.
#include "tendonlab/models/model.hpp"

namespace tendonlab::bindings {
/// Checks sizes and bounds: what goes into a simulation is finite and allowed, or ParameterError names it.
Configuration make_configuration(const Model& of, const std::vector<double>& values, const std::vector<bool>& active);
/// Seeds from ("parameter" | "position" | "velocity", index).
std::vector<integrate::Seed> make_seeds(const std::vector<std::pair<std::string, int>>& seeds);
}  // namespace tendonlab::bindings
