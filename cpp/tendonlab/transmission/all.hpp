#pragma once
#include "tendonlab/transmission/backlash.hpp"
#include "tendonlab/transmission/compliance.hpp"

namespace tendonlab::transmission {
using All = Laws<Backlash, Compliance>;
}
