#pragma once
#include "tendonlab/core/terms.hpp"
#include "tendonlab/mechanics/tendon_pair.hpp"
#include "tendonlab/transmission/curvature_skew.hpp"

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
  static constexpr unsigned roles = role::level | role::gain, sees = sees_velocity | sees_wrap | sees_preload;
  template <class S>
  using Port = SheathSliding<S>;
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
    return kinetic + (resting - kinetic) * stribeck_decay(at.velocity, falloff);
  }
  template <class S>
  S level(const SheathSliding<S>& at) const {
    return -pair(at).offset();
  }
  /// Gain of the pair over its ratio of radii: 1 for a sheath that is bent evenly.
  template <class S>
  S gain(const SheathSliding<S>& at) const {
    const S& skew = at.curvature.skew;
    return plain(skew) == 0.0 && !varies(skew) ? constant<S>(1.0) : pair(at).torque_gain();
  }

 private:
  /// The pair with unit radii and a sheath of unit length, which cancel out of level and gain.
  template <class S>
  mechanics::TendonPair<S> pair(const SheathSliding<S>& at) const {
    const auto along = mechanics::along_sheath(S(coefficient(at) * at.wrap), at.curvature, constant<S>(1.0));
    return {along, constant<S>(1.0), constant<S>(1.0), S(0.5 * at.preload * along.psi_alpha)};
  }
};
}  // namespace tendonlab::transmission
