#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Coulomb (kinetic) friction: a constant level that opposes sliding.
///
///   g = F_c                                                               (S1 eq. 12)
///
/// g: level, N (N·m). Sticks at rest up to this level. F_c = 0 switches it off. No memory.
template <class T>
struct Coulomb {
  static constexpr std::string_view name = "coulomb", noun = "Coulomb friction", source = "S1 eq. 12",
                                    equation = "F_c sgn(v)",
                                    summary = "Coulomb (kinetic) friction: a constant level that opposes sliding";
  static constexpr unsigned roles = role::level, sees = sees_nothing;
  T coulomb;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Coulomb::coulomb, "coulomb", Dimension::effort, Purpose::amplitude, 0.1, 0.0, inf,
                                "kinetic friction")};
  }
  template <class S>
  S level(const Sliding<S>&) const {
    return lift<S>(coulomb);
  }
};
}  // namespace tendonlab::friction
