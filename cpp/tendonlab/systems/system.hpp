#pragma once
// How elements join: what every system states, and nothing about how it is solved.
#include <string_view>

#include "tendonlab/actuation/all.hpp"
#include "tendonlab/core/chain.hpp"
#include "tendonlab/core/slot.hpp"
#include "tendonlab/friction/all.hpp"
#include "tendonlab/loading/all.hpp"
#include "tendonlab/sensing/all.hpp"
#include "tendonlab/systems/places.hpp"
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
/// The same where the geometry moves: levers and inverse inertias are functions of the motion.
template <class S, int ports, int n>
struct MovingCoupling : Coupling<S, ports, n> {
  S lever[ports][n]{};
  std::array<S, n> inverse_inertia{};
};
enum class Axis { of_system, rotary, linear };
/// Where a slot sits: its element, whether its force depends on the direction of its sliding (and which mode that is),
/// whether it has a gap (and which mode is its side); a mode -1 is none. `axis`: what it slides along. `driven`: its
/// velocity is prescribed by inputs, so it never sticks: its direction is that of the last motion. Ports of one element
/// carry the same laws with the same parameters; each then has a `name` of its own. `load`: what that is which the slot
/// sees as its load. `while_driven`: where it is driven only in experiments that give the system's input `driver`, the
/// mode of its direction in these.
struct Port {
  std::string_view element;
  int direction = -1, side = -1;
  Axis axis = Axis::of_system;
  bool driven = false;
  std::string_view name = {};
  Dimension load = Dimension::effort;
  int while_driven = -1;
};
/// What a logged input is between its samples: held, straight, or a smooth curve that may be differentiated.
enum class Between { hold, linear, smooth };
/// `unless`: an input that takes the place of this one where it was logged. `missed`: optional since a rig may lack the
/// part that it drives; where it was not logged although a measured output depends on it, users are told that it is 0.
struct Input {
  std::string_view name, meaning;
  Dimension dimension;
  bool required;
  Between between;
  std::string_view unless = {};
  bool missed = false;
};
/// The public name of a parameter where it is not made by the rule: {effect, own name, public name}.
struct Renamed {
  std::string_view effect, own, name;
};

// What a system need not state.
template <class System, class = void>
struct MovingOf : std::false_type {};
template <class System>
struct MovingOf<System, std::enable_if_t<System::moving>> : std::true_type {};
/// Does its geometry move?
template <class System>
inline constexpr bool moving = MovingOf<System>::value;

template <class System, class = void>
struct SampledOf : std::false_type {};
template <class System>
struct SampledOf<System, std::enable_if_t<System::sampled>> : std::true_type {};
/// Does it answer sample by sample, without a differential equation?
template <class System>
inline constexpr bool sampled = SampledOf<System>::value;

template <class System, class = void>
struct RenamedOf {
  static constexpr std::array<Renamed, 0> list{};
};
template <class System>
struct RenamedOf<System, std::void_t<decltype(System::renamed)>> {
  static constexpr auto& list = System::renamed;
};
/// Do its outputs show what its ports see, beside what they do? Then `observe` also takes a function of a port.
template <class System, class T, class Force, class Port, class = void>
inline constexpr bool observes_ports = false;
template <class System, class T, class Force, class Port>
inline constexpr bool
    observes_ports<System, T, Force, Port,
                   std::void_t<decltype(std::declval<const System&>().observe(
                       std::declval<const Motion<T, System::dof>&>(), std::declval<Force>(), std::declval<Port>()))>> =
        true;

template <class System, class = void>
struct StatedOf : std::integral_constant<int, System::dof> {};
template <class System>
struct StatedOf<System, std::enable_if_t<(System::stated > 0)>> : std::integral_constant<int, System::stated> {};
/// The degrees of freedom whose initial state an experiment states. Those after them have next to no inertia: `begin`
/// of the system places them, and their velocities, which follow the forces at once, are not judged step by step.
template <class System>
inline constexpr int stated = StatedOf<System>::value;

template <class System, class = void>
struct GradientWordsOf : std::integral_constant<int, 1> {};
template <class System>
struct GradientWordsOf<System, std::enable_if_t<(System::gradient_words > 0)>>
    : std::integral_constant<int, System::gradient_words> {};
/// How many eights of derivatives one simulation carries: more cost time to compile, fewer to run.
template <class System>
inline constexpr int gradient_words = GradientWordsOf<System>::value;

template <class System>
constexpr bool drives_a_port() {
  for (const auto& port : System::ports)
    if (port.driven || port.while_driven >= 0) return true;
  return false;
}
template <class System, class = void>
struct DriverOf : std::integral_constant<int, -1> {};
template <class System>
struct DriverOf<System, std::enable_if_t<(System::driver >= 0)>> : std::integral_constant<int, System::driver> {};
/// Is the input given that drives ports which without it move freely?
template <class System, class Inputs>
bool is_driven(const Inputs& in) {
  if constexpr (DriverOf<System>::value >= 0)
    return in.template given<DriverOf<System>::value>();
  else
    return static_cast<void>(in), false;
}
/// An output; `axis` is the degree of freedom whose angle it is, -1 for anything else.
struct Output {
  std::string_view name, meaning;
  Dimension dimension;
  int axis;
};
}  // namespace tendonlab::systems
