#pragma once
// A measured or prescribed signal: a piecewise cubic in time (constant pieces where the hardware holds its value).
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "tendonlab/core/dual.hpp"

namespace tendonlab::integrate {
/// The index of a piece in each lane, and the instants that they were looked for.
struct LanePieces : std::array<int, Lanes::count> {
  Lanes found_at{std::numeric_limits<double>::quiet_NaN()};
};
/// The index of a piece, or one for each lane.
template <class T>
using PieceOf = std::conditional_t<in_lanes<T>, LanePieces, int>;

/// More than the rounding of an instant after a delay is added and taken off again.
template <class S>
S rounding(const S& time) {
  return 1e-15 * (1.0 + abs(time));
}

struct Signal {
  std::vector<double> knots;                        ///< start of each piece, s, increasing
  std::vector<std::array<double, 4>> coefficients;  ///< value, slope, half curvature, ... in time from the knot
  std::vector<double> before;                       ///< integral up to each knot
  double pieces_per_second = 0;                     ///< 0: pieces differ in length
  double drift = 0;                                 ///< largest distance of a knot from that rhythm, in pieces
  bool holds = false;                               ///< pieces are constant: the stepper lands on their borders
  bool bends = false;                               ///< its slope jumps from piece to piece

  bool empty() const { return knots.empty(); }
  int pieces() const { return static_cast<int>(knots.size()); }

  /// The piece that holds at `time`, looked for from `near`; the first and last pieces reach outwards.
  int locate(double time, int near) const {
    if (is_in(near, time)) return near;
    int i = near;
    if (pieces_per_second > 0) {
      const double place = place_of(time);
      i = static_cast<int>(place);
      if (std::fabs(place - i - 0.5) < 0.5 - drift) return i;
    }
    while (i + 1 < pieces() && start_of(i + 1) <= time) ++i;
    while (i > 0 && start_of(i) > time) --i;
    return i;
  }
  bool is_in(int piece, double time) const {
    return start_of(piece) <= time && (piece + 1 == pieces() || time < start_of(piece + 1));
  }
  /// Moves `piece` to the one that holds at `time`; a held signal keeps it, as a mode of the step.
  void follow(double time, int& piece) const {
    if (!holds) piece = locate(reached(time), piece);
  }
  void follow(const Lanes& time, LanePieces& piece) const {
    if (holds || !any(time != piece.found_at)) return;  // value and slope are asked for at the same instants
    piece.found_at = time;
    if (pieces_per_second > 0 && guess(time + rounding(time), piece)) return;
    double each[Lanes::count];
    time.store(each);
    for (std::size_t l = 0; l < piece.size(); ++l) piece[l] = locate(reached(each[l]), piece[l]);
  }
  double start_of(int piece) const { return knots[static_cast<std::size_t>(piece)]; }
  Lanes start_of(const PieceOf<Lanes>& piece) const {
    return in_each(piece, [&](int i) { return start_of(i); });
  }
  template <std::size_t power>
  double coefficient(int piece) const {
    return coefficients[static_cast<std::size_t>(piece)][power];
  }
  template <std::size_t power>
  Lanes coefficient(const PieceOf<Lanes>& piece) const {
    return in_each(piece, [&](int i) { return coefficient<power>(i); });
  }
  double gathered(int piece) const { return before[static_cast<std::size_t>(piece)]; }
  Lanes gathered(const PieceOf<Lanes>& piece) const {
    return in_each(piece, [&](int i) { return gathered(i); });
  }

  /// Value at time `t`. Smooth signals move `piece`.
  template <class S, class Piece>
  S value(const S& t, Piece& piece) const {
    if (empty()) return constant<S>(0.0);
    follow(plain(t), piece);
    if (holds) return lift<S>(coefficient<0>(piece));
    return at<0>(t, piece);
  }
  template <class S, class Piece>
  S slope(const S& t, Piece& piece) const {
    if (empty() || holds) return constant<S>(0.0);
    follow(plain(t), piece);
    return at<1>(t, piece);
  }
  /// Integral from the first knot to `t`; a signal that is not given has none.
  template <class S, class Piece>
  S integral(const S& t, Piece& piece) const {
    if (empty()) return constant<S>(0.0);
    follow(plain(t), piece);
    return at<-1>(t, piece);
  }
  /// Joins equal pieces, and prepares `locate` and `integral`.
  void prepare() {
    join();
    find_rate();
    find_bends();
    gather();
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
  static constexpr double inf_time = 1e300;

 private:
  /// What begins at a knot, up to rounding, is in the piece that begins there.
  static double reached(double time) { return time + rounding(time); }
  /// The derivative of that order (-1: the integral) of the piece. Only numbers go through the polynomial: whatever `t`
  /// depends on follows by the chain rule.
  template <int order, class S, class Piece>
  TENDONLAB_INLINE S at(const S& t, const Piece& piece) const {
    if constexpr (std::is_same_v<S, Plain<S>>)
      return cubic<order>(S(t - start_of(piece)), piece);
    else if constexpr (partials < S >> 0)
      return chain(at<order>(t.value, piece), at<order + 1>(t.value, piece), t);
    else
      return chain(at<order>(plain(t), piece), at<order + 1>(plain(t), piece), t);
  }
  template <int order, class P, class Piece>
  TENDONLAB_INLINE P cubic(const P& x, const Piece& piece) const {
    const auto c3 = coefficient<3>(piece);
    if constexpr (order == 3) return P(6.0 * c3);
    const auto c2 = coefficient<2>(piece);
    if constexpr (order == 2) return 2.0 * c2 + x * (6.0 * c3);
    const auto c1 = coefficient<1>(piece);
    if constexpr (order == 1) return c1 + x * (2.0 * c2 + x * (3.0 * c3));
    const auto c0 = coefficient<0>(piece);
    if constexpr (order == 0) return c0 + x * (c1 + x * (c2 + x * c3));
    return gathered(piece) + x * (c0 + x * (c1 / 2.0 + x * (c2 / 3.0 + x * (c3 / 4.0))));
  }
  /// Where `time` lies in pieces of the mean length, a fraction between 0 and the last piece.
  template <class S>
  TENDONLAB_INLINE S place_of(const S& time) const {
    const S begun = (time - knots.front()) * pieces_per_second;
    const S from_first = select(begun > 0.0, begun, S(0.0));
    return select(from_first < pieces() - 1.0, from_first, S(pieces() - 1.0));
  }
  /// Finds the pieces of all lanes; false where one is too near to a knot to tell. At a knot without a bend either
  /// piece will do, if rounding is all that puts the knot aside.
  TENDONLAB_INLINE bool guess(const Lanes& time, LanePieces& piece) const {
    const Lanes place = place_of(time);
    for (int l = 0; l < Lanes::count; ++l) piece[static_cast<std::size_t>(l)] = static_cast<int>(place[l]);
    const Lanes off = place - in_each(piece, [](int i) { return i + 0.5; });
    const bool either_will_do = !bends && drift < 1e-6;
    return either_will_do || !any(abs(off) > 0.5 - drift);
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
  /// What has gathered before each piece.
  void gather() {
    before.assign(knots.size(), 0.0);
    for (std::size_t i = 1; i < knots.size(); ++i) {
      const auto& c = coefficients[i - 1];
      const double x = knots[i] - knots[i - 1];
      before[i] = before[i - 1] + x * (c[0] + x * (c[1] / 2.0 + x * (c[2] / 3.0 + x * (c[3] / 4.0))));
    }
  }
  /// How many pieces a second has, if all are of one length.
  void find_rate() {
    pieces_per_second = 0;
    if (pieces() < 3) return;
    const double length = (knots.back() - knots.front()) / (pieces() - 1);
    double most = 0;
    for (std::size_t i = 1; i < knots.size(); ++i)
      most = std::max(most, std::fabs(knots[i] - knots.front() - static_cast<double>(i) * length));
    if (most > 0.1 * length) return;
    pieces_per_second = 1.0 / length;
    drift = most / length + 1e-9 + 1e-15 * pieces();
  }
  void find_bends() {
    const auto is_straight = [](const auto& c) { return c[2] == 0.0 && c[3] == 0.0; };
    bends = !holds && !empty() && std::all_of(coefficients.begin(), coefficients.end(), is_straight);
    double steepest = 0, jump = 0, largest = 0, leap = 0;
    for (std::size_t i = 1; i < knots.size() && !holds; ++i) {
      const auto& c = coefficients[i - 1];
      const double x = knots[i] - knots[i - 1], slope = c[1] + x * (2.0 * c[2] + x * (3.0 * c[3]));
      const double value = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
      steepest = std::max(steepest, std::fabs(slope));
      jump = std::max(jump, std::fabs(coefficients[i][1] - slope));
      largest = std::max(largest, std::fabs(value));
      leap = std::max(leap, std::fabs(coefficients[i][0] - value));
    }
    bends = bends || jump > 1e-6 * steepest || leap > 1e-9 * largest;
  }
  template <class F>
  static TENDONLAB_INLINE Lanes in_each(const PieceOf<Lanes>& piece, F f) {
    return by_lane<Lanes>([&](int l) __attribute__((always_inline)) { return f(piece[static_cast<std::size_t>(l)]); });
  }
};
}  // namespace tendonlab::integrate
