#pragma once
// The groups in which users find the laws: tl.friction, tl.transmission, ...
#include "tendonlab/actuation/all.hpp"
#include "tendonlab/friction/all.hpp"
#include "tendonlab/loading/all.hpp"
#include "tendonlab/sensing/all.hpp"
#include "tendonlab/transmission/all.hpp"

namespace tendonlab {
/// Calls f(name, meaning, list) for each group.
template <class F>
constexpr void for_each_group(F&& f) {
  using Sheath = Joined<transmission::Sheath, transmission::SheathEffort, transmission::Tendons>::type;
  f("friction", "Friction laws.", friction::Every{});
  f("transmission", "Laws of cables and gears.", transmission::Every{});
  f("sheath", "Laws of pretensioned tendons in sheaths.", Sheath{});
  f("ends", "Laws of the end sections of cables.", transmission::Ends{});
  f("loading", "Laws of the external load of the joint.", loading::Every{});
  f("actuation", "Laws of actuators.", actuation::Every{});
  f("sensing", "Laws of sensors.", sensing::All{});
}
}  // namespace tendonlab
