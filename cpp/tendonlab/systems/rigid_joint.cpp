#include "tendonlab/systems/rigid_joint.hpp"

#include "tendonlab/systems/instances.hpp"

namespace tendonlab {
template <>
std::unique_ptr<Model> make_model<systems::RigidJoint>() {
  return std::make_unique<ModelOf<systems::RigidJoint>>();
}
}  // namespace tendonlab
