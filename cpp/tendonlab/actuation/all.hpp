#pragma once
#include "tendonlab/actuation/delay.hpp"
#include "tendonlab/actuation/drive_inertia.hpp"
#include "tendonlab/actuation/gain_error.hpp"
#include "tendonlab/actuation/offset.hpp"

namespace tendonlab::actuation {
using All = Laws<Delay, GainError, Offset>;
/// Of drives whose motion is an input, not a state.
using Driven = Laws<DriveInertia>;
}  // namespace tendonlab::actuation
