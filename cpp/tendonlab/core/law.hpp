#pragma once
// What a law is: it sees the sliding at its port and answers in one or more roles. No law knows a sign; the slot does.
#include "tendonlab/core/parameter.hpp"

namespace tendonlab {
/// What a law sees at an instant. `direction` and `side` are modes: the stepper freezes them, nothing computes them.
template <class S>
struct Sliding {
  S velocity{}, position{}, load{};  ///< load: effort that the element carries, signed; laws take its magnitude
  Plain<S> direction{};              ///< +1 or -1; 0 while the port sticks
  Plain<S> side{};                   ///< flank of a gap that touches: -1, 0 (none), +1
  S wrap{};                          ///< wrap angle of the cable on its contact, rad
  S preload{};                       ///< effort that the pretension of the element holds
  S skew{};                          ///< curvature at the output end of a sheath over its mean, less one
  S speed() const { return direction * velocity; }  ///< |v|, continued smoothly past zero
};
/// sees_direction: the sense of sliding matters although the law makes no dry friction of its own.
enum Sees : unsigned {
  sees_nothing = 0,
  sees_velocity = 1,
  sees_position = 2,
  sees_load = 4,
  sees_wrap = 8,
  sees_preload = 16,
  sees_direction = 32
};

/// Every law states its `name` (in code), its `noun` (what reports call the effect, without the place: "Stribeck
/// friction"), `equation`, `source` and `summary`.

/// How laws combine in a slot; a law may have several roles. motion: changes what the later ones see; level: adds to
/// the dry friction; factor: multiplies it; force: adds; memory: has a state; refines: says how the dry friction of
/// other laws goes, and nothing by itself; whole: all the friction of its slot, a simulator's own choice and no term
/// that one may lack.
namespace role {
enum : unsigned { motion = 1, level = 2, factor = 4, force = 8, memory = 16, refines = 32, whole = 64 };
}

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
