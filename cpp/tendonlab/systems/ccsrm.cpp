#include "tendonlab/systems/ccsrm.hpp"

#include "tendonlab/systems/instances.hpp"

namespace tendonlab {
template <>
std::unique_ptr<Model> make_model<systems::Ccsrm>() {
  return std::make_unique<ModelOrGrown<systems::Ccsrm, systems::CcsrmElastic>>();
}
}  // namespace tendonlab
