#pragma once
#include "tendonlab/actuation/deadband.hpp"
#include "tendonlab/actuation/delay.hpp"
#include "tendonlab/actuation/drive_inertia.hpp"
#include "tendonlab/actuation/gain_error.hpp"
#include "tendonlab/actuation/offset.hpp"
#include "tendonlab/actuation/winding.hpp"

namespace tendonlab::actuation {
using All = Laws<Delay, Deadband, GainError, Offset>;
/// Of a motor whose current is a state: a law of a slot.
using Motor = Laws<Winding>;
/// Of drives whose motion is an input, not a state.
using Driven = Laws<DriveInertia>;
/// Every law of the group.
using Every = Joined<All, Motor, Driven>::type;
}  // namespace tendonlab::actuation
