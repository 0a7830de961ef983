#pragma once
#include "tendonlab/sensing/bias.hpp"
#include "tendonlab/sensing/delay.hpp"

namespace tendonlab::sensing {
using All = Laws<Bias, Delay>;
}
