#pragma once
#include "tendonlab/transmission/asymmetry.hpp"
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/capstan.hpp"
#include "tendonlab/transmission/compliance.hpp"
#include "tendonlab/transmission/stribeck.hpp"

namespace tendonlab::transmission {
using All = Laws<Backlash, Compliance>;
/// Friction of a cable on a pulley, stated by friction coefficients.
using Contacts = Laws<Capstan, Stribeck, Asymmetry>;
}  // namespace tendonlab::transmission
