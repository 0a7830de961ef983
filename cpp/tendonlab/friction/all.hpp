#pragma once
#include "tendonlab/friction/asymmetry.hpp"
#include "tendonlab/friction/coulomb.hpp"
#include "tendonlab/friction/load_and_ratio.hpp"
#include "tendonlab/friction/efficiency.hpp"
#include "tendonlab/friction/load_dependence.hpp"
#include "tendonlab/friction/presliding.hpp"
#include "tendonlab/friction/static_lugre.hpp"
#include "tendonlab/friction/stribeck.hpp"
#include "tendonlab/friction/viscous.hpp"

namespace tendonlab::friction {
using All = Laws<Coulomb, Viscous, Stribeck, Presliding, LoadDependence, Asymmetry>;
/// Whole curves of steady friction over speed, for maps; where things move the terms above stand.
using Curves = Laws<LoadAndRatio, StaticLugre>;
/// What a gear loses.
using Gears = Laws<Efficiency>;
}  // namespace tendonlab::friction
