#pragma once
// Laws that act on a signal one after the other, in the order of their list: load, actuation, sensing, and what a
// transmission makes of the effort that it passes on.
#include "tendonlab/core/law.hpp"

namespace tendonlab {
/// What a law of a signal sees. A chain that knows more of its signal passes a type of its own, derived from this one
/// (actuation::DriveEffort, transmission::TransmittedEffort), and only such a chain compiles with laws that ask for it.
template <class S>
struct Passing {
  using Scalar = S;
  S signal{};     ///< behind the laws before
  double dt = 0;  ///< time since the sample before, s; 0 at the first

  /// Calls f(name, sees_nothing, access) for each quantity, as ports do: access(at) is that field.
  template <class F>
  static constexpr void for_each_field(F&& f) {
    f(
        "signal", sees_nothing, [](auto& at) -> auto& { return at.signal; });
  }
};

/// A law of a signal has role::signal and states
///   S apply(const Passing<S>& at) const;                                the signal behind it
/// A law that keeps a state from one sample to the next, in a system that is sampled, states instead
///   template <class S> struct State;                                    empty before the first sample
///   State<S> next(const State<S>& before, const Passing<S>& at) const;  the state at a sample
///   S apply(const Passing<S>& at, const State<S>& now) const;           the signal behind it
/// With more fields in what it sees, `Signal<S>` is the type of that. A delay states only lateness(): the stepper or
/// recorder, which holds the past of the signal, applies it.
template <class Law, class = void>
inline constexpr bool keeps_state = false;
template <class Law>
inline constexpr bool keeps_state<Law, std::void_t<typename Law::template State<double>>> = true;

struct NoState {};
template <class Law, class S, bool keeps = keeps_state<Law>>
struct StateOf {
  using type = NoState;
};
template <class Law, class S>
struct StateOf<Law, S, true> {
  using type = typename Law::template State<S>;
};
/// The signal behind one law; `state` becomes that of this sample.
template <class Law, class At, class State>
typename At::Scalar signal_behind(const Law& law, const At& at, State& state) {
  if constexpr (keeps_state<Law>) {
    state = law.next(state, at);
    return law.apply(at, state);
  } else {
    return static_cast<void>(state), law.apply(at);
  }
}

/// `active` has one bit per law: a law that is off is not evaluated.
template <class T, class List>
struct Chain;
template <class T, template <class> class... Law>
struct Chain<T, tendonlab::Laws<Law...>> {
  static_assert(((Law<T>::roles & role::signal) && ...), "a law of a slot in a chain");
  using Laws = std::tuple<Law<T>...>;
  /// What the laws keep from sample to sample; the caller holds it.
  using States = std::tuple<typename StateOf<Law<T>, T>::type...>;
  static constexpr int size = sizeof...(Law);
  Laws laws;
  unsigned active = 0;

  template <class F>
  void each(F&& f) const {
    each_index(std::make_index_sequence<size>{}, [&](auto i) { f(std::get<i>(laws)); });
  }
  /// The signal of a sample behind all laws, delays apart.
  template <class At>
  typename At::Scalar pass(At at, States& states) const {
    each_index(std::make_index_sequence<size>{}, [&](auto i) {
      const auto& law = std::get<i>(laws);
      if constexpr (!delays_signal<std::decay_t<decltype(law)>>)
        at.signal = signal_behind(law, at, std::get<i>(states));
    });
    return at.signal;
  }
  /// The same at an instant, of laws that keep no state.
  template <class At>
  typename At::Scalar pass(At at) const {
    static_assert((!keeps_state<Law<T>> && ...),
                  "a law of this chain keeps a state from sample to sample: only a sampled system can hold it");
    each([&](const auto& law) {
      if constexpr (!delays_signal<std::decay_t<decltype(law)>>) at.signal = law.apply(at);
    });
    return at.signal;
  }
  template <class S>
  S apply(const S& signal) const {
    if (active == 0) return signal;
    return by_chain_rule(signal,
                         [&](const auto& alone) { return pass(Passing<std::decay_t<decltype(alone)>>{alone}); });
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
    ((active >> i & 1u ? f(std::integral_constant<std::size_t, i>{}) : void()), ...);
  }
};
}  // namespace tendonlab
