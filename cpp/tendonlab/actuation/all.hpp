#pragma once
#include "tendonlab/actuation/delay.hpp"
#include "tendonlab/actuation/gain_error.hpp"
#include "tendonlab/actuation/offset.hpp"

namespace tendonlab::actuation {
using All = Laws<Delay, GainError, Offset>;
}
