#pragma once
// Load, actuation and sensing: laws that act on a signal one after the other, in the order of their list.
#include "tendonlab/core/law.hpp"

namespace tendonlab {
/// What a law of a signal sees. `acceleration`: of the drive whose effort the signal is, where the drive's motion is an
/// input of the system; else 0.
template <class S>
struct Passing {
  S signal{}, acceleration{};
};
/// Does the law change a signal at once? A delay does not: the stepper or recorder, which holds the past of the signal,
/// applies it.
template <class Law, class = void>
inline constexpr bool acts_at_once = false;
template <class Law>
inline constexpr bool
    acts_at_once<Law, std::void_t<decltype(std::declval<const Law&>().apply(std::declval<const Passing<double>&>()))>> =
        true;

/// `active` has one bit per law: a law that is off is not evaluated.
template <class T, class List>
struct Chain {
  using Laws = typename List::template With<T>;
  static constexpr int size = List::count;
  Laws laws;
  unsigned active = 0;

  template <class F>
  void each(F&& f) const {
    each_index(std::make_index_sequence<size>{}, f);
  }
  /// The signal behind all laws, delays apart.
  template <class S>
  S apply(Passing<S> at) const {
    each([&](const auto& law) {
      if constexpr (acts_at_once<std::decay_t<decltype(law)>>) at.signal = law.apply(at);
    });
    return at.signal;
  }
  template <class S>
  S apply(const S& signal) const {
    if (active == 0) return signal;
    return by_chain_rule(signal, [&](const auto& alone) {
      using A = std::decay_t<decltype(alone)>;
      return apply(Passing<A>{alone, A{}});
    });
  }
  /// Sum of all delays, s.
  T delay() const {
    T sum{};
    each([&](const auto& law) {
      if constexpr (delays_signal<std::decay_t<decltype(law)>>) sum = sum + law.lateness();
    });
    return sum;
  }
  /// The reading of a signal that is 0. Only for chains that add terms (sensors).
  T bias() const { return apply(T(0.0)); }

 private:
  template <class F, std::size_t... i>
  void each_index(std::index_sequence<i...>, F&& f) const {
    (
        [&] {
          if (active >> i & 1u) f(std::get<i>(laws));
        }(),
        ...);
  }
};
}  // namespace tendonlab
