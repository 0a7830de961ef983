#pragma once
// What reports call the elements of a system. An effect is called by its law's noun and its element's place:
// "Stribeck friction" + "at the joint".
#include <array>
#include <string_view>

namespace tendonlab::systems {
/// `words`: a preposition and the element, "at the joint"; without the preposition they name the element alone.
/// An element without a row: "in the gear", "in bushing 1", "of the joint angle sensor".
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
}  // namespace tendonlab::systems
