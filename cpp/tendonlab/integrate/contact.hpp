#pragma once
// Modes: which way ports slide or whether they stick, on which flank gaps touch. Margins, and what follows an event.
#include "tendonlab/integrate/rate.hpp"

namespace tendonlab::integrate {
/// The modes of one system and the questions asked of them. Knows ports and laws' roles, no particular law.
template <class System, class T>
class Contact {
  static constexpr int n = System::dof, directions = System::directions, num_modes = modes<System>;
  using Y = StateOf<System, T>;
  using F = Frame<System, T>;

 public:
  explicit Contact(const System& of) : system(of) {
    for (int& port : representative) port = -1;
    unroll<slots<System>>([&](auto i) {
      constexpr auto port = System::ports[i];
      const auto& slot = std::get<static_cast<std::size_t>(i)>(system.slot);
      if constexpr (port.direction >= 0) {
        if (representative[port.direction] < 0) representative[port.direction] = i;
        directed[port.direction] = directed[port.direction] || slot.directed();
        dry[port.direction] = dry[port.direction] || slot.has(role::level);
      }
      if constexpr (port.side >= 0) {
        side_port[port.side] = i;
        gapped[port.side] = slot.has(role::motion);
      }
    });
  }
  bool guarded(int m) const { return m < directions ? directed[m] : gapped[m]; }
  /// The port that stands for mode m.
  int bearer(int m) const { return representative[m]; }

  T sliding_velocity(int m, const Motion<T, n>& at) const { return along(representative[m], at.velocity); }
  T stretch(int m, const Motion<T, n>& at) const { return along(side_port[m], at.position); }
  T half_gap(int m) const {
    T gap(0.0);
    unroll<slots<System>>([&](auto i) {
      if constexpr (System::ports[i].side >= 0)
        if (System::ports[i].side == m) gap = std::get<static_cast<std::size_t>(i)>(system.slot).half_gap();
    });
    return gap;
  }

  /// Fits the projection to the modes: accelerations a -> a - W G' (G W G')^-1 G a over the sticking ports G.
  void hold(F& frame) const {
    int stuck[directions > 0 ? directions : 1], count = 0;
    for (int m = 0; m < directions; ++m)
      if (directed[m] && frame.mode[m] == 0.0) stuck[count++] = m;
    frame.holds = count > 0;
    if (!frame.holds) return;
    for (int j = 0; j < n; ++j)
      for (int l = 0; l < n; ++l) frame.keep[j][l] = T(j == l ? 1.0 : 0.0);
    for (int a = 0; a < count; ++a) remove(frame, representative[stuck[a]]);
  }

  /// Efforts that hold the sticking ports at rest, one a mode (0 where it slides): positive pushes backwards.
  template <class Inputs>
  std::array<double, directions> holding(const Y& y, const F& frame, const Inputs& in) const {
    F free = frame;
    free.holds = false;
    const auto r = rate(system, y, free, in);
    std::array<double, directions> effort{};
    double matrix[directions][directions + 1];
    int index[directions], count = 0;
    for (int m = 0; m < directions; ++m)
      if (directed[m] && frame.mode[m] == 0.0) index[count++] = m;
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < count; ++b) matrix[a][b] = compliance(representative[index[a]], representative[index[b]]);
      matrix[a][count] = plain(along(representative[index[a]], r.acceleration));
    }
    for (int a = 0; a < count; ++a)
      for (int b = a + 1; b < count; ++b) {
        const double f = matrix[b][a] / matrix[a][a];
        for (int c = a; c <= count; ++c) matrix[b][c] -= f * matrix[a][c];
      }
    for (int a = count - 1; a >= 0; --a) {
      double sum = matrix[a][count];
      for (int b = a + 1; b < count; ++b) sum -= matrix[a][b] * effort[index[b]];
      effort[index[a]] = sum / matrix[a][a];
    }
    return effort;
  }

  /// The level up to which mode m sticks when it is pushed along `direction`.
  template <class Inputs>
  double stick_level(int m, double direction, const Y& y, const F& frame, const Inputs& in) const {
    auto pushed = frame.mode;
    pushed[m] = direction;
    const auto c = system.couple(y.at, pushed, in);
    double sum = 0;
    unroll<slots<System>>([&](auto i) {
      if constexpr (System::ports[i].direction >= 0)
        if (System::ports[i].direction == m)
          sum += plain(std::get<static_cast<std::size_t>(i)>(system.slot).stick_level(c.port[i]));
    });
    return sum;
  }

  /// To which side of its gap mode m has moved; 0 where it has none.
  double toward(int m, const Motion<T, n>& at) const {
    if constexpr (System::sides > 0)
      if (m >= directions && m < num_modes) return plain(stretch(m, at)) > 0 ? 1.0 : -1.0;
    return 0.0;
  }
  /// Positive while mode m holds; for a sticking port the share of its level that is left, inside a gap the way to the
  /// edge on the side `toward`: a step that begins on one edge may well end beyond the other.
  template <class Inputs>
  double margin(int m, const Y& y, double toward, const F& frame, const Inputs& in) const {
    const double mode = frame.mode[static_cast<std::size_t>(m)];
    if constexpr (System::sides > 0)
      if (m >= directions) {
        const double g = plain(stretch(m, y.at)), gap = plain(half_gap(m));
        return mode == 0.0 ? gap - toward * g : mode * g - gap;
      }
    if (mode != 0.0) return mode * plain(sliding_velocity(m, y.at));
    const double push = holding(y, frame, in)[static_cast<std::size_t>(m)];
    const double level = stick_level(m, push < 0 ? -1.0 : 1.0, y, frame, in);
    return level > 0 ? 1.0 - std::fabs(push) / level : -1.0;
  }

  /// Takes the sliding velocity of mode m to exactly 0: its value only, the derivatives at this instant stay.
  void rest(int m, Motion<T, n>& at) const {
    const int port = representative[m];
    double norm = 0;
    for (int j = 0; j < n; ++j) norm += square(plain(system.lever[port][j]));
    const double excess = plain(sliding_velocity(m, at)) / norm;
    for (std::size_t j = 0; j < n; ++j) {
      const double lever = plain(system.lever[port][j]);
      if (lever != 0.0) at.velocity[j] = at.velocity[j] - excess * lever;
    }
  }

  /// Releases whatever cannot hold, the worst first, until all that sticks can; ports in `turning` are at rest and
  /// choose whether to stick or where to slide.
  template <class Inputs>
  void settle(const Y& y, F& frame, const std::array<bool, num_modes>& turning, const Inputs& in) const {
    for (int m = 0; m < directions; ++m)
      if (turning[m] && directed[m]) frame.mode[m] = 0.0;
    hold(frame);
    for (int round = 0; round <= directions && frame.holds; ++round) {
      const auto push = holding(y, frame, in);
      int worst = -1;
      double excess = 0;
      for (int m = 0; m < directions; ++m) {
        if (!directed[m] || frame.mode[m] != 0.0) continue;
        const double direction = push[m] < 0 ? -1.0 : 1.0;
        const double level = dry[m] ? stick_level(m, direction, y, frame, in) : 0.0;
        const double over = std::fabs(push[m]) - level;
        if (dry[m] && level > 0 ? over <= 1e-12 * level : false) continue;
        if (worst < 0 || over > excess) worst = m, excess = over;
      }
      if (worst < 0) return;
      frame.mode[worst] = push[worst] < 0 ? -1.0 : 1.0;
      hold(frame);
    }
  }

  const System& system;

 private:
  template <class V>
  T along(int port, const std::array<V, n>& of) const {
    T sum = system.lever[port][0] * of[0];
    for (std::size_t j = 1; j < n; ++j) sum = sum + system.lever[port][j] * of[j];
    return sum;
  }
  double compliance(int a, int b) const {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j)
      sum += plain(system.lever[a][j]) * plain(system.inverse_inertia[j]) * plain(system.lever[b][j]);
    return sum;
  }
  /// One more port at rest: keep -= (keep W g)(g' keep) / (g' keep W g). For a port on one axis the entry is exactly 0.
  void remove(F& frame, int port) const {
    T row[n], column[n], pivot(0.0);
    for (int j = 0; j < n; ++j) {
      row[j] = column[j] = T(0.0);
      for (int l = 0; l < n; ++l) {
        row[j] = row[j] + system.lever[port][l] * frame.keep[l][j];
        column[j] = column[j] +
                    frame.keep[j][l] * (system.inverse_inertia[static_cast<std::size_t>(l)] * system.lever[port][l]);
      }
    }
    for (int j = 0; j < n; ++j) pivot = pivot + system.lever[port][j] * column[j];
    for (int j = 0; j < n; ++j) {
      const T share = column[j] / pivot;
      for (int l = 0; l < n; ++l) frame.keep[j][l] = frame.keep[j][l] - share * row[l];
    }
  }

  int representative[directions > 0 ? directions : 1] = {}, side_port[num_modes] = {};
  bool directed[num_modes] = {}, dry[num_modes] = {}, gapped[num_modes] = {};
};
}  // namespace tendonlab::integrate
