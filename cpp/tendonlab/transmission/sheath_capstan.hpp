#pragma once
#include "tendonlab/transmission/tendon_pair.hpp"

namespace tendonlab::transmission {
/// Capstan friction of two pretensioned tendons in bent sheaths, with a friction coefficient that depends on speed.
///
///   g = P (beta - alpha) Psi_alpha/(Psi_alpha + Psi_beta),   P = 2 r_out T_s             (S3 eq. 18)
///   alpha = exp(-mu theta), beta = exp(mu theta),   mu = mu_d + (mu_s - mu_d) exp(-(v/v_s)^2)      (S3 eq. 19)
///
/// v: velocity of the drive, rad/s. P: torque that the pretension holds, N·m. theta: wrap angle, rad. Psi: integrals of
/// exp(-mu phi) and exp(mu phi) along the sheath; for a shape that is the same from both ends g = P (1 - alpha).
/// mu_d = mu_s = 0 switches it off. No memory.
template <class T>
struct SheathCapstan {
  static constexpr std::string_view name = "capstan", noun = "capstan friction", source = "S3 eq. 18, 19",
                                    equation =
                                        "2 r_out T_s (beta - alpha) Psi_a/(Psi_a + Psi_b) sgn(v), alpha = "
                                        "1/beta = exp(-mu theta), mu = mu_d + (mu_s - mu_d) exp(-(v/v_s)^2)",
                                    summary = "capstan friction of a pretensioned tendon pair in bent sheaths";
  static constexpr unsigned roles = role::level, sees = sees_velocity | sees_wrap | sees_preload;
  T kinetic, resting;
  Divisor<T> falloff;

  static constexpr auto parameters() {
    return std::tuple{parameter(&SheathCapstan::kinetic, "friction_coefficient", Dimension::ratio, Purpose::amplitude,
                                0.05, 0.0, inf, "kinetic friction coefficient of cable and sheath"),
                      parameter(&SheathCapstan::resting, "static_friction_coefficient", Dimension::ratio,
                                Purpose::amplitude, 0.05, 0.0, inf, "friction coefficient towards rest"),
                      parameter(&SheathCapstan::falloff, "stribeck_velocity", Dimension::flow, Purpose::shape, 0.1,
                                1e-9, inf, "speed at which 1/e of the excess over the kinetic one is left")};
  }
  template <class S>
  S coefficient(const Sliding<S>& at) const {
    return kinetic + (resting - kinetic) * exp(-square(at.velocity / falloff));
  }
  /// The pair that this friction acts in; lengths and radii cancel out of what is asked of it here.
  template <class S>
  TendonPair<S> pair(const Sliding<S>& at) const {
    const auto along = along_sheath(S(coefficient(at) * at.wrap), at.skew, constant<S>(1.0));
    return {along, constant<S>(1.0), constant<S>(1.0), S(0.5 * at.preload * along.psi_alpha)};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    return -pair(at).offset();
  }
};
}  // namespace tendonlab::transmission
