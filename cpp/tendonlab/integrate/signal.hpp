#pragma once
// A measured or prescribed signal: a piecewise cubic in time (constant pieces where the hardware holds its value).
#include <array>
#include <vector>

#include "tendonlab/core/dual.hpp"

namespace tendonlab::integrate {
struct Signal {
  std::vector<double> knots;                        ///< start of each piece, s, increasing
  std::vector<std::array<double, 4>> coefficients;  ///< value, slope, half curvature, ... in time from the knot
  std::vector<double> before;                       ///< integral up to each knot
  bool holds = false;                               ///< pieces are constant: the stepper lands on their borders

  bool empty() const { return knots.empty(); }
  int pieces() const { return static_cast<int>(knots.size()); }

  /// The piece that holds at `time`, looked for from `near`; the first and last pieces reach outwards.
  int locate(double time, int near) const {
    int i = near;
    while (i + 1 < pieces() && knots[static_cast<std::size_t>(i + 1)] <= time) ++i;
    while (i > 0 && knots[static_cast<std::size_t>(i)] > time) --i;
    return i;
  }
  /// Value at time `t`. Smooth signals move `piece`; held ones keep it, as a mode of the step.
  template <class S>
  S value(const S& t, int& piece) const {
    if (empty()) return constant<S>(0.0);
    if (!holds) piece = locate(plain(t), piece);
    const auto& c = coefficients[static_cast<std::size_t>(piece)];
    if (holds) return constant<S>(c[0]);
    const S x = t - knots[static_cast<std::size_t>(piece)];
    return c[0] + x * (c[1] + x * (c[2] + x * c[3]));
  }
  template <class S>
  S slope(const S& t, int& piece) const {
    if (empty() || holds) return constant<S>(0.0);
    piece = locate(plain(t), piece);
    const auto& c = coefficients[static_cast<std::size_t>(piece)];
    const S x = t - knots[static_cast<std::size_t>(piece)];
    return c[1] + x * (2.0 * c[2] + x * (3.0 * c[3]));
  }
  /// Integral from the first knot to `t`; a signal that is not given has none.
  template <class S>
  S integral(const S& t, int& piece) const {
    if (empty()) return constant<S>(0.0);
    if (!holds) piece = locate(plain(t), piece);
    const auto i = static_cast<std::size_t>(piece);
    const auto& c = coefficients[i];
    const S x = t - knots[i];
    return before[i] + x * (c[0] + x * (c[1] / 2.0 + x * (c[2] / 3.0 + x * (c[3] / 4.0))));
  }
  /// Prepares `integral`: what has gathered before each piece.
  void gather() {
    before.assign(knots.size(), 0.0);
    for (std::size_t i = 1; i < knots.size(); ++i) {
      const auto& c = coefficients[i - 1];
      const double x = knots[i] - knots[i - 1];
      before[i] = before[i - 1] + x * (c[0] + x * (c[1] / 2.0 + x * (c[2] / 3.0 + x * (c[3] / 4.0))));
    }
  }
  /// When a held value next changes after piece `i`; infinity if it never does.
  double next_change(int i) const {
    return holds && i + 1 < pieces() ? knots[static_cast<std::size_t>(i) + 1] : inf_time;
  }
  /// The first knot after `time`, looked for from piece `near`, where the signal may turn; infinity if there is none.
  double next_knot(double time, int near) const {
    auto i = static_cast<std::size_t>(locate(time, near));
    while (i < knots.size() && (knots[i] <= time || rests(i))) ++i;
    return i < knots.size() ? knots[i] : inf_time;
  }
  /// Does the signal keep its value through knot i?
  bool rests(std::size_t i) const {
    const auto constant = [](const auto& c) { return c[1] == 0.0 && c[2] == 0.0 && c[3] == 0.0; };
    return i > 0 && constant(coefficients[i]) && constant(coefficients[i - 1]) &&
           coefficients[i][0] == coefficients[i - 1][0];
  }
  /// Joins held pieces of equal value, so that the stepper lands where something happens and nowhere else.
  void join() {
    if (!holds || empty()) return;
    std::size_t last = 0;
    for (std::size_t k = 1; k < knots.size(); ++k)
      if (coefficients[k][0] != coefficients[last][0])
        ++last, knots[last] = knots[k], coefficients[last] = coefficients[k];
    knots.resize(last + 1), coefficients.resize(last + 1);
  }
  static constexpr double inf_time = 1e300;
};
}  // namespace tendonlab::integrate
