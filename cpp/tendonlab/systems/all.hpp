#pragma once
#include "tendonlab/systems/bowden_pair.hpp"
#include "tendonlab/systems/cable_joint.hpp"
#include "tendonlab/systems/ccsrm.hpp"
#include "tendonlab/systems/ccsrm_elastic.hpp"  // part of ccsrm
#include "tendonlab/systems/ccsrm_tensions.hpp"
#include "tendonlab/systems/friction_map.hpp"
#include "tendonlab/systems/rigid_joint.hpp"
#include "tendonlab/systems/servo_pendulum.hpp"
#include "tendonlab/systems/tendon_routing.hpp"
#include "tendonlab/systems/two_inertia.hpp"

namespace tendonlab::systems {
using All = Laws<RigidJoint, ServoPendulum, TwoInertia, FrictionMap, TendonRouting, CableJoint, BowdenPair, Ccsrm,
                 CcsrmTensions>;
}
