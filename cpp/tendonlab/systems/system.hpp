#pragma once
// How elements join: what every system states, and nothing about how it is solved.
#include <string_view>

#include "tendonlab/actuation/all.hpp"
#include "tendonlab/core/chain.hpp"
#include "tendonlab/core/slot.hpp"
#include "tendonlab/friction/all.hpp"
#include "tendonlab/loading/all.hpp"
#include "tendonlab/sensing/all.hpp"
#include "tendonlab/transmission/all.hpp"

namespace tendonlab::systems {
/// Position, velocity and time of a system with n degrees of freedom.
template <class S, int n>
struct Motion {
  std::array<S, n> position{}, velocity{};
  S time{};
};
/// What each port sees, and what acts on each degree of freedom besides the ports.
template <class S, int ports, int n>
struct Coupling {
  std::array<Sliding<S>, ports> port{};
  std::array<S, n> applied{};
};
/// Where a slot sits: its element, whether its force depends on the direction of its sliding (and which mode that is),
/// whether it has a gap (and which mode is its side). A mode -1 is none.
struct Port {
  std::string_view element;
  int direction = -1, side = -1;
};
struct Input {
  std::string_view name, meaning;
  Dimension dimension;
  bool required;
};
/// An output; `axis` is the degree of freedom whose angle it is, -1 for anything else.
struct Output {
  std::string_view name, meaning;
  Dimension dimension;
  int axis;
};
}  // namespace tendonlab::systems
