#pragma once
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/compliance.hpp"
#include "tendonlab/transmission/hold.hpp"
#include "tendonlab/transmission/ripple.hpp"
#include "tendonlab/transmission/taut_compliance.hpp"

namespace tendonlab::transmission {
using All = Laws<Backlash, Compliance>;
/// Of a drive that pulls pretensioned cables by a gear.
using Pull = Laws<TautCompliance, Ripple, Hold>;
}  // namespace tendonlab::transmission
