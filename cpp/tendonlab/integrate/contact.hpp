#pragma once
// Modes: which way ports slide or whether they stick, on which flank gaps touch. Margins, and what follows an event.
#include "tendonlab/integrate/linearise.hpp"

namespace tendonlab::integrate {
/// The modes of one system and the questions asked of them. Knows ports and laws' roles, no particular law.
///
/// A port at rest sticks while what pushes it is below its level in that direction, or else slides where it is pushed.
/// Levels are functions of the state, not of what holds it, so there is always exactly one of these; but for a level
/// below 0, of friction that would feed its motion: it never sticks, and of two senses takes the one it is pushed to.
template <class System, class T>
class Contact {
  static constexpr int n = System::dof, directions = System::directions, num_modes = modes<System>;
  static constexpr bool general = System::moving || systems::drives_a_port<System>();
  using Y = StateOf<System, T>;
  using F = Frame<System, T>;

 public:
  template <class Inputs>
  Contact(const System& of, const Inputs& in) : system(of) {
    const bool driven = systems::is_driven<System>(in);
    for (int& port : representative) port = -1;
    unroll<slots<System>>([&](auto i) {
      constexpr auto port = System::ports[i];
      const auto& slot = std::get<static_cast<std::size_t>(i)>(system.slot);
      direction_of[i] = -1;
      if constexpr (port.direction >= 0) {
        const bool follows = driven && port.direction_while_driven >= 0;
        const int m = follows ? port.direction_while_driven : port.direction;
        direction_of[i] = m;
        if (representative[m] < 0) representative[m] = i;
        directed[m] = directed[m] || slot.directed();
        prescribed[m] = port.driven || follows;
        weightless[m] = is_weightless(i) && !prescribed[m];
      }
      if constexpr (port.side >= 0) {
        side_port[port.side] = i;
        gapped[port.side] = slot.has(role::motion);
      }
    });
  }
  bool guarded(int m) const { return m < directions ? directed[m] : gapped[m]; }
  /// Does port i stick?
  bool sticks(int i, const F& frame) const {
    return direction_of[i] >= 0 && directed[direction_of[i]] && mode_of(direction_of[i], frame) == 0.0;
  }

  /// Does mode m go straight from one direction to the other? Where its velocity is an input, and where what slides
  /// weighs next to nothing and cannot stick: the push on it at rest is nothing but rounding.
  template <class Inputs>
  bool only_turns(int m, const Y& y, const F& frame, const Inputs& in) const {
    return prescribed[m] || (weightless[m] && plain(breakaway(m, 1.0, y, frame, in).level) <= 0.0);
  }

  template <class Inputs>
  T sliding_velocity(int m, const Y& y, const F& frame, const Inputs& in) const {
    if constexpr (general)
      return couple(system, y.at, frame.mode, in).port[static_cast<std::size_t>(representative[m])].velocity;
    else
      return along(system, representative[m], y.at.velocity);
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
      const auto c = couple_in_duals(system, y, frame, in);
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
        if (System::ports[i].side == m) gap = std::get<static_cast<std::size_t>(i)>(system.slot).half_gap();
    });
    return gap;
  }

  /// Fits the projection to the modes: accelerations a -> a - W G' (G W G')^-1 G a over the sticking ports G.
  template <class Geometry>
  void hold(F& frame, const Geometry& geometry) const {
    int stuck[directions > 0 ? directions : 1], count = 0;
    for (int m = 0; m < directions; ++m)
      if (directed[m] && mode_of(m, frame) == 0.0) stuck[count++] = m;
    frame.holds = count > 0;
    if (!frame.holds) return;
    for (int j = 0; j < n; ++j)
      for (int l = 0; l < n; ++l) frame.keep[j][l] = T(j == l ? 1.0 : 0.0);
    for (int a = 0; a < count; ++a) remove(frame, geometry, representative[stuck[a]]);
  }

  /// Efforts that hold the sticking ports at rest, one a mode (0 where it slides): positive pushes backwards.
  template <class Inputs>
  std::array<T, directions> holding(const Y& y, const F& frame, const Inputs& in) const {
    F free = frame;
    free.holds = false;
    const auto r = rate(system, y, free, in);
    const auto& geometry = this->geometry(y, frame, in);
    std::array<T, directions> effort{};
    T matrix[directions][directions + 1];
    int index[directions] = {}, count = 0;
    for (int m = 0; m < directions; ++m)
      if (directed[m] && mode_of(m, frame) == 0.0) index[count++] = m;
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < count; ++b)
        matrix[a][b] = compliance(geometry, representative[index[a]], representative[index[b]]);
      matrix[a][count] = along(geometry, representative[index[a]], r.acceleration);
    }
    for (int a = 0; a < count; ++a)
      for (int b = a + 1; b < count; ++b) {
        const T f = matrix[b][a] / matrix[a][a];
        for (int c = a; c <= count; ++c) matrix[b][c] = matrix[b][c] - f * matrix[a][c];
      }
    for (int a = count - 1; a >= 0; --a) {
      T sum = matrix[a][count];
      for (int b = a + 1; b < count; ++b) sum = sum - matrix[a][b] * effort[static_cast<std::size_t>(index[b])];
      effort[static_cast<std::size_t>(index[a])] = sum / matrix[a][a];
    }
    return effort;
  }

  /// Where mode m breaks away: the level up to which it sticks, an effort at the port that stands for it, and what
  /// friction then is at each of its ports.
  struct Breakaway {
    T level{};
    std::array<T, slots<System>> force{};
  };
  template <class Inputs>
  Breakaway breakaway(int m, double direction, const Y& y, const F& frame, const Inputs& in) const {
    auto pushed = frame.mode;
    pushed[static_cast<std::size_t>(m)] = direction;
    const auto c = couple(system, y.at, pushed, in);
    const auto& geometry = geometry_of(system, c);
    Breakaway at;
    unroll<slots<System>>([&](auto i) {
      if constexpr (System::ports[i].direction >= 0)
        if (direction_of[i] == m) {
          const T level = std::get<static_cast<std::size_t>(i)>(system.slot).stick_level(c.port[i]);
          at.force[i] = c.port[i].direction * level;
          // ports of one mode may sit on different radii
          if (i == 0 || representative[m] == i)
            at.level = at.level + level;
          else if (plain(level) != 0.0)
            at.level = at.level + level * radius(geometry, i, representative[m]);
        }
    });
    return at;
  }
  /// What friction adds to the force of each sticking port: together it holds them, each with the same share of what it
  /// breaks away at.
  template <class Inputs>
  [[gnu::noinline]] std::array<T, slots<System>> borne(const Y& y, const F& frame, const Inputs& in) const {
    std::array<T, slots<System>> force{};
    const auto push = holding(y, frame, in);
    for (std::size_t m = 0; m < directions; ++m) {
      if (!directed[m] || frame.mode[m] != 0.0) continue;
      const auto edge = breakaway(static_cast<int>(m), plain(push[m]) < 0 ? -1.0 : 1.0, y, frame, in);
      if (!(plain(edge.level) > 0)) continue;
      const T share = abs(push[m]) / edge.level;
      for (std::size_t i = 0; i < force.size(); ++i) force[i] = force[i] + share * edge.force[i];
    }
    return force;
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

  /// Takes the sliding velocity of mode m to exactly 0: its value only, the derivatives at this instant stay.
  template <class Inputs>
  void rest(int m, Y& y, const F& frame, const Inputs& in) const {
    const int port = representative[m];
    const auto& geometry = this->geometry(y, frame, in);
    double norm = 0;
    for (int j = 0; j < n; ++j) norm += square(plain(geometry.lever[port][j]));
    const double excess = plain(sliding_velocity(m, y, frame, in)) / norm;
    for (std::size_t j = 0; j < n; ++j) {
      const double lever = plain(geometry.lever[port][j]);
      if (lever != 0.0) y.at.velocity[j] = y.at.velocity[j] - excess * lever;
    }
  }

  /// Releases whatever cannot hold, the worst first, until all that sticks can; ports in `turning` are at rest and
  /// choose whether to stick or where to slide.
  template <class Inputs>
  void settle(const Y& y, F& frame, const std::array<bool, num_modes>& turning, const Inputs& in) const {
    for (int m = 0; m < directions; ++m)
      if (turning[m] && directed[m] && !prescribed[m]) frame.mode[m] = 0.0;
    const auto& geometry = this->geometry(y, frame, in);
    hold(frame, geometry);
    for (int round = 0; round <= directions && frame.holds; ++round) {
      const auto push = holding(y, frame, in);
      int worst = -1;
      double excess = 0;
      for (int m = 0; m < directions; ++m) {
        if (!directed[m] || frame.mode[m] != 0.0) continue;
        const double effort = plain(push[static_cast<std::size_t>(m)]);
        const double level = plain(breakaway(m, effort < 0 ? -1.0 : 1.0, y, frame, in).level);
        const double over = std::fabs(effort) - level;
        if (level > 0 && over <= 1e-12 * level) continue;
        if (worst < 0 || over > excess) worst = m, excess = over;
      }
      if (worst < 0) return;
      frame.mode[worst] = plain(push[worst]) < 0 ? -1.0 : 1.0;
      hold(frame, geometry);
    }
  }

  const System& system;

 private:
  /// Whoever knows levers and inverse inertias at `y`: the system itself, or its answer where its geometry moves.
  template <class Inputs>
  decltype(auto) geometry(const Y& y, const F& frame, const Inputs& in) const {
    if constexpr (System::moving)
      return couple(system, y.at, frame.mode, in);
    else
      return (system);
  }
  template <class Geometry, class V>
  static T along(const Geometry& geometry, int port, const std::array<V, n>& of) {
    T sum = geometry.lever[port][0] * of[0];
    for (std::size_t j = 1; j < n; ++j) sum = sum + geometry.lever[port][j] * of[j];
    return sum;
  }
  template <class Geometry>
  static T compliance(const Geometry& geometry, int a, int b) {
    T sum(0.0);
    for (std::size_t j = 0; j < n; ++j)
      sum = sum + geometry.lever[a][j] * geometry.inverse_inertia[j] * geometry.lever[b][j];
    return sum;
  }
  static Plain<T> mode_of(int m, const F& frame) { return frame.mode[static_cast<std::size_t>(m)]; }
  /// Does port i move nothing but what has no inertia of its own?
  static constexpr bool is_weightless(int i) {
    bool light = systems::stated<System> < n;
    for (int j = 0; j < systems::stated<System>; ++j) light = light && !System::joined[i][j];
    return light;
  }
  /// The radius of port `a` over that of `b`, which moves with it.
  template <class Geometry>
  static T radius(const Geometry& geometry, int a, int b) {
    T both(0.0), own(0.0);
    for (std::size_t j = 0; j < n; ++j) {
      both = both + geometry.lever[a][j] * geometry.lever[b][j];
      own = own + geometry.lever[b][j] * geometry.lever[b][j];
    }
    return abs(T(both / own));
  }
  /// One more port at rest: keep -= (keep W g)(g' keep) / (g' keep W g). For a port on one axis the entry is exactly 0.
  template <class Geometry>
  static void remove(F& frame, const Geometry& geometry, int port) {
    T row[n], column[n], pivot(0.0);
    for (int j = 0; j < n; ++j) {
      row[j] = column[j] = T(0.0);
      for (int l = 0; l < n; ++l) {
        row[j] = row[j] + geometry.lever[port][l] * frame.keep[l][j];
        column[j] = column[j] + frame.keep[j][l] *
                                    (geometry.inverse_inertia[static_cast<std::size_t>(l)] * geometry.lever[port][l]);
      }
    }
    for (int j = 0; j < n; ++j) pivot = pivot + geometry.lever[port][j] * column[j];
    for (int j = 0; j < n; ++j) {
      const T share = column[j] / pivot;
      for (int l = 0; l < n; ++l) frame.keep[j][l] = frame.keep[j][l] - share * row[l];
    }
  }

  int representative[directions > 0 ? directions : 1] = {}, side_port[num_modes] = {}, direction_of[slots<System>] = {};
  bool directed[num_modes] = {}, gapped[num_modes] = {}, prescribed[num_modes] = {}, weightless[num_modes] = {};
};
}  // namespace tendonlab::integrate
