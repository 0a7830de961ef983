#pragma once
#include "tendonlab/actuation/delay.hpp"
#include "tendonlab/actuation/drive_inertia.hpp"
#include "tendonlab/actuation/gain_error.hpp"
#include "tendonlab/actuation/offset.hpp"
#include "tendonlab/actuation/winding.hpp"

namespace tendonlab::actuation {
using All = Laws<Delay, GainError, Offset>;
/// What makes effort of a command and has a state of its own: part of a system, no link of a chain.
using Motor = Laws<Winding>;
/// Of drives whose motion is an input, not a state.
using Driven = Laws<DriveInertia>;
/// Every law of the group.
using Every = Joined<All, Motor, Driven>::type;
}  // namespace tendonlab::actuation
