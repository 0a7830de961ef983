#pragma once
// When modes end: the margin of each mode is positive while the mode holds.
#include "tendonlab/integrate/sticking.hpp"

namespace tendonlab::integrate {
/// The modes of one system: which way ports slide or whether they stick, on which flank gaps touch.
template <class System, class T>
class Contact : public Sticking<System, T> {
  using Base = Sticking<System, T>;
  static constexpr int n = System::dof, directions = System::directions, num_modes = modes<System>;
  static constexpr bool general = System::moving || systems::drives_a_port<System>();  ///< levers do not tell all
  using Y = StateOf<System, T>;
  using F = Frame<System, T>;
  using Base::along, Base::prescribed, Base::representative, Base::side_port, Base::weightless;

 public:
  using Base::Base, Base::breakaway, Base::holding, Base::system;

  /// Does mode m go straight from one direction to the other? Where its velocity is an input, and where what slides
  /// weighs next to nothing and cannot stick: the push on it at rest is nothing but rounding.
  template <class Inputs>
  bool only_turns(int m, const Y& y, const F& frame, const Inputs& in) const {
    return prescribed[m] || (weightless[m] && plain(breakaway(m, 1.0, y, frame, in).level) <= 0.0);
  }

  /// Does mode m keep its direction at rest, because inputs drive what slides? No unresolved velocity may
  /// turn it then.
  bool is_prescribed(int m) const { return m < directions && prescribed[m]; }

  template <class Inputs>
  T sliding_velocity(int m, const Y& y, const F& frame, const Inputs& in) const {
    if constexpr (general)
      if (System::moving || prescribed[m])
        return couple(system, y.at, frame.mode, in).port[static_cast<std::size_t>(representative[m])].velocity;
    if constexpr (!System::moving) return along(system, representative[m], y.at.velocity);
  }
  template <class Inputs>
  T stretch(int m, const Y& y, const F& frame, const Inputs& in) const {
    if constexpr (general)
      return couple(system, y.at, frame.mode, in).port[static_cast<std::size_t>(side_port[m])].position;
    else
      return along(system, side_port[m], y.at.position);
  }
  /// How fast the sliding velocity (or, for a gap, the stretch) of mode m changes while the state moves with `rate`.
  template <class R, class Inputs>
  double guard_rate(int m, const Y& y, const R& rate, const F& frame, const Inputs& in) const {
    const bool slides = m < directions;
    if constexpr (general) {
      const auto c = couple_in_duals<false>(system, y, frame, in);
      const auto& guard = [&]() -> const auto& {
        if constexpr (System::sides > 0)
          if (!slides) return c.port[static_cast<std::size_t>(side_port[m])].position;
        return c.port[static_cast<std::size_t>(representative[m])].velocity;
      }
      ();
      double sum = plain(guard.d[2 * n]);
      for (std::size_t j = 0; j < n; ++j)
        sum += plain(guard.d[j]) * plain(y.at.velocity[j]) + plain(guard.d[n + j]) * plain(rate.acceleration[j]);
      return sum;
    } else {
      return plain(slides ? along(system, representative[m], rate.acceleration)
                          : along(system, side_port[m], y.at.velocity));
    }
  }
  T half_gap(int m) const {
    T gap(0.0);
    unroll<slots<System>>([&](auto i) {
      if constexpr (System::ports[i].side >= 0)
        if (System::ports[i].side == m) gap = std::get<static_cast<std::size_t>(i)>(this->system.slot).half_gap();
    });
    return gap;
  }

  /// To which side of its gap mode m has moved; 0 where it has none.
  template <class Inputs>
  double toward(int m, const Y& y, const F& frame, const Inputs& in) const {
    if constexpr (System::sides > 0)
      if (m >= directions && m < num_modes) return plain(stretch(m, y, frame, in)) > 0 ? 1.0 : -1.0;
    return 0.0;
  }
  /// Positive while mode m holds; for a sticking port the share of its level that is left, inside a gap the way to the
  /// edge on the side `toward`: a step that begins on one edge may well end beyond the other.
  template <class Inputs>
  double margin(int m, const Y& y, double toward, const F& frame, const Inputs& in) const {
    const double mode = frame.mode[static_cast<std::size_t>(m)];
    if constexpr (System::sides > 0)
      if (m >= directions) {
        const double g = plain(stretch(m, y, frame, in)), gap = plain(half_gap(m));
        return mode == 0.0 ? gap - toward * g : mode * g - gap;
      }
    if (mode != 0.0) return mode * plain(sliding_velocity(m, y, frame, in));
    const double push = plain(holding(y, frame, in)[static_cast<std::size_t>(m)]);
    const double level = plain(breakaway(m, push < 0 ? -1.0 : 1.0, y, frame, in).level);
    return level > 0 ? 1.0 - std::fabs(push) / level : -1.0;
  }

  /// The velocity that takes the sliding velocity of mode m to exactly 0 when it is subtracted.
  template <class Inputs>
  std::array<T, n> excess(int m, const Y& y, const F& frame, const Inputs& in) const {
    const int port = representative[m];
    const auto& geometry = this->geometry(y, frame, in);
    T norm(0.0);
    for (int j = 0; j < n; ++j) norm = norm + square(geometry.lever[port][j]);
    const T sliding = sliding_velocity(m, y, frame, in) / norm;
    std::array<T, n> each;
    for (std::size_t j = 0; j < n; ++j) each[j] = sliding * geometry.lever[port][j];
    return each;
  }
};
/// Ports at an instant: the modes, and what they stand for.
template <class System, class T>
struct PortModes {
  const Contact<System, T>& contact;
  const Frame<System, T>& frame;
};
}  // namespace tendonlab::integrate
