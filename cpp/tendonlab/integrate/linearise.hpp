#pragma once
// The arrowhead Jacobian of a system: the laws run on duals of what they see, the chain rule joins them with the ports.
#include "tendonlab/integrate/rate.hpp"

namespace tendonlab::integrate {
/// Blocks of the Jacobian. Columns of `*_by`: positions, velocities, time.
template <class System, class T>
struct Arrowhead {
  static constexpr int n = System::dof, nz = memories<System>, cells = nz > 0 ? nz : 1, columns = 2 * n + 1;
  Rate<T, n, nz> rate;
  T acceleration_by[n][columns], memory_by[cells][columns];  ///< at fixed memory
  T decay[cells];                                            ///< -d rate_i / d z_i
  T pull[cells][n];                                          ///< d acceleration_j / d z_i
};

/// One slot's response and its partials by the columns of the system.
template <class Slot, class T, int columns>
struct SlotBlocks {
  static constexpr int has = Slot::states, num_seen = Slot::num_seen;
  Response<T> value;
  T force_by[columns], rate_by[columns], force_z{}, decay{};

  SlotBlocks() = default;
  template <class D>
  TENDONLAB_INLINE SlotBlocks(const Slot& slot, const Sliding<D>& port, const T& z) {
    const D* source[num_seen + 1];
    const auto own = slot.by_fields(port, source);
    using L = std::decay_t<decltype(own.velocity)>;
    L state(z);
    if constexpr (has > 0) state.d[num_seen] = T(1.0);
    const Response<L> f = slot.respond(own, state);
    value = {f.force.value, f.rate.value};
    chain_rule(force_by, f.force, source);
    if constexpr (has > 0) {
      chain_rule(rate_by, f.rate, source);
      force_z = f.force.d[num_seen];
      decay = -f.rate.d[num_seen];
    }
  }

  /// Of one port among several whose laws have answered together.
  template <class L, class D>
  TENDONLAB_INLINE void take_lane(int lane, const Response<L>& all, const Sliding<D>& port) {
    value = {all.force.value[lane], all.rate.value[lane]};
    for (std::size_t q = 0; q < columns; ++q) force_by[q] = rate_by[q] = 0.0;
    std::size_t k = 0;
    Sliding<D>::for_each_field([&](std::string_view, unsigned bit, auto access) TENDONLAB_ALWAYS {
      if ((Slot::sees & bit) == 0) return;
      const double force = all.force.d[k][lane], rate = all.rate.d[k][lane];
      for (std::size_t q = 0; q < columns; ++q) {
        force_by[q] += force * access(port).d[q];
        rate_by[q] += rate * access(port).d[q];
      }
      ++k;
    });
    if constexpr (has > 0) force_z = all.force.d[num_seen][lane], decay = -all.rate.d[num_seen][lane];
  }

 private:
  template <class L, class D>
  static TENDONLAB_INLINE void chain_rule(T (&by)[columns], const L& f, const D* const (&source)[num_seen + 1]) {
    for (std::size_t q = 0; q < columns; ++q) {
      T sum = f.d[0] * source[0]->d[q];
      for (std::size_t e = 1; e < num_seen; ++e) sum = sum + f.d[e] * source[e]->d[q];
      by[q] = sum;
    }
  }
};

/// The same for `count` ports of one element, by one pass of their laws.
template <int columns, int count, class Slot, class D, class Memory>
[[gnu::noinline, gnu::flatten]] std::array<SlotBlocks<Slot, double, columns>, count> slot_blocks_together(
    const Slot& slot, const Sliding<D>* port, const Memory& memory, int first) {
  using P = Pack<4>;
  constexpr int seen = Slot::num_seen, has = Slot::states;
  using L = Dual<P, seen + has>;
  const auto all = side_by_side<P, Slot, count>(port);
  Sliding<L> own;
  own.direction = all.direction, own.side = all.side;
  int k = 0;
  Sliding<L>::for_each_field([&](std::string_view, unsigned bit, auto access) TENDONLAB_ALWAYS {
    if ((Slot::sees & bit) != 0) access(own) = variable<L>(access(all), k++);
  });
  L state(P(0.0));
  if constexpr (has > 0) state = variable<L>(memories_side_by_side<P, count>(memory, first), seen);
  const Response<L> f = slot.respond(own, state);
  std::array<SlotBlocks<Slot, double, columns>, count> each;
  for (int l = 0; l < count; ++l) each[static_cast<std::size_t>(l)].take_lane(l, f, port[l]);
  return each;
}
template <int columns, class Slot, class T, class D>
[[gnu::noinline, gnu::flatten]] SlotBlocks<Slot, T, columns> slot_blocks(const Slot& slot, const Sliding<D>& port,
                                                                         const T& z) {
  return {slot, port, z};
}

/// The ports in duals of (positions, velocities, time).
template <bool inlines, class System, class T, class Inputs>
TENDONLAB_INLINE auto couple_in_duals(const System& system, const StateOf<System, T>& y, const Frame<System, T>& frame,
                                      const Inputs& in) {
  constexpr int n = System::dof;
  using D = Dual<T, 2 * n + 1>;
  Motion<D, n> at;
  for (std::size_t j = 0; j < n; ++j) {
    at.position[j] = variable<D>(y.at.position[j], static_cast<int>(j));
    at.velocity[j] = variable<D>(y.at.velocity[j], n + static_cast<int>(j));
  }
  at.time = variable<D>(y.at.time, 2 * n);
  return couple_for_step<inlines>(system, at, frame.mode, in);
}

template <class T>
TENDONLAB_INLINE const T& under(const T& a) {
  return a;
}
template <class T, int n>
TENDONLAB_INLINE const T& under(const Dual<T, n>& a) {
  return a.value;
}

/// Adds what slot i does to the blocks, as efforts: inertia comes last.
template <int i, class System, class T, class Coupled, class Blocks>
TENDONLAB_INLINE void add_blocks(Arrowhead<System, T>& a, const System& system, const Coupled& coupled,
                                 const Blocks& b) {
  constexpr int n = System::dof, columns = 2 * n + 1, m = memory_before<System, i>(), has = SlotOf<System, i>::states;
  if constexpr (has > 0)
    for (int j = 0; j < n; ++j) a.pull[m][j] = T(0.0);
  unroll<n>([&](auto j) __attribute__((always_inline)) {
    if constexpr (System::joined[i][j]) {
      const auto& arm = geometry_of(system, coupled).lever[i][j];
      const T& lever = under(arm);
      a.rate.acceleration[j] = a.rate.acceleration[j] - lever * b.value.force;
      for (int q = 0; q < columns; ++q) a.acceleration_by[j][q] = a.acceleration_by[j][q] - lever * b.force_by[q];
      if constexpr (System::moving)
        for (std::size_t q = 0; q < columns; ++q)
          a.acceleration_by[j][q] = a.acceleration_by[j][q] - arm.d[q] * b.value.force;
      if constexpr (has > 0) a.pull[m][j] = -(lever * b.force_z);
    }
  });
  if constexpr (has > 0) {
    a.rate.memory[m] = b.value.rate;
    a.decay[m] = b.decay;
    for (int q = 0; q < columns; ++q) a.memory_by[m][q] = b.rate_by[q];
  }
}
/// Adds what slot i does, and those that it speaks for.
template <int i, class System, class T, class Coupled>
TENDONLAB_INLINE void add_slot(Arrowhead<System, T>& a, const System& system, const Coupled& coupled,
                               const StateOf<System, T>& y) {
  using Slot = SlotOf<System, i>;
  constexpr int n = System::dof, columns = 2 * n + 1, m = memory_before<System, i>(), has = Slot::states,
                together = num_together<System, T, i>();
  const auto& slot = std::get<static_cast<std::size_t>(i)>(system.slot);
  if (slot.active == 0) {
    if constexpr (has > 0) {
      a.decay[m] = T(0.0);
      for (int q = 0; q < columns; ++q) a.memory_by[m][q] = T(0.0);
      for (int j = 0; j < n; ++j) a.pull[m][j] = T(0.0);
    }
  } else if constexpr (together == 1) {
    T z(0.0);
    if constexpr (has > 0) z = y.memory[m];
    if constexpr (inlines_laws<System, T>)
      add_blocks<i>(a, system, coupled, SlotBlocks<Slot, T, columns>(slot, coupled.port[i], z));
    else
      add_blocks<i>(a, system, coupled, slot_blocks<columns>(slot, coupled.port[i], z));
  } else if constexpr (together > 1) {
    const auto each = slot_blocks_together<columns, together>(slot, &coupled.port[i], y.memory, m);
    unroll<together>([&](auto l) TENDONLAB_ALWAYS { add_blocks<i + l>(a, system, coupled, each[l]); });
  }
}

template <class System, class T, class Inputs>
TENDONLAB_INLINE Arrowhead<System, T> linearise(const System& system, const StateOf<System, T>& y,
                                                const Frame<System, T>& frame, const Inputs& in) {
  constexpr int n = System::dof, columns = 2 * n + 1, nz = memories<System>;
  const auto c = couple_in_duals<inlines_laws<System, T>>(system, y, frame, in);
  Arrowhead<System, T> a;
  for (std::size_t j = 0; j < n; ++j) {
    a.rate.acceleration[j] = c.applied[j].value;
    for (std::size_t q = 0; q < columns; ++q) a.acceleration_by[j][q] = c.applied[j].d[q];
  }
  unroll<slots<System>>([&](auto i) __attribute__((always_inline)) { add_slot<i>(a, system, c, y); });
  for (std::size_t j = 0; j < n; ++j) {
    const auto& mobility = geometry_of(system, c).inverse_inertia[j];
    const T& inverse = under(mobility);
    for (int q = 0; q < columns; ++q) a.acceleration_by[j][q] = a.acceleration_by[j][q] * inverse;
    if constexpr (System::moving)
      for (std::size_t q = 0; q < columns; ++q)
        a.acceleration_by[j][q] = a.acceleration_by[j][q] + mobility.d[q] * a.rate.acceleration[j];
    a.rate.acceleration[j] = a.rate.acceleration[j] * inverse;
    for (int i = 0; i < nz; ++i) a.pull[i][j] = a.pull[i][j] * inverse;
  }
  if (frame.holds) {
    frame.project([&](int j) -> T& { return a.rate.acceleration[static_cast<std::size_t>(j)]; });
    for (int q = 0; q < columns; ++q) frame.project([&](int j) -> T& { return a.acceleration_by[j][q]; });
    for (int i = 0; i < nz; ++i) frame.project([&](int j) -> T& { return a.pull[i][j]; });
  }
  return a;
}
}  // namespace tendonlab::integrate
