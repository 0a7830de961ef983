#pragma once
// One order for everything a system is made of: its own parameters, its slots, its load, its actuation, its sensors.
// Whoever describes, fills or seeds a system walks through it here.
#include <string>

#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// Calls f(element, laws, active) for each place where laws sit.
template <class System, class F>
void for_each_place(System& system, F&& f) {
  std::size_t i = 0;
  std::apply([&](auto&... slot) { (f(std::string(System::ports[i++].element), slot.laws, slot.active), ...); },
             system.slot);
  f(std::string("load"), system.load.laws, system.load.active);
  f(std::string("actuation"), system.actuation.laws, system.actuation.active);
  for (std::size_t c = 0; c < System::outputs.size(); ++c)
    f("sensor." + std::string(System::outputs[c].name), system.sensor[c].laws, system.sensor[c].active);
}

/// Calls f(element, law, is_active bit) for each law in each place.
template <class System, class F>
void for_each_law(System& system, F&& f) {
  for_each_place(system, [&](const std::string& element, auto& laws, unsigned& active) {
    unsigned bit = 1;
    std::apply([&](auto&... law) { ((f(element, law, active, bit), bit <<= 1), ...); }, laws);
  });
}

/// Calls f(element, law name, table entry, field) for each parameter; the system's own have neither element nor law.
template <class System, class F>
void for_each_parameter_of(System& system, F&& f) {
  for_each_parameter<System>([&](const auto& p) { f(std::string(), std::string_view(), p, system.*p.field); });
  for_each_law(system, [&](const std::string& element, auto& law, unsigned, unsigned) {
    using Law = std::decay_t<decltype(law)>;
    for_each_parameter<Law>([&](const auto& p) { f(element, Law::name, p, law.*p.field); });
  });
}

template <class System>
bool is_structural(const std::string& effect) {
  for (const auto& name : System::structural)
    if (effect == name) return true;
  return false;
}

/// The public name of a parameter: <element>_<own name>, except where the system keeps its nominal effects plain.
template <class System>
std::string parameter_name(const std::string& element, std::string_view law, std::string_view own) {
  if (element.empty()) return std::string(own);
  if (System::plain_names)
    for (const auto& nominal : System::nominal)
      if (nominal == element + ":" + std::string(law)) return std::string(own);
  return element + "_" + std::string(own);
}
}  // namespace tendonlab::systems
