#include "tendonlab/models/describe.hpp"

#include <algorithm>

namespace tendonlab::systems {
namespace {
/// "bushing_1" as "bushing 1".
std::string spaced(std::string name) {
  for (char& c : name)
    if (c == '_' || c == '.') c = ' ';
  return name;
}
}  // namespace

unsigned active_bits(const Configuration& of, std::size_t first, std::size_t count) {
  unsigned bits = 0;
  for (std::size_t i = 0; i < count; ++i)
    if (of.active[first + i]) bits |= 1u << i;
  return bits;
}

Describe::Describe(SystemFacts of) : system(std::move(of)) {
  SystemInfo& info = description.info;
  info.kind = system.name, info.equation = system.equation, info.dof = system.stated;
  info.commanded = system.commanded, info.sampled = system.sampled, info.steady = system.steady;
  info.inputs.assign(system.inputs.begin(), system.inputs.end());
  info.outputs.assign(system.outputs.begin(), system.outputs.end());
  for (const auto& port : system.ports)
    info.ports.push_back({std::string(port.name), std::string(port.element), port.load});
  for (const auto& name : system.nominal) info.nominal.emplace_back(name);
}

void Describe::add_own(const std::vector<ParameterInfo>& parameters) {
  for (const ParameterInfo& p : parameters) {
    description.parameter_of_field.push_back(description.info.parameters.size());
    description.info.parameters.push_back(p);
  }
}

/// In the order of the walk (assemble.hpp): each element with ports once, and again for the effort that it passes on.
std::vector<std::string> Describe::place_names() const {
  std::vector<std::string> all;
  for (const Port* port = system.ports.begin(); port != system.ports.end(); ++port) {
    const auto shares = [port](const Port& other) { return other.element == port->element; };
    if (std::any_of(system.ports.begin(), port, shares)) continue;
    all.emplace_back(port->element);
    if (port->element == system.passing) all.emplace_back(system.passing);
  }
  if (system.load) all.emplace_back("load");
  if (system.actuation) all.emplace_back("actuation");
  if (system.sensors)
    for (const Output& output : system.outputs) all.push_back("sensor." + std::string(output.name));
  return all;
}

void Describe::add_place(const std::vector<const std::type_info*>& laws) {
  const std::string& name = *next_place++;
  if (element != name) {  // the laws of the effort that an element passes on follow those of its slot
    element = name;
    description.info.elements.push_back({element, axis(), place_words(), acts_on()});
  }
  for (const std::type_info* law : laws) add_law(law_facts(*law));
}

void Describe::add_law(const LawFacts& law) {
  const std::string name = effect_name(law.name);
  EffectInfo effect{name,
                    element,
                    std::string(law.name),
                    std::string(law.group),
                    std::string(law.noun),
                    std::string(law.noun) + " " + place_words(),
                    std::string(law.equation),
                    std::string(law.source),
                    std::string(law.summary),
                    {},
                    {},
                    law.roles,
                    law.sees,
                    is_structural(name)};
  for (const ParameterInfo& p : law.parameters) {
    description.parameter_of_field.push_back(add(law.partner, p));
    const auto& owner = description.info.parameters[description.parameter_of_field.back()];
    const std::string holding = owner.element + ":" + owner.effect;
    if (owner.effect == law.name)
      effect.parameters.push_back(owner.name);
    else if (!is_structural(holding))  // structural effects are always there
      effect.needs.push_back(holding);
  }
  for (ParameterInfo& p : description.info.parameters)
    if (p.element.empty() && p.effect == name) {  // of the system, read by this effect alone
      p.element = element, p.effect = law.name;
      effect.parameters.push_back(p.name);
    }
  description.info.effects.push_back(std::move(effect));
}

std::size_t Describe::add(std::string_view partner, ParameterInfo own) {
  auto& all = description.info.parameters;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].own == own.own && all[i].element == element && (all[i].effect == own.effect || all[i].effect == partner))
      return i;
  own.name = parameter_name(own.effect, own.own), own.element = element;
  all.push_back(under_load(std::move(own)));
  return all.size() - 1;
}

const Place* Describe::find_place() const {
  for (const Place& place : system.places)
    if (place.element == element) return &place;
  for (const Place& place : usual_places)
    if (place.element == element) return &place;
  return nullptr;
}
std::string Describe::place_words() const {
  if (const Place* place = find_place()) return std::string(place->words);
  constexpr std::string_view sensor = "sensor.";
  if (element.compare(0, sensor.size(), sensor) == 0)
    return "of the " + spaced(element.substr(sensor.size())) + " sensor";
  const bool numbered = '0' <= element.back() && element.back() <= '9';
  return (numbered ? "in " : "in the ") + spaced(element);
}
std::string Describe::acts_on() const {
  const Place* place = find_place();
  for (const auto& port : system.ports)
    if (port.element == element || (place != nullptr && port.element == place->acts_on))
      return std::string(port.element);
  return std::string(system.ports.begin()->element);
}
std::string Describe::axis() const {
  for (const auto& port : system.ports)
    if (port.element == element && port.axis != Axis::of_system) return port.axis == Axis::rotary ? "rotary" : "linear";
  return {};
}

/// <element>_<own name>, except where the system renames it or keeps its nominal effects plain.
std::string Describe::parameter_name(std::string_view law, std::string_view own) const {
  if (element.empty()) return std::string(own);
  for (const auto& other : system.renamed)
    if (other.effect == effect_name(law) && other.own == own) return std::string(other.name);
  if (system.plain_names)
    for (const auto& nominal : system.nominal)
      if (nominal == effect_name(law)) return std::string(own);
  return element + "_" + std::string(own);
}
bool Describe::is_structural(const std::string& effect) const {
  for (const auto& name : system.structural)
    if (effect == name) return true;
  return false;
}
/// The parameter with what an effort per load is under the load of its element.
ParameterInfo Describe::under_load(ParameterInfo p) const {
  if (p.dimension != Dimension::effort_per_load) return p;
  for (const auto& port : system.ports)
    if (port.element == p.element && port.load == Dimension::ratio) {
      p.dimension = Dimension::effort, p.upper = inf;
      return p;
    }
  p.dimension = Dimension::ratio;
  return p;
}
}  // namespace tendonlab::systems
