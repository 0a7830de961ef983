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
/// Whole curves of steady friction over speed, for maps; where things move the terms above stand.
using Curves = Laws<LoadAndRatio, StaticLugre>;
/// Of a cable that bends in a bushing.
using Bushing = Laws<BushingBranches, BushingSine, BushingCapstan>;
/// Of gears: their own friction, and what they lose of what they carry.
using Gears = Laws<Arctan, Efficiency>;
/// Every law of the group.
using Every = Joined<All, Curves, Bushing, Gears>::type;
}  // namespace tendonlab::friction
