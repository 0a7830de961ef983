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
#include "tendonlab/systems/signals.hpp"
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
/// The parameter that makes a current, a voltage or a number of a command an effort: 1 where commands are efforts.
template <class System, class T>
constexpr auto command_gain(T System::*field) {
  return parameter(field, "torque_constant", Dimension::effort_per_command, Purpose::structure, 1.0, -inf, inf,
                   "effort per unit of the command; known unless sd says otherwise", ParameterRole::command_gain);
}
/// Where the friction of a single joint sits between motor and load: 0 at the motor's shaft, where all effort of the
/// motor passes, 1 at the load. Only friction that depends on the load reads it.
template <class System, class T>
constexpr auto motor_inertia_share(T System::*field) {
  return parameter(field, "motor_inertia_share", Dimension::ratio, Purpose::shape, 0.5, 0.0, 1.0,
                   "share of the inertia on the motor's side of the friction", ParameterRole::motor_inertia_share)
      .of_effect("joint:load_dependence");
}
/// One joint that a motor turns against gravity, with what is known to act on it. Its friction sees what the motor
/// delivers less what the inertia on the motor's side takes.
template <class S, class T>
Coupling<S, 1, 1> single_joint(const Motion<S, 1>& at, const Plain<S>& direction, const S& motor, const S& gravity,
                               const S& known, const T& motor_inertia_share) {
  Coupling<S, 1, 1> c;
  c.port[0].velocity = at.velocity[0];
  c.port[0].position = at.position[0];
  c.port[0].load = motor - motor_inertia_share * (motor - gravity + known);
  c.port[0].direction = direction;
  c.applied[0] = motor - gravity + known;
  return c;
}
enum class Axis { of_system, rotary, linear };
/// Where a slot sits. Written with words: `port("bushing_1").along(Axis::linear).turns(motor_sense)`. -1 is no mode.
struct Port {
  std::string_view element;  ///< ports of one element carry the same laws with the same parameters
  std::string_view name;
  Axis axis = Axis::of_system;         ///< what it slides along
  Dimension load = Dimension::effort;  ///< of the load that the slot sees
  int direction = -1, side = -1;       ///< modes: direction of sliding, flank of a gap
  int direction_while_driven = -1;     ///< mode of the direction in experiments that give the system's input `driver`
  bool driven = false;                 ///< inputs prescribe its velocity: it never sticks
  bool is_mirrored = false;            ///< slides backwards where the port that its laws are stated for slides forwards

  /// A name of its own, where several ports share an element.
  constexpr Port named(std::string_view own) const {
    Port p = *this;
    p.name = own;
    return p;
  }
  constexpr Port along(Axis what) const {
    Port p = *this;
    p.axis = what;
    return p;
  }
  constexpr Port loaded_by(Dimension what) const {
    Port p = *this;
    p.load = what;
    return p;
  }
  /// Its force depends on the direction of sliding, which is this mode.
  constexpr Port turns(int mode) const {
    Port p = *this;
    p.direction = mode;
    return p;
  }
  /// Its direction is that of the last motion that inputs prescribed.
  constexpr Port turns_as_driven(int mode) const {
    Port p = turns(mode);
    p.driven = true;
    return p;
  }
  /// Driven only in experiments that give the system's input `driver`; its direction is then this mode.
  constexpr Port while_driven(int mode) const {
    Port p = *this;
    p.direction_while_driven = mode;
    return p;
  }
  constexpr Port mirrored() const {
    Port p = *this;
    p.is_mirrored = true;
    return p;
  }
  /// It has a gap, whose flank is this mode.
  constexpr Port with_gap(int mode) const {
    Port p = *this;
    p.side = mode;
    return p;
  }
};
constexpr Port port(std::string_view element) {
  return {element, element};
}

/// The public name of a parameter where it is not made by the rule: {effect, own name, public name}.
struct Renamed {
  std::string_view effect, own, name;
};

/// What a system states. It inherits these defaults, overrides what differs, and must state
///   name, equation, dof, ports, inputs, outputs;
///   parameters(): the table of its own parameters; prepare(): what follows from them, once;
///   slot: a tuple with a Slot for each port; load, actuation: a Chain; sensor: a Chain for each output.
/// A system with a differential equation also states
///   joined[port][dof]: false where the lever is always 0; rigid_shape(): how far each degree of freedom moves with the
///   first if nothing stretches; lever and inverse_inertia: set by prepare() or, if `moving`, returned by couple;
///   couple(motion, modes, inputs): what the ports see, and what else acts; observe(motion, force, port): the outputs.
/// A sampled system states `evaluate` instead (systems/sampled.hpp).
struct SystemDefaults {
  static constexpr int directions = 0, sides = 0;  ///< number of modes: directions of sliding, flanks of gaps
  /// Degrees of freedom whose initial state an experiment states, -1 for all. Those after them have next to no inertia:
  /// begin(motion, inputs) places them, and their velocities, which follow the forces at once, are not judged.
  static constexpr int stated = -1;
  static constexpr int driver = -1;                 ///< the input that, where given, drives ports `while_driven`
  static constexpr bool moving = false;             ///< levers and inverse inertias change with the motion
  static constexpr bool sampled = false;            ///< answers sample by sample, without a differential equation
  static constexpr bool commanded = false;          ///< input 0 is the command of an actuator: state effort_per_command
  static constexpr bool plain_names = false;        ///< parameters of nominal effects carry no element in front
  static constexpr std::string_view grown_by = {};  ///< the effect that replaces the system by its `Grown`
  static constexpr std::array<std::string_view, 0> structural{}, nominal{};  ///< effects always there, and by default
  static constexpr std::array<Renamed, 0> renamed{};
  static constexpr std::array<Place, 0> places{};  ///< words for its own elements
  static constexpr std::string_view passing{};     ///< element whose effort passes the laws of a Chain `passed`
  struct Carried {};                               ///< what a sampled system remembers besides its slots
  void prepare() {}
};

template <class System>
inline constexpr int stated = System::stated < 0 ? System::dof : System::stated;

template <class System>
constexpr bool drives_a_port() {
  for (const Port& port : System::ports)
    if (port.driven || port.direction_while_driven >= 0) return true;
  return false;
}
/// The first port of the element of port i: its slot speaks for the others.
template <class System>
constexpr std::size_t first_port(std::size_t i) {
  std::size_t first = 0;
  while (System::ports[first].element != System::ports[i].element) ++first;
  return first;
}
/// Is the input given that drives ports which without it move freely?
template <class System, class Inputs>
bool is_driven(const Inputs& in) {
  if constexpr (System::driver >= 0)
    return in.template given<System::driver>();
  else
    return static_cast<void>(in), false;
}
}  // namespace tendonlab::systems
