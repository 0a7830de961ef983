#pragma once
#include "tendonlab/friction/arctan.hpp"
#include "tendonlab/friction/asymmetry.hpp"
#include "tendonlab/friction/bushing_branches.hpp"
#include "tendonlab/friction/bushing_capstan.hpp"
#include "tendonlab/friction/bushing_sine.hpp"
#include "tendonlab/friction/coulomb.hpp"
#include "tendonlab/friction/efficiency.hpp"
#include "tendonlab/friction/load_and_ratio.hpp"
#include "tendonlab/friction/load_dependence.hpp"
#include "tendonlab/friction/presliding.hpp"
#include "tendonlab/friction/static_lugre.hpp"
#include "tendonlab/friction/stribeck.hpp"
#include "tendonlab/friction/viscous.hpp"

namespace tendonlab::friction {
using All = Laws<Coulomb, Viscous, Stribeck, Presliding, LoadDependence, Asymmetry>;
/// Whole curves of steady friction over speed, for friction maps.
using Curves = Laws<LoadAndRatio, StaticLugre>;
/// Of a cable that bends in a bushing.
using Bushing = Laws<BushingBranches, BushingSine, BushingCapstan>;
/// Of gears: their own friction, and their loss in proportion to the torque that they carry.
using Gears = Laws<Arctan, Efficiency>;
/// Of a tendon on one branch of a routing (S1 eqs 11, 12).
using Branch = Laws<Coulomb, Viscous, LoadDependence>;
/// Every law of the group.
using Every = Joined<All, Curves, Bushing, Gears>::type;
}  // namespace tendonlab::friction
