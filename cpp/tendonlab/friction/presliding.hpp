#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Presliding: a bristle replaces the jump of dry friction at reversal (LuGre; with sigma_1 = 0 Dahl).
///
///   z' = v - sigma_0 |v| z / g,   F = (1 - p) g s + p (sigma_0 z + sigma_1 z')          (S4 eq. 27)
///
/// v: sliding velocity, m/s (rad/s). g: dry level of the slot, N (N·m). z: bristle deflection, m (rad). s: direction.
/// p: share of the dry friction that the bristle takes over, 1: all; p = 0 switches it off. Memory: z.
template <class T>
struct Presliding {
  static constexpr std::string_view name = "presliding", noun = "presliding friction", source = "S4 eq. 27",
                                    equation =
                                        "(1 - p) g sgn(v) + p (sigma_0 z + sigma_1 z'), z' = v - sigma_0 |v| z / g",
                                    summary = "presliding: a bristle replaces the jump of dry friction at reversal";
  static constexpr unsigned roles = role::memory | role::refines, sees = sees_velocity;
  T stiffness, damping, share;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Presliding::stiffness, "bristle_stiffness", Dimension::stiffness, Purpose::shape, 10.0,
                                1e-9, inf, "slope of friction over deflection at rest"),
                      parameter(&Presliding::damping, "bristle_damping", Dimension::damping, Purpose::shape, 0.1, 0.0,
                                inf, "damping of the deflection"),
                      parameter(&Presliding::share, "presliding_share", Dimension::ratio, Purpose::share, 1.0, 0.0, 1.0,
                                "share of the dry friction that the bristle takes over")};
  }
  template <class S>
  S state_rate(const Sliding<S>& at, const S& level, const S& z) const {
    constexpr double smallest = 1e-15;  // an unloaded slot forgets its deflection at once, without dividing by zero
    return at.velocity - stiffness * at.speed() * z / (level + smallest);
  }
  template <class S>
  S state_force(const Sliding<S>&, const S& z, const S& rate) const {
    return share * (stiffness * z + damping * rate);
  }
  T dry_share() const { return 1.0 - share; }
  /// Deflection at which sliding sets in.
  Plain<T> state_scale(const Plain<T>& level) const { return level / plain(stiffness); }
};
}  // namespace tendonlab::friction
