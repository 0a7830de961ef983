#pragma once
#include "tendonlab/transmission/transmitted_effort.hpp"

namespace tendonlab::transmission {
/// Presliding spread along an elastic cable: at a reversal the cable gives way from its input on, and the output is
/// held until the friction of the whole sheath has turned over. A play in torque, where the gate of S3 is one in
/// velocity; its corner is round, since the last friction turns over while the output moves already.
///
///   s (m[k] - m[k-1]) = d + w (1 - exp(-d/rho)),   w = g - s (m[k-1] - y)   (balance of a Dahl bristle, elastic load)
///   y -> y + s d,   tau -> (1 - a) tau + a y
///
/// m: output torque without dry friction, N·m (N), s: the sense in which it changes, g: dry friction level, w: friction
/// that has yet to turn over, d: rise of the output. rho: rise within which all but 1/e of w turns over; at a load of
/// stiffness K and a breakaway displacement z it is K z, and rho -> 0 is the play operator of S4. tau: output by the
/// other laws, N·m (N). a: share of it; 1: no gate. a = 0 switches it off. State: y and m.
template <class T>
struct DistributedPresliding {
  static constexpr std::string_view
      name = "distributed_presliding",
      noun = "distributed presliding friction", source = "S3 sec. 2, S4 play operator, in torque",
      equation = "(1 - a) tau + a y, y += s d, s dm = d + w (1 - exp(-d/rho)), w = g - s (m - y)",
      summary =
          "presliding spread along the cable: the output y is held until the friction of the whole sheath has turned "
          "over (m: output without dry friction; s: sense in which m changes)";
  static constexpr unsigned roles = role::signal | role::refines, sees = sees_nothing;
  template <class S>
  using Signal = TransmittedEffort<S>;
  T turnover_rise, share;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&DistributedPresliding::turnover_rise, "turnover_rise", Dimension::effort, Purpose::shape, 0.01, 1e-9,
                  inf, "rise of the output within which all but 1/e of the last friction turns over"),
        parameter(&DistributedPresliding::share, "distributed_share", Dimension::ratio, Purpose::share, 1.0, 0.0, 1.0,
                  "share of the output that is held by torque")};
  }
  /// y and m at a sample.
  template <class S>
  struct State {
    S held{}, input{};
  };
  template <class S>
  State<S> next(State<S> before, const TransmittedEffort<S>& at) const {
    if (at.dt == 0.0) before = {at.start, at.smooth};
    const double sense = plain(at.smooth) < plain(before.input) ? -1.0 : 1.0;
    const S friction = limited(S(before.input - before.held), at.dry_level);  // friction above the level has slipped
    const S turning = rise(S(sense * (at.smooth - before.input)), S(at.dry_level - sense * friction));
    return {S(before.input - friction + sense * turning), at.smooth};
  }
  template <class S>
  S apply(const TransmittedEffort<S>& at, const State<S>& now) const {
    return at.signal + share * (now.held - at.signal);
  }

 private:
  template <class S>
  static S limited(const S& friction, const S& level) {
    const S above = select(plain(friction) < -plain(level), -level, friction);
    return select(plain(above) > plain(level), level, above);
  }
  /// d at a rise of the input, by Newton: the equation is concave, so its steps climb to the root from below.
  template <class S>
  S rise(const S& input, const S& left) const {
    constexpr int most = 200;  // steps of one rho each, where rho is next to nothing
    const double in = plain(input), w = plain(left), rho = plain(turnover_rise);
    double d = std::max(0.0, in - w), slope = 1.0;
    for (int i = 0; i < most; ++i) {
      const double turning = w * std::exp(-d / rho);
      slope = 1.0 + turning / rho;
      const double step = (in - d - (w - turning)) / slope;
      d += step;
      if (!(step > 1e-15 * (in + rho))) break;
    }
    return d + (input - d - left * (1.0 - exp(-d / turnover_rise))) / slope;  // one more carries the derivatives
  }
};
}  // namespace tendonlab::transmission
