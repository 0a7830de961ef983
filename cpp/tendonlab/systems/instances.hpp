#pragma once
// Each system is compiled once, in a file of its own; the list of systems only asks for it.
#include "tendonlab/systems/model_of.hpp"

namespace tendonlab {
template <template <class> class Of>
std::unique_ptr<Model> make_model();
}
