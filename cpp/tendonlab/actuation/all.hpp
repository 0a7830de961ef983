#pragma once
#include "tendonlab/actuation/delay.hpp"
#include "tendonlab/actuation/gain_error.hpp"
#include "tendonlab/actuation/offset.hpp"
#include "tendonlab/actuation/winding.hpp"

namespace tendonlab::actuation {
using All = Laws<Delay, GainError, Offset>;
/// What makes effort of a command and has a state of its own: part of a system, no link of a chain.
using Motor = Laws<Winding>;
}  // namespace tendonlab::actuation
