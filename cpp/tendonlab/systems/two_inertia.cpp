#include "tendonlab/systems/two_inertia.hpp"

#include "tendonlab/systems/instances.hpp"

namespace tendonlab {
template <>
std::unique_ptr<Model> make_model<systems::TwoInertia>() {
  return std::make_unique<ModelOf<systems::TwoInertia>>();
}
}  // namespace tendonlab
