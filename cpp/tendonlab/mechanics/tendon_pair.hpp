#pragma once
// Statics of two tendons that join two pulleys through sheaths of one shape, under pretension (S3 eq. 6-18).
#include <array>
#include <vector>

#include "tendonlab/core/law.hpp"

namespace tendonlab::mechanics {
/// Effect of friction on a tension along one sheath: the shares lost and gained over its whole length, and the
/// integrals of exp(-mu phi) and exp(+mu phi), m.
template <class T>
struct AlongSheath {
  T loss{};  ///< 1 - alpha = 1 - exp(-mu theta)
  T gain{};  ///< beta - 1 = exp(mu theta) - 1
  T psi_alpha{}, psi_beta{};
};

/// Along a sheath of the given curvature: `density(u)` over its mean at the share u of the length, `turned(u)` the
/// share of the wrap angle before u. mu and theta enter as their product `friction`. Ten-point Gauss quadrature: no
/// cancellation as mu -> 0, error 1e-15 up to mu theta = 5.
template <class T, class Curvature>
AlongSheath<T> along_sheath(const T& friction, const Curvature& curvature, const T& length) {
  constexpr std::array<double, 5> node{0.14887433898163121, 0.43339539412924719, 0.67940956829902441,
                                       0.86506336668898451, 0.97390652851717172};
  constexpr std::array<double, 5> weight{0.29552422471475287, 0.26926671930999636, 0.21908636251598204,
                                         0.14945134915058059, 0.06667134430868814};
  AlongSheath<T> sum;
  for (std::size_t k = 0; k < 10; ++k) {
    const double centred = k < 5 ? node[k] : -node[k - 5], u = 0.5 * (1.0 + centred), w = 0.5 * weight[k % 5];
    const T density = curvature.density(u);
    const T fading = exp(-(friction * curvature.turned(u)));
    const T growing = 1.0 / fading;
    sum.loss = sum.loss + (w * density) * fading;
    sum.gain = sum.gain + (w * density) * growing;
    sum.psi_alpha = sum.psi_alpha + w * fading;
    sum.psi_beta = sum.psi_beta + w * growing;
  }
  return {friction * sum.loss, friction * sum.gain, length * sum.psi_alpha, length * sum.psi_beta};
}

/// Along a sheath of any shape: `turning` phi, rad, at each `arc_length` s, m, both from 0, evenly bent between them.
/// Simpson's rule on each stretch, its middle the geometric mean of its ends: an even sheath comes out exactly.
template <class T>
AlongSheath<T> along_sheath(const T& coefficient, const std::vector<double>& arc_length,
                            const std::vector<double>& turning) {
  AlongSheath<T> sum{-expm1(-coefficient * turning.back()), expm1(coefficient * turning.back()), {}, {}};
  T fading(1.0), growing(1.0);
  for (std::size_t k = 1; k < arc_length.size(); ++k) {
    const double sixth = (arc_length[k] - arc_length[k - 1]) / 6.0;
    const T next = exp(-coefficient * turning[k]), up = 1.0 / next, middle = sqrt(fading * next);
    sum.psi_alpha = sum.psi_alpha + sixth * (fading + 4.0 * middle + next);
    sum.psi_beta = sum.psi_beta + sixth * (growing + 4.0 / middle + up);
    fading = next, growing = up;
  }
  return sum;
}

/// Two tendons under pretension T_s. `pretension_moment`: C_TO, the integral of the pretension along the sheath, N·m.
template <class T>
struct TendonPair {
  AlongSheath<T> along;
  T input_radius, output_radius, pretension_moment;

  T psi_sum() const { return along.psi_alpha + along.psi_beta; }
  /// Output torque per input torque, K_in (S3 eq. 18).
  T torque_gain() const {
    const T alpha = 1.0 - along.loss, beta = 1.0 + along.gain;
    return output_radius * (along.psi_beta * alpha + along.psi_alpha * beta) / (input_radius * psi_sum());
  }
  /// Output torque per moment of the pretension, K_TO, while it slides forwards (S3 eq. 18).
  T pretension_gain() const { return -2.0 * output_radius * (along.loss + along.gain) / psi_sum(); }
  /// Output torque less K_in times the input torque, while it slides forwards; backwards the same with the other sign.
  T offset() const { return pretension_gain() * pretension_moment; }

  /// T_1 … T_4: pulling side at input and output, returning side at input and output; `backwards`: it slides back, so
  /// that tensions grow where they fell, while the moment of the pretension stays (S3 eq. 8, 9, 15-17).
  std::array<T, 4> tensions(const T& input_torque, bool backwards) const {
    const T alpha = 1.0 - along.loss, beta = 1.0 + along.gain, pull = input_torque / input_radius;
    const T& falling = backwards ? along.psi_beta : along.psi_alpha;
    const T& growing = backwards ? along.psi_alpha : along.psi_beta;
    const T first = (2.0 * pretension_moment + growing * pull) / psi_sum();
    const T third = (2.0 * pretension_moment - falling * pull) / psi_sum();
    return {first, (backwards ? beta : alpha) * first, third, (backwards ? alpha : beta) * third};
  }
  /// Lengthening of the pulling and of the returning cable, m, of axial stiffness EA, N (S3 eq. 10, 13).
  std::array<T, 2> elongations(const T& input_torque, bool backwards, const T& cable_stiffness) const {
    const auto tension = tensions(input_torque, backwards);
    const T& falling = backwards ? along.psi_beta : along.psi_alpha;
    const T& growing = backwards ? along.psi_alpha : along.psi_beta;
    return {(falling * tension[0] - pretension_moment) / cable_stiffness,
            (growing * tension[2] - pretension_moment) / cable_stiffness};
  }
};
}  // namespace tendonlab::mechanics
