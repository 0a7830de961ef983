#pragma once
// One order for everything that a system consists of: its own parameters, its slots, its load, its actuation, its
// sensors. To describe, fill or seed a system is to walk through it here.
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// Gives every port of an element the laws of its first; they learn whether their port is mirrored.
template <class System, std::size_t... i>
void share_slots(System& system, std::index_sequence<i...>) {
  ((std::get<i>(system.slot) = std::get<first_port<System>(i)>(system.slot)), ...);
  const auto orient = [](auto& law, [[maybe_unused]] const Port& port) {
    if constexpr (asks_if_mirrored<std::decay_t<decltype(law)>>) law.mirrored = port.is_mirrored;
  };
  const auto place = [&](auto& laws, const Port& port) {
    std::apply([&](auto&... law) { (orient(law, port), ...); }, laws);
  };
  (place(std::get<i>(system.slot).laws, System::ports[i]), ...);
}

/// Calls f(laws, active) for each place where laws sit.
template <class System, class F>
void for_each_place(System& system, F&& f) {
  const auto place = [&](auto& of) {
    if constexpr (std::decay_t<decltype(of)>::size > 0) f(of.laws, of.active);
  };
  std::size_t i = 0;
  const auto slot = [&](auto& of) {
    if (first_port<System>(i) == i) {
      f(of.laws, of.active);
      if constexpr (!System::passing.empty())
        if (System::ports[i].element == System::passing) place(system.passed);
    }
    ++i;
  };
  std::apply([&](auto&... each) { (slot(each), ...); }, system.slot);
  place(system.load);
  place(system.actuation);
  for (auto& sensor : system.sensor) place(sensor);
}

/// Calls f(field) for each parameter: the system's own, then those of the laws in each place.
template <class System, class F>
void for_each_field(System& system, F&& f) {
  for_each_parameter<System>([&](const auto& p) { f(system.*p.field); });
  const auto fields = [&](auto& law) {
    for_each_parameter<std::decay_t<decltype(law)>>([&](const auto& p) { f(law.*p.field); });
  };
  for_each_place(system, [&](auto& laws, unsigned&) { std::apply([&](auto&... law) { (fields(law), ...); }, laws); });
}
}  // namespace tendonlab::systems
