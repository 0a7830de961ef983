#include "tendonlab/systems/bowden_pair.hpp"

#include "tendonlab/systems/instances.hpp"

namespace tendonlab {
template <>
std::unique_ptr<Model> make_model<systems::BowdenPair>() {
  return std::make_unique<ModelOf<systems::BowdenPair>>();
}
}  // namespace tendonlab
