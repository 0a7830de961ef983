#pragma once
// What a law is: it sees the sliding at its port and answers in one or more roles. No law knows a sign; the slot does.
#include "tendonlab/core/parameter.hpp"

namespace tendonlab {
/// Which fields of a Sliding a law reads. sees_direction: the sense of sliding matters although the law makes no dry
/// friction of its own.
enum Sees : unsigned {
  sees_nothing = 0,
  sees_velocity = 1,
  sees_position = 2,
  sees_load = 4,
  sees_wrap = 8,
  sees_preload = 16,
  sees_direction = 32
};

/// What a law sees at an instant. `direction` and `side` are modes: the stepper freezes them, nothing computes them. A
/// system whose laws see more than this derives a port of its own from it.
template <class S>
struct Sliding {
  using Scalar = S;
  S velocity{}, position{}, load{};  ///< load: effort that the element carries, signed; laws take its magnitude
  Plain<S> direction{};              ///< +1 or -1; 0 while the port sticks
  Plain<S> side{};                   ///< flank of a gap that touches: -1, 0 (none), +1
  S wrap{};                          ///< wrap angle of the cable on its contact, rad
  S preload{};                       ///< effort that the pretension of the element holds
  S speed() const { return direction * velocity; }  ///< |v|, continued smoothly past zero

  /// Calls f(name, its bit of Sees, access) for each quantity: access(port) is that field, whatever the port's scalar.
  template <class F>
  static TENDONLAB_INLINE constexpr void for_each_field(F&& f) {
    f(
        "velocity", sees_velocity, [](auto& port) -> auto& { return port.velocity; });
    f(
        "position", sees_position, [](auto& port) -> auto& { return port.position; });
    f(
        "load", sees_load, [](auto& port) -> auto& { return port.load; });
    f(
        "wrap_angle", sees_wrap, [](auto& port) -> auto& { return port.wrap; });
    f(
        "preload", sees_preload, [](auto& port) -> auto& { return port.preload; });
  }
};
/// The same port with its quantities as another scalar; its modes stay.
template <class D, template <class> class Port, class S>
Port<D> with_scalar(const Port<S>& of) {
  Port<D> out;
  out.direction = of.direction, out.side = of.side;
  Port<S>::for_each_field([&](std::string_view, unsigned, auto access) { access(out) = D(access(of)); });
  return out;
}

/// Every law states its `name` (in code), its `noun` (what reports call the effect, without the place: "Stribeck
/// friction"), `equation`, `source` and `summary`.

/// How laws combine in a slot or chain; a law may have several roles. motion: changes what the later laws see; level:
/// adds to the dry friction; factor: multiplies it; force: adds; memory: has a state with a rate; refines: shapes the
/// dry friction of other laws and makes none itself; whole: all the friction of its slot, so no other law joins it;
/// gain: multiplies the effort that the element passes on; signal: acts on a signal, in a chain (core/chain.hpp); dry:
/// a force that turns with the direction of motion, which is dry friction beside the level.
namespace role {
enum : unsigned {
  motion = 1,
  level = 2,
  factor = 4,
  force = 8,
  memory = 16,
  refines = 32,
  whole = 64,
  gain = 128,
  signal = 256,
  dry = 512
};
}

/// Members that a law states only where it needs them:
///   T lateness() const;   time by which it shifts a signal, s, else 0
///   T half_gap() const;   half of the gap that it leaves open in a motion, else 0
///   T dry_share() const;  share of the dry friction that its memory leaves to the slot, else 1
///   bool mirrored;        is told whether its port is
/// A law's parameters may be plain numbers where what it sees is a pack of ports: nothing seen is converted to T.
template <class Law, class = void>
inline constexpr bool delays_signal = false;
template <class Law>
inline constexpr bool delays_signal<Law, std::void_t<decltype(&Law::lateness)>> = true;
template <class Law, class = void>
inline constexpr bool opens_gap = false;
template <class Law>
inline constexpr bool opens_gap<Law, std::void_t<decltype(&Law::half_gap)>> = true;
template <class Law, class = void>
inline constexpr bool takes_over_dry_friction = false;
template <class Law>
inline constexpr bool takes_over_dry_friction<Law, std::void_t<decltype(&Law::dry_share)>> = true;

template <class Law, class = void>
inline constexpr bool asks_if_mirrored = false;
template <class Law>
inline constexpr bool asks_if_mirrored<Law, std::void_t<decltype(&Law::mirrored)>> = true;

/// A closed list of laws, in the order in which reports show them and slots apply them.
template <template <class> class... Law>
struct Laws {
  static constexpr int count = sizeof...(Law);
  template <class T>
  using With = std::tuple<Law<T>...>;
  template <class F>
  static constexpr void for_each(F&& f) {
    (f(static_cast<Law<double>*>(nullptr)), ...);
  }
};
template <class... List>
struct Joined;
template <template <class> class... A>
struct Joined<Laws<A...>> {
  using type = Laws<A...>;
};
template <template <class> class... A, template <class> class... B, class... Rest>
struct Joined<Laws<A...>, Laws<B...>, Rest...> : Joined<Laws<A..., B...>, Rest...> {};

template <unsigned what, class List>
struct SeeingOf;
template <unsigned what, template <class> class... Law>
struct SeeingOf<what, Laws<Law...>> {
  template <template <class> class One>
  using Kept = std::conditional_t<(One<double>::sees & what) != 0, Laws<One>, Laws<>>;
  using type = typename Joined<Laws<>, Kept<Law>...>::type;
};
template <unsigned what, class List>
struct WithoutOf;
template <unsigned what, template <class> class... Law>
struct WithoutOf<what, Laws<Law...>> {
  template <template <class> class One>
  using Kept = std::conditional_t<(One<double>::roles & what) == 0, Laws<One>, Laws<>>;
  using type = typename Joined<Laws<>, Kept<Law>...>::type;
};
/// The laws of `List` that play no role of `what`, e.g. those without memory.
template <unsigned what, class List>
using Without = typename WithoutOf<what, List>::type;
/// The laws of `List` that look at `what`, e.g. those whose friction depends on the load.
template <unsigned what, class List>
using Seeing = typename SeeingOf<what, List>::type;
}  // namespace tendonlab
