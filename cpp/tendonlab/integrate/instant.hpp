#pragma once
// What ports see and do at an instant, and what the system shows of it.
#include <optional>

#include "tendonlab/integrate/contact.hpp"
#include "tendonlab/integrate/needs.hpp"

namespace tendonlab::integrate {
/// The ports at one instant, computed on first use: most outputs need none.
template <class System, class T, class Inputs>
class Instant {
  using F = Frame<System, T>;

 public:
  Instant(const PortModes<System, T>& with, const StateOf<System, T>& at, const Inputs& inputs)
      : y(at), contact(with.contact), frame(with.frame), in(inputs) {}

  /// What the ports see.
  const auto& coupled() {
    if (!seen) seen = couple(contact.system, y.at, frame.mode, in);
    return *seen;
  }
  /// The force at port i: that of its laws, and where it sticks its share of what holds it.
  template <int i>
  T force() {
    constexpr auto slot = static_cast<std::size_t>(i);
    T z(0.0);
    if constexpr (SlotOf<System, i>::states > 0) z = y.memory[memory_before<System, i>()];
    const T own = respond(std::get<slot>(contact.system.slot), coupled().port[slot], z).force;
    if constexpr (System::ports[slot].direction >= 0)
      if (contact.sticks(i, frame)) {
        if (!borne) borne = contact.borne(y, frame, in);
        return own + (*borne)[slot];
      }
    return own;
  }

  const StateOf<System, T> y;

 private:
  const Contact<System, T>& contact;
  const F& frame;
  const Inputs& in;
  std::optional<decltype(std::declval<const System&>().couple(y.at, std::declval<F>().mode, in))> seen;
  std::optional<std::array<T, slots<System>>> borne;
};

/// The outputs at an instant, before their sensors; those that need more than `wanted` are meaningless.
template <class System, class Instant>
auto observe(const System& system, Instant& instant, const Needs& wanted) {
  using S = std::decay_t<decltype(instant.y.at.time)>;
  const auto acts = [&](auto i) TENDONLAB_ALWAYS { return wanted.force(i) ? instant.template force<i>() : S(0.0); };
  static const Sliding<S> unseen{};
  const auto port = [&](auto i) TENDONLAB_ALWAYS -> const Sliding<S>& {
    return wanted.ports ? instant.coupled().port[i] : unseen;
  };
  return system.observe(instant.y.at, acts, port);
}
}  // namespace tendonlab::integrate
