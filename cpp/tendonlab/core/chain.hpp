#pragma once
// Load, actuation and sensing: laws applied one after the other to a signal, in the order of their list; delays are
// told apart, since only whoever holds the signal's past can apply them.
#include "tendonlab/core/law.hpp"

namespace tendonlab {
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
  template <class S>
  S apply(S signal) const {
    each([&](const auto& law) { signal = law.apply(signal); });
    return signal;
  }
  T delay() const {
    T sum{};
    each([&](const auto& law) { sum = sum + law.lateness(); });
    return sum;
  }
  /// What the chain would have to see to give `signal`, delays apart. Only for chains of added terms (sensors).
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
