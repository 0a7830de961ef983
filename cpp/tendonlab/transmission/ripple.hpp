#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::transmission {
/// Ripple of a gear: its output runs ahead and behind, once a turn.
///
///   v -> v (1 + s sin(phi) + c cos(phi)),   phi: angle of the output, 0 where that of the input is 0
///                                                                   (S2 fig. 12c: velocity disturbance by the gear)
///
/// v: velocity, any unit. Position in rad: one turn of it is one cycle. In closed form, with
/// rho^2 = 1 - s^2 - c^2 and chi = rho psi for an input angle psi,
///   phi = chi + 2 arctan(((1 + c - rho) sin(chi) + s (1 - cos(chi))) / (2 rho + (1 + c - rho)(1 - cos(chi)) - s
///   sin(chi))).
/// s = c = 0 switches it off. No memory.
template <class T>
struct Ripple {
  static constexpr std::string_view name = "ripple", noun = "motion ripple", source = "S2 fig. 12c",
                                    equation = "v (1 + s sin(phi) + c cos(phi))",
                                    summary =
                                        "gear ripple: the output runs ahead and behind once a turn; phi: its own angle";
  static constexpr unsigned roles = role::motion, sees = sees_position;
  T sine, cosine;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Ripple::sine, "ripple_sine", Dimension::ratio, Purpose::amplitude, 0.05, -0.5, 0.5,
                                "share of the velocity that goes with the sine of the angle"),
                      parameter(&Ripple::cosine, "ripple_cosine", Dimension::ratio, Purpose::amplitude, 0.05, -0.5, 0.5,
                                "share of the velocity that goes with the cosine of the angle")};
  }
  template <class S>
  Sliding<S> motion(Sliding<S> at) const {
    const T root = sqrt(1.0 - square(sine) - square(cosine)), lead = 1.0 + cosine - root;
    const S steady = root * at.position, wave = sin(steady), rest = 1.0 - cos(steady);
    const S ahead = lead * wave + sine * rest, along = 2.0 * root + (lead * rest - sine * wave);
    at.position = steady + 2.0 * atan(ahead / along);
    at.velocity = at.velocity * (1.0 + (sine * sin(at.position) + cosine * cos(at.position)));
    return at;
  }
};
}  // namespace tendonlab::transmission
