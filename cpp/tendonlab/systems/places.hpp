#pragma once
// What reports call the elements of a system. An effect is called by its law's noun and its element's place:
// "Stribeck friction" + "at the joint".
#include <array>
#include <string>
#include <string_view>

namespace tendonlab::systems {
/// `words`: a preposition and the element, "at the joint"; without the preposition they name the element alone.
/// `acts_on`: for a place without ports, the element whose motion and effort it shares; without one that of port 0.
struct Place {
  std::string_view element, words, acts_on = {};
};
/// Elements that mean the same in most systems. A system's own `places` come first.
inline constexpr Place usual_places[] = {{"joint", "at the joint"},
                                         {"motor", "at the motor"},
                                         {"contact", "at the pulley contact"},
                                         {"load", "on the load", "joint"},
                                         {"actuation", "of the actuator"}};

/// "bushing_1" as "bushing 1".
inline std::string spaced(std::string name) {
  for (char& c : name)
    if (c == '_' || c == '.') c = ' ';
  return name;
}
template <class System>
const Place* find_place(const std::string& element) {
  for (const Place& place : System::places)
    if (place.element == element) return &place;
  for (const Place& place : usual_places)
    if (place.element == element) return &place;
  return nullptr;
}
/// The place of an element in words. Elements without a row: "in the gear", "in bushing 1", "of the joint angle
/// sensor".
template <class System>
std::string place_words(const std::string& element) {
  if (const Place* place = find_place<System>(element)) return std::string(place->words);
  constexpr std::string_view sensor = "sensor.";
  if (element.compare(0, sensor.size(), sensor) == 0)
    return "of the " + spaced(element.substr(sensor.size())) + " sensor";
  const bool numbered = '0' <= element.back() && element.back() <= '9';
  return (numbered ? "in " : "in the ") + spaced(element);
}
template <class System>
std::string acts_on(const std::string& element) {
  const Place* place = find_place<System>(element);
  for (const auto& port : System::ports)
    if (port.element == element || (place != nullptr && port.element == place->acts_on))
      return std::string(port.element);
  return std::string(System::ports[0].element);
}
}  // namespace tendonlab::systems
