#pragma once
#include "tendonlab/systems/cable_joint.hpp"
#include "tendonlab/systems/rigid_joint.hpp"
#include "tendonlab/systems/two_inertia.hpp"

namespace tendonlab::systems {
using All = Laws<RigidJoint, TwoInertia, CableJoint>;
}
