#include "tendonlab/systems/friction_map.hpp"

#include "tendonlab/systems/instances.hpp"

namespace tendonlab {
template <>
std::unique_ptr<Model> make_model<systems::FrictionMap>() {
  return std::make_unique<ModelOf<systems::FrictionMap>>();
}
}  // namespace tendonlab
