#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Friction of a loaded transmission on its input side: the load-and-ratio model.
///
///   g = F_c (1 + L) w^delta + [F_s + F_c (1 + L) w^beta] exp(-|v/v_s|^alpha)
///       + F_v v_0 [(N^2 + 1)/N^2 w + (w/L)^gamma],   w = |v|/v_0,  v_0 = 1 m/s (rad/s)      (S0 eq. 11)
///
/// v: sliding velocity, m/s (rad/s). L: relative load > 0, 1: load of the bearings over their load by the own
/// weight of the shaft (S0 eq. 9). N: transmission ratio, 1. g: N (N·m), F_v: N·s/m (N·m·s/rad). As printed, the
/// exponential carries delta as well; alpha is meant, which otherwise occurs nowhere. F_s is not multiplied by load.
/// The static LuGre curve is no case of it. Stands for the whole friction of its slot; F_c = F_s = F_v = 0 switches it
/// off. No memory.
template <class T>
struct LoadAndRatio {
  static constexpr std::string_view name = "load_and_ratio", noun = "load- and ratio-dependent friction",
                                    source = "S0 eq. 11",
                                    equation =
                                        "(F_c (1 + L) w^delta + (F_s + F_c (1 + L) w^beta) exp(-|v/v_s|^alpha) + F_v "
                                        "v_0 ((N^2 + 1)/N^2 w + (w/L)^gamma)) sgn(v), w = |v|/v_0",
                                    summary = "load-and-ratio friction: a transmission's, by relative load and ratio";
  static constexpr unsigned roles = role::level | role::whole, sees = sees_velocity | sees_load;
  T coulomb, at_rest;
  Divisor<T> falloff;
  T viscous, load_exponent, peak_exponent, stribeck_exponent, viscous_exponent;
  Divisor<T> ratio;

  static constexpr auto parameters() {
    return std::tuple{parameter(&LoadAndRatio::coulomb, "coulomb", Dimension::effort, Purpose::amplitude, 0.05, 0.0,
                                inf, "kinetic friction at the reference speed, per one plus relative load"),
                      parameter(&LoadAndRatio::at_rest, "static_friction", Dimension::effort, Purpose::amplitude, 0.2,
                                0.0, inf, "static friction, whatever the load"),
                      parameter(&LoadAndRatio::falloff, "stribeck_velocity", Dimension::flow, Purpose::shape, 0.4, 1e-9,
                                inf, "speed at which 1/e of the peak at low speed is left"),
                      parameter(&LoadAndRatio::viscous, "viscous", Dimension::damping, Purpose::amplitude, 0.5, 0.0,
                                inf, "viscous friction of one shaft"),
                      parameter(&LoadAndRatio::load_exponent, "load_exponent", Dimension::ratio, Purpose::shape, 0.5,
                                -1.0, 4.0, "delta: growth of the load-dependent part with speed"),
                      parameter(&LoadAndRatio::peak_exponent, "peak_exponent", Dimension::ratio, Purpose::shape, 1.0,
                                -1.0, 6.0, "beta: growth of the peak at low speed with speed"),
                      parameter(&LoadAndRatio::stribeck_exponent, "stribeck_exponent", Dimension::ratio, Purpose::shape,
                                2.0, 0.1, 10.0, "alpha: sharpness of the end of the peak at low speed; 2: Gaussian"),
                      parameter(&LoadAndRatio::viscous_exponent, "viscous_exponent", Dimension::ratio, Purpose::shape,
                                1.0, -1.0, 4.0, "gamma: growth of the part of viscous friction that falls with load"),
                      parameter(&LoadAndRatio::ratio, "transmission_ratio", Dimension::ratio, Purpose::condition, 1.0,
                                1e-6, inf, "input speed over output speed")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    constexpr double least = 1e-9;  // w/L must not become infinite where no load is stated
    const S w = at.speed(), carried = abs(at.load), per_load = coulomb * (1.0 + carried);  // v_0 = 1
    const S load = select(plain(carried) > least, carried, constant<S>(least));
    const S peak = at_rest + per_load * power(w, peak_exponent);
    const S both_shafts = (1.0 + square(ratio.reciprocal)) * w;
    return per_load * power(w, load_exponent) + peak * exp(-power(S(w / falloff), stribeck_exponent)) +
           viscous * (both_shafts + power(S(w / load), viscous_exponent));
  }
};
}  // namespace tendonlab::friction
