#pragma once
// The rate of a system, from the one text of its laws, with sticking ports held at rest. linearise.hpp states the same
// equation of motion with its partials: values alone, in seven of eight stages, cost a fraction of that.
#include <algorithm>

#include "tendonlab/systems/system.hpp"

namespace tendonlab::integrate {
using systems::Coupling;
using systems::Motion;

template <class F, std::size_t... i>
TENDONLAB_INLINE constexpr void unroll(std::index_sequence<i...>, F&& f) {
  (f(std::integral_constant<int, static_cast<int>(i)>{}), ...);
}
template <int n, class F>
TENDONLAB_INLINE constexpr void unroll(F&& f) {
  unroll(std::make_index_sequence<static_cast<std::size_t>(n)>{}, f);
}

template <class System, int i>
using SlotOf = std::tuple_element_t<static_cast<std::size_t>(i), decltype(System::slot)>;
template <class System>
inline constexpr int slots = static_cast<int>(std::tuple_size_v<decltype(System::slot)>);
/// Where the memory of slot i begins.
template <class System, int i = slots<System>>
constexpr int memory_before() {
  if constexpr (i == 0)
    return 0;
  else
    return memory_before<System, i - 1>() + SlotOf<System, i - 1>::states;
}
template <class System>
inline constexpr int memories = memory_before<System>();
/// Modes: the directions of sliding, then the sides of gaps.
template <class System>
inline constexpr int modes = System::directions + System::sides;

template <class S, int dof, int nz>
struct State {
  Motion<S, dof> at;
  std::array<S, static_cast<std::size_t>(nz)> memory{};
};
template <class System, class T>
using StateOf = State<T, System::dof, memories<System>>;
/// A state of which `f` gives each number.
template <class To, class S, int dof, int nz, class F>
TENDONLAB_INLINE State<To, dof, nz> number_by_number(const State<S, dof, nz>& y, F&& f) {
  State<To, dof, nz> out;
  for (std::size_t j = 0; j < dof; ++j) {
    out.at.position[j] = f(y.at.position[j]);
    out.at.velocity[j] = f(y.at.velocity[j]);
  }
  out.at.time = f(y.at.time);
  for (std::size_t i = 0; i < nz; ++i) out.memory[i] = f(y.memory[i]);
  return out;
}
/// A state without its derivatives.
template <class S, int dof, int nz>
State<double, dof, nz> values(const State<S, dof, nz>& y) {
  return number_by_number<double>(y, [](const S& x) { return plain(x); });
}
template <int dof, int nz>
const State<double, dof, nz>& values(const State<double, dof, nz>& y) {
  return y;
}
/// A state in the scalar of decisions: itself but where it has derivatives.
template <class S, int dof, int nz>
TENDONLAB_INLINE decltype(auto) plainly(const State<S, dof, nz>& y) {
  if constexpr (std::is_same_v<Plain<S>, S>)
    return (y);
  else
    return values(y);
}
/// A state with derivatives of 0.
template <class T, int dof, int nz>
TENDONLAB_INLINE State<T, dof, nz> lifted(const State<double, dof, nz>& y) {
  return number_by_number<T>(y, [](double x) { return T(x); });
}
template <class S, int dof, int nz>
struct Rate {
  std::array<S, static_cast<std::size_t>(dof)> acceleration{};
  std::array<S, static_cast<std::size_t>(nz)> memory{};
};

/// What is frozen over a step: the modes, and the projection that keeps sticking ports at rest.
template <class System, class T>
struct Frame {
  std::array<Plain<T>, static_cast<std::size_t>(modes<System>)> mode{};
  bool holds = false;  ///< does any port stick?
  T keep[System::dof][System::dof];

  /// Accelerations after the sticking ports have taken their share.
  template <class Column>
  void project(Column&& column) const {
    constexpr int n = System::dof;
    T free[n];
    for (int j = 0; j < n; ++j) free[j] = column(j);
    for (int j = 0; j < n; ++j) {
      T sum(0.0);
      for (int l = 0; l < n; ++l) sum = sum + keep[j][l] * free[l];
      column(j) = sum;
    }
  }
};

/// Levers and inverse inertias: of the system, or of its coupling where the geometry moves.
template <class System, class Coupled>
TENDONLAB_INLINE const auto& geometry_of(const System& system, const Coupled& coupled) {
  if constexpr (System::moving)
    return coupled;
  else
    return system;
}

/// Whether the rate is one piece of code with its laws: faster for plain numbers in a system of few slots. Elsewhere
/// calls cost nothing against the work, and one copy of each law stays in the cache.
template <class System, class T>
inline constexpr bool inlines_laws = (std::is_same_v<T, double> || in_lanes<T>)&&(slots<System> < 5);

/// `system.couple`, compiled once for each scalar.
template <class System, class S, int n, class Modes, class Inputs>
[[gnu::noinline, gnu::flatten]] auto couple(const System& system, const Motion<S, n>& at, const Modes& mode,
                                            const Inputs& in) {
  return system.couple(at, mode, in);
}
template <bool inlines, class System, class S, int n, class Modes, class Inputs>
TENDONLAB_INLINE auto couple_for_step(const System& system, const Motion<S, n>& at, const Modes& mode,
                                      const Inputs& in) {
  if constexpr (inlines)
    return system.couple(at, mode, in);
  else
    return couple(system, at, mode, in);
}
/// `slot.respond`, compiled once for each type of slot and scalar.
template <class Slot, class Port, class S>
[[gnu::noinline, gnu::flatten]] Response<S> respond(const Slot& slot, const Port& at, const S& z) {
  return slot.respond(at, z);
}
template <bool inlines, class Slot, class Port, class S>
TENDONLAB_INLINE Response<S> respond_for_step(const Slot& slot, const Port& at, const S& z) {
  if constexpr (inlines)
    return slot.respond(at, z);
  else
    return respond(slot, at, z);
}

/// How many ports from i on are one element, answered by one pass of its laws, side by side: 1 where that would save
/// nothing, 0 for those that an earlier port speaks for. Only in plain simulations of one point: elsewhere the words of
/// the processor are filled by lanes or directions.
template <class System, class T, int i>
constexpr int num_together() {
  constexpr int fewest = 3, most = 4;  // a pair would leave half of a pack empty
  if constexpr (!std::is_same_v<T, double> || SlotOf<System, i>::asks_if_mirrored()) {
    return 1;
  } else {
    constexpr auto first = static_cast<int>(systems::first_port<System>(i));
    int run = 0;
    while (first + run < slots<System> &&
           System::ports[static_cast<std::size_t>(first + run)].element == System::ports[first].element)
      ++run;
    const int all = run / most * most + (run % most >= fewest ? run % most : 0), place = i - first;
    if (place >= all) return 1;
    return place % most > 0 ? 0 : std::min(most, all - place);
  }
}
/// What several ports see, side by side; the last one fills up.
template <class P, class Slot, int count, class Port>
TENDONLAB_INLINE Sliding<P> side_by_side(const Port* port) {
  const auto lanes = [&](auto of) TENDONLAB_ALWAYS {
    return by_lane<P>([&](int l) TENDONLAB_ALWAYS { return of(port[l < count ? l : count - 1]); });
  };
  Sliding<P> all;
  all.direction = lanes([](const auto& one) { return one.direction; });
  all.side = lanes([](const auto& one) { return one.side; });
  Sliding<P>::for_each_field([&](std::string_view, unsigned bit, auto access) TENDONLAB_ALWAYS {
    if ((Slot::sees & bit) != 0)
      access(all) = lanes([&](const auto& one) TENDONLAB_ALWAYS { return plain(access(one)); });
  });
  return all;
}
/// The memories of several ports, side by side.
template <class P, int count, class Memory>
TENDONLAB_INLINE P memories_side_by_side(const Memory& memory, int first) {
  return by_lane<P>(
      [&](int l) TENDONLAB_ALWAYS { return memory[static_cast<std::size_t>(first + (l < count ? l : count - 1))]; });
}

template <class Slot, int count, class Port, class Memory>
[[gnu::noinline, gnu::flatten]] Response<Pack<4>> respond_together(const Slot& slot, const Port* port,
                                                                   const Memory& memory, int first) {
  using P = Pack<4>;
  P z(0.0);
  if constexpr (Slot::states > 0) z = memories_side_by_side<P, count>(memory, first);
  return slot.respond(side_by_side<P, Slot, count>(port), z);
}
/// Calls f(i, response) for each port i that has laws.
template <class System, class T, class Coupled, class Memory, class F>
TENDONLAB_INLINE void each_response(const System& system, const Coupled& c, const Memory& memory, F&& f) {
  unroll<slots<System>>([&](auto i) TENDONLAB_ALWAYS {
    constexpr int m = memory_before<System, i>(), together = num_together<System, T, i>();
    using Slot = SlotOf<System, i>;
    const auto& slot = std::get<static_cast<std::size_t>(i)>(system.slot);
    if (slot.active == 0) return;
    if constexpr (together == 1) {
      T z(0.0);
      if constexpr (Slot::states > 0) z = memory[m];
      f(i, respond_for_step<inlines_laws<System, T>>(slot, c.port[i], z));
    } else if constexpr (together > 1) {
      const auto all = respond_together<Slot, together>(slot, &c.port[i], memory, m);
      unroll<together>([&](auto l) TENDONLAB_ALWAYS {
        f(std::integral_constant<int, i + l>{}, Response<T>{all.force[l], all.rate[l]});
      });
    }
  });
}

/// Called, not inlined: a step with a copy of all laws in each stage is no faster and compiles three times as long.
template <class System, class T, class Inputs>
[[gnu::noinline, gnu::flatten]] auto rate(const System& system, const StateOf<System, T>& y,
                                          const Frame<System, T>& frame, const Inputs& in) {
  constexpr int n = System::dof;
  constexpr bool inlines = inlines_laws<System, T>;
  const auto c = couple_for_step<inlines>(system, y.at, frame.mode, in);
  const auto& geometry = geometry_of(system, c);
  Rate<T, n, memories<System>> r;
  r.acceleration = c.applied;
  each_response<System, T>(system, c, y.memory, [&](auto i, const Response<T>& f) TENDONLAB_ALWAYS {
    if constexpr (SlotOf<System, i>::states > 0) r.memory[memory_before<System, i>()] = f.rate;
    unroll<n>([&](auto j) __attribute__((always_inline)) {
      if constexpr (System::joined[i][j]) r.acceleration[j] = r.acceleration[j] - geometry.lever[i][j] * f.force;
    });
  });
  for (std::size_t j = 0; j < n; ++j) r.acceleration[j] = r.acceleration[j] * geometry.inverse_inertia[j];
  if (frame.holds) frame.project([&](int j) -> T& { return r.acceleration[static_cast<std::size_t>(j)]; });
  return r;
}
}  // namespace tendonlab::integrate
