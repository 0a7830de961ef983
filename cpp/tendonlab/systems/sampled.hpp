#pragma once
// Systems without a differential equation: what a sample shows follows from its inputs and from what is remembered.
// Instead of `couple` and `observe` they state
//   template <class Inputs, class Memory> SampleOf<System> evaluate(const Inputs& in, Memory& memory) const;
// with in.template input<k>(), slope<k>(), given<k>(), in.dt (s since the sample before, 0 at the first); memory.slot
// holds the states of the slots' laws, memory.own what the system itself carries on (`carried` numbers), memory.begun
// whether there was a sample before.
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// What a sample shows: the outputs, and what each port saw and did.
template <class T, std::size_t outputs, std::size_t ports>
struct Sample {
  std::array<T, outputs> output{};
  std::array<Sliding<T>, ports> port{};
  std::array<T, ports> force{};
};
template <class T, std::size_t states, std::size_t carried>
struct Memory {
  std::array<T, states> slot{};
  std::array<T, carried> own{};
  bool begun = false;
};

/// What a port sees whose direction is that of its velocity, none at rest.
template <class T>
Sliding<T> sliding(const T& velocity, const T& position, const T& load, const T& wrap = T(0.0)) {
  const double v = plain(velocity);
  return {velocity, position, load, static_cast<double>((v > 0) - (v < 0)), 0.0, wrap};
}

/// Takes the memory `z` of a slot over `dt` at a constant sliding `at`, exactly for laws linear in z.
template <class Slot, class T>
void advance(const Slot& slot, const Sliding<T>& at, T& z, double dt) {
  if constexpr (Slot::states > 0) {
    if (slot.has(role::memory) && dt > 0) {
      using D = Dual<T, 1>;
      Sliding<D> seen;
      seen.velocity = D(at.velocity), seen.position = D(at.position), seen.load = D(at.load), seen.wrap = D(at.wrap);
      seen.preload = D(at.preload), seen.skew = D(at.skew);
      seen.direction = at.direction, seen.side = at.side;
      const auto rate = slot.respond(seen, variable<D>(z, 0)).rate;
      const T decay = -rate.d[0];
      const bool forgets = plain(decay) * dt > 1e-9;
      const T horizon = forgets ? T(-expm1(-dt * decay) / select(forgets, decay, T(1.0))) : T(dt);
      z = z + horizon * rate.value;
    }
  }
}
/// The same, and the force at the end.
template <class Slot, class T>
T answer(const Slot& slot, const Sliding<T>& at, T& z, double dt) {
  advance(slot, at, z, dt);
  return slot.respond(at, z).force;
}
/// The force of a slot that remembers nothing.
template <class Slot, class T>
T answer(const Slot& slot, const Sliding<T>& at) {
  static_assert(Slot::states == 0, "this slot remembers: say where");
  return slot.respond(at, T(0.0)).force;
}
}  // namespace tendonlab::systems
