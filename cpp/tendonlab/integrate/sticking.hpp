#pragma once
// Ports at rest: what holds them, where they break away, and which of them stick.
#include "tendonlab/integrate/mode_table.hpp"

namespace tendonlab::integrate {
/// A port at rest sticks while the push on it stays below its level in that direction; otherwise it slides the way it
/// is pushed. The level depends on the state only, so exactly one case applies. Exception: a negative level (friction
/// that would feed the motion) never sticks; the port slides the way it is pushed.
template <class System, class T>
class Sticking : public ModeTable<System, T> {
  using Base = ModeTable<System, T>;
  static constexpr int n = System::dof, directions = System::directions, num_modes = modes<System>;
  using Y = StateOf<System, T>;
  using F = Frame<System, T>;

 public:
  using Base::Base, Base::system;

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

  /// Takes over modes that were decided elsewhere.
  template <class Inputs>
  void take_over(const decltype(F::mode)& modes, const Y& y, F& frame, const Inputs& in) const {
    frame.mode = modes;
    frame.holds = false;
    for (int m = 0; m < directions; ++m)
      if (directed[m] && mode_of(m, frame) == 0.0) return hold(frame, geometry(y, frame, in));
  }

  /// Efforts that hold the sticking ports at rest, one per mode (0 where it slides): positive pushes backwards.
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
        if (this->direction_of[i] == m) {
          const T level = std::get<static_cast<std::size_t>(i)>(this->system.slot).stick_level(c.port[i]);
          at.force[i] = c.port[i].direction * level;
          // ports of one mode may sit on different radii
          if (i == 0 || this->representative[m] == i)
            at.level = at.level + level;
          else if (plain(level) != 0.0)
            at.level = at.level + level * radius(geometry, i, this->representative[m]);
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

  /// Releases whatever cannot hold, the worst first, until all that sticks can; ports in `turning` are at rest and
  /// choose whether to stick or where to slide.
  template <class Inputs>
  void settle(const Y& y, F& frame, const std::array<bool, num_modes>& turning, const Inputs& in) const {
    bool at_rest = false;
    for (int m = 0; m < directions; ++m) {
      if (turning[m] && directed[m] && !prescribed[m]) frame.mode[m] = 0.0;
      at_rest = at_rest || (directed[m] && frame.mode[m] == 0.0);
    }
    frame.holds = false;
    if (!at_rest) return;
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

 protected:
  using Base::directed, Base::direction_of, Base::mode_of, Base::prescribed, Base::representative;

  /// Levers and inverse inertias at `y`: of the system itself, or of its coupling where its geometry moves.
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

 private:
  template <class Geometry>
  static T compliance(const Geometry& geometry, int a, int b) {
    T sum(0.0);
    for (std::size_t j = 0; j < n; ++j)
      sum = sum + geometry.lever[a][j] * geometry.inverse_inertia[j] * geometry.lever[b][j];
    return sum;
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
};
}  // namespace tendonlab::integrate
