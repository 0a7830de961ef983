#pragma once
// One order for everything a system is made of: its own parameters, its slots, its load, its actuation, its sensors.
// Whoever describes, fills or seeds a system walks through it here.
#include <string>

#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// The first port of the element of port i: its slot speaks for the others.
template <class System>
constexpr std::size_t first_port(std::size_t i) {
  std::size_t first = 0;
  while (System::ports[first].element != System::ports[i].element) ++first;
  return first;
}
/// Gives every port of an element the laws of its first.
template <class System, std::size_t... i>
void share_slots(System& system, std::index_sequence<i...>) {
  ((std::get<i>(system.slot) = std::get<first_port<System>(i)>(system.slot)), ...);
}

/// Calls f(element, laws, active) for each place where laws sit.
template <class System, class F>
void for_each_place(System& system, F&& f) {
  std::size_t i = 0;
  const auto slot = [&](auto& of) {
    if (first_port<System>(i) == i) f(std::string(System::ports[i].element), of.laws, of.active);
    ++i;
  };
  std::apply([&](auto&... each) { (slot(each), ...); }, system.slot);
  const auto chain = [&](const std::string& element, auto& of) {
    if constexpr (std::decay_t<decltype(of)>::size > 0) f(element, of.laws, of.active);
  };
  chain("load", system.load);
  chain("actuation", system.actuation);
  for (std::size_t c = 0; c < System::outputs.size(); ++c)
    chain("sensor." + std::string(System::outputs[c].name), system.sensor[c]);
}

/// Calls f(element, law, is_active bit) for each law in each place.
template <class System, class F>
void for_each_law(System& system, F&& f) {
  for_each_place(system, [&](const std::string& element, auto& laws, unsigned& active) {
    unsigned bit = 1;
    std::apply([&](auto&... law) { ((f(element, law, active, bit), bit <<= 1), ...); }, laws);
  });
}

template <class Law, class = void>
struct PartnerOf {
  static constexpr std::string_view name = Law::name;
};
template <class Law>
struct PartnerOf<Law, std::void_t<decltype(Law::shares_with)>> {
  static constexpr std::string_view name = Law::shares_with;
};
/// Whose parameter it is: its law, in an element. What the law's partner (`shares_with`) calls by the same name in the
/// same element is one number, and the partner's.
struct Holder {
  std::string element;
  std::string_view law, partner;
  bool holds(const std::string& in_element, std::string_view of_law) const {
    return in_element == element && (of_law == law || of_law == partner);
  }
};

/// Calls f(holder, table entry, field) for each parameter; the system's own have neither element nor law.
template <class System, class F>
void for_each_parameter_of(System& system, F&& f) {
  for_each_parameter<System>([&](const auto& p) { f(Holder{}, p, system.*p.field); });
  for_each_law(system, [&](const std::string& element, auto& law, unsigned, unsigned) {
    using Law = std::decay_t<decltype(law)>;
    const Holder holder{element, Law::name, PartnerOf<Law>::name};
    for_each_parameter<Law>([&](const auto& p) { f(holder, p, law.*p.field); });
  });
}

template <class System>
bool is_structural(const std::string& effect) {
  for (const auto& name : System::structural)
    if (effect == name) return true;
  return false;
}

/// The public name of a parameter: <element>_<own name>, except where the system renames it or keeps its nominal
/// effects plain.
template <class System>
std::string parameter_name(const std::string& element, std::string_view law, std::string_view own) {
  if (element.empty()) return std::string(own);
  for (const auto& other : System::renamed)
    if (other.effect == element + ":" + std::string(law) && other.own == own) return std::string(other.name);
  if (System::plain_names)
    for (const auto& nominal : System::nominal)
      if (nominal == element + ":" + std::string(law)) return std::string(own);
  return element + "_" + std::string(own);
}
}  // namespace tendonlab::systems
