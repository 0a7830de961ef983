#pragma once
// Systems without a differential equation: a sample follows from its inputs and from the memory. Instead of `couple`
// and `observe` they state
//   template <class Inputs, class Memory> Sample evaluate(const Inputs& in, Memory& memory) const;
// with in.template input<k>(), slope<k>(), given<k>(), before<c>() (output c before the first sample, if it is known)
// and in.dt (s since the sample before, 0 at the first); memory.slot holds the states of the slots' laws, memory.own
// what the system itself hands on (its `Carried`, empty at the first).
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// The outputs of a sample, and sliding and force of each port.
template <class T, std::size_t outputs, std::size_t ports>
struct Sample {
  std::array<T, outputs> output{};
  std::array<Sliding<T>, ports> port{};
  std::array<T, ports> force{};
};
template <class T, std::size_t states, class Carried>
struct Memory {
  std::array<T, states> slot{};
  Carried own{};
};

/// Sliding of a port whose direction is that of its velocity, none at rest.
template <class T>
Sliding<T> sliding(const T& velocity, const T& position, const T& load, const T& wrap = T(0.0)) {
  const double v = plain(velocity);
  return {velocity, position, load, static_cast<double>((v > 0) - (v < 0)), 0.0, wrap};
}

/// The state `z` of a slot after `dt` at a constant sliding `at`: exact for laws linear in z.
template <class Slot, class Port, class T>
T advanced(const Slot& slot, const Port& at, const T& z, double dt) {
  if constexpr (Slot::states > 0) {
    if (slot.has(role::memory) && dt > 0) {
      using D = Dual<T, 1>;
      const auto rate = slot.respond(with_scalar<D>(at), variable<D>(z, 0)).rate;
      const T decay = -rate.d[0];
      const bool forgets = plain(decay) * dt > 1e-9;
      const T horizon = forgets ? T(-expm1(-dt * decay) / select(forgets, decay, T(1.0))) : T(dt);
      return z + horizon * rate.value;
    }
  }
  return z;
}
}  // namespace tendonlab::systems
