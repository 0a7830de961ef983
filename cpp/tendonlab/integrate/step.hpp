#pragma once
// One step, Rosenbrock or explicit: stages, error, dense output. Knows rates and blocks, no physics.
#include "tendonlab/integrate/elimination.hpp"
#include "tendonlab/integrate/tableau.hpp"

namespace tendonlab::integrate {
template <class Y>
TENDONLAB_INLINE void add(Y& y, double s, const Y& k) {
  for (std::size_t j = 0; j < y.at.position.size(); ++j) {
    y.at.position[j] = y.at.position[j] + s * k.at.position[j];
    y.at.velocity[j] = y.at.velocity[j] + s * k.at.velocity[j];
  }
  for (std::size_t i = 0; i < y.memory.size(); ++i) y.memory[i] = y.memory[i] + s * k.memory[i];
}

/// The scalar of a share `S` of numbers `F`: lanes of shares of a double are lanes.
template <class S, class F>
using Blend = std::conditional_t<in_lanes<S>, S, F>;

/// A step and its dense output: from + s (to - from + (1-s)(first + s (second + s third))), s from 0 to 1: what does
/// not move stays where it is, to the last bit.
template <class Y>
struct Step;
template <class F, int dof, int nz>
struct Step<State<F, dof, nz>> {
  using Y = State<F, dof, nz>;
  Y from, to, first, second, third;
  State<Plain<F>, dof, nz> error;
  bool bare_inside = false;  ///< lack `first` and `second` their derivatives?
  /// The state at the share `s` of the step; its time is left to the caller.
  template <class S>
  State<Blend<S, F>, dof, nz> at(const S& s) const {
    const auto blend = [&](const F& a, const F& b, const F& c, const F& d, const F& e) {
      return a + s * ((b - a) + (1.0 - s) * (c + s * (d + s * e)));
    };
    State<Blend<S, F>, dof, nz> y;
    for (std::size_t j = 0; j < dof; ++j) {
      y.at.position[j] = blend(from.at.position[j], to.at.position[j], first.at.position[j], second.at.position[j],
                               third.at.position[j]);
      y.at.velocity[j] = blend(from.at.velocity[j], to.at.velocity[j], first.at.velocity[j], second.at.velocity[j],
                               third.at.velocity[j]);
    }
    for (std::size_t i = 0; i < nz; ++i)
      y.memory[i] = blend(from.memory[i], to.memory[i], first.memory[i], second.memory[i], third.memory[i]);
    return y;
  }
};

/// A step without its derivatives.
template <class Y>
auto values(const Step<Y>& s) {
  return Step<std::decay_t<decltype(values(s.from))>>{values(s.from),   values(s.to),    values(s.first),
                                                      values(s.second), values(s.third), s.error};
}
template <int dof, int nz>
const auto& values(const Step<State<double, dof, nz>>& s) {
  return s;
}

/// Where a step lies in time, s: it starts at `start`, has a `length`, of which `taken` is used.
struct Interval {
  double start, length, taken;
};

/// Is row i of A the row before and the whole of the increment before?
template <class Tableau, int i>
constexpr bool continues() {
  if (i == 0) return false;
  for (int j = 0; j < i - 1; ++j)
    if (Tableau::A[i][j] != Tableau::A[i - 1][j]) return false;
  return Tableau::A[i][i - 1] == 1.0;
}

/// The increment of stage `i`: (alpha - J) k_i = f(Y_i) + sum C_ij k_j / h + h d_i f_t. `at`: Y of the stage before,
/// then of this one.
template <class Tableau, int i, class System, class T, class Y, class Inputs>
TENDONLAB_INLINE void stage(const System& system, const Y& y, const Frame<System, T>& frame, const Inputs& in,
                            Plain<T> h, Plain<T> per_h, const Arrowhead<System, T>& blocks,
                            const Elimination<System, T>& solver, Y& at, Y (&k)[Tableau::stages]) {
  constexpr int n = System::dof, nz = memories<System>;
  Y r{};
  if constexpr (continues<Tableau, i>())
    add(at, 1.0, k[i - 1]);
  else
    at = y;
  unroll<i>([&](auto j) TENDONLAB_ALWAYS {
    if constexpr (!continues<Tableau, i>()) add(at, Tableau::A[i][j], k[j]);
    add(r, Tableau::C[i][j], k[j]);
  });
  Rate<T, n, nz> f = blocks.rate;
  if constexpr (i > 0) {
    at.at.time = y.at.time + Tableau::c[i] * h;
    f = rate(system, at, frame, in);
  }
  const Plain<T> drift = h * Tableau::d[i];
  for (std::size_t j = 0; j < n; ++j) {
    r.at.position[j] = r.at.position[j] * per_h + at.at.velocity[j];
    r.at.velocity[j] = r.at.velocity[j] * per_h + f.acceleration[j];
    if constexpr (Tableau::d[i] != 0) r.at.velocity[j] = r.at.velocity[j] + drift * blocks.acceleration_by[j][2 * n];
  }
  for (std::size_t m = 0; m < nz; ++m) {
    r.memory[m] = r.memory[m] * per_h + f.memory[m];
    if constexpr (Tableau::d[i] != 0) r.memory[m] = r.memory[m] + drift * blocks.memory_by[m][2 * n];
  }
  k[i] = solver.solve(r);
}

template <class Tableau, class System, class T, class Inputs>
[[gnu::flatten]] Step<StateOf<System, T>> advance(const System& system, const StateOf<System, T>& y,
                                                  const Frame<System, T>& frame, const Inputs& in, Plain<T> h) {
  using Y = StateOf<System, T>;
  const auto blocks = linearise(system, y, frame, in);
  const Elimination<System, T> solver(blocks, h, Tableau::gamma);
  const Plain<T> per_h = 1.0 / h;
  Y k[Tableau::stages], at = y;
  unroll<Tableau::stages>(
      [&](auto i) TENDONLAB_ALWAYS { stage<Tableau, i>(system, y, frame, in, h, per_h, blocks, solver, at, k); });
  // Stiffly accurate: the last stage and its increment, which is the error.
  add(at, 1.0, k[Tableau::stages - 1]);
  Step<Y> s{y, at, {}, {}, {}, plainly(k[Tableau::stages - 1])};
  unroll<Tableau::stages>([&](auto j) TENDONLAB_ALWAYS {
    add(s.first, Tableau::D[0][j], k[j]);
    add(s.second, Tableau::D[1][j], k[j]);
    add(s.third, Tableau::D[2][j], k[j]);
  });
  s.to.at.time = y.at.time + h;
  return s;
}

/// The change of a state over `h` at its present rate.
template <class System, class T, class Inputs>
TENDONLAB_INLINE StateOf<System, T> change(const System& system, const StateOf<System, T>& y,
                                           const Frame<System, T>& frame, const Inputs& in, Plain<T> h) {
  const auto f = rate(system, y, frame, in);
  StateOf<System, T> k;
  for (std::size_t j = 0; j < System::dof; ++j) {
    k.at.position[j] = h * y.at.velocity[j];
    k.at.velocity[j] = h * f.acceleration[j];
  }
  for (std::size_t i = 0; i < k.memory.size(); ++i) k.memory[i] = h * f.memory[i];
  return k;
}

/// The inside of a step: the cubic through both ends and their changes over the step.
template <class Y>
TENDONLAB_INLINE void bend(Step<Y>& s, const Y& at_start, const Y& at_end) {
  Y rise = s.to;
  add(rise, -1.0, s.from);
  s.first = at_start, s.second = Y{};
  add(s.first, -1.0, rise);
  add(s.second, 2.0, rise);
  add(s.second, -1.0, at_start);
  add(s.second, -1.0, at_end);
}

/// An explicit step: less work than a Rosenbrock step, for steps so short that nothing is stiff (`fastest_rate`).
/// `at_end(to)`: the change at the end of the step, which its error and its inside need. Without derivatives, those of
/// the inside are left to `bend`: few steps are looked into.
template <class Tableau, class System, class T, class Inputs, class AtEnd>
[[gnu::flatten]] Step<StateOf<System, T>> advance_explicitly(const System& system, const StateOf<System, T>& y,
                                                             const Frame<System, T>& frame, const Inputs& in,
                                                             Plain<T> h, AtEnd&& at_end) {
  using Y = StateOf<System, T>;
  constexpr int last = Tableau::stages - 1;
  Y k[last];
  Step<Y> s{y, y, {}, {}, {}, {}};
  for (int i = 0; i <= last; ++i) {
    s.to = y;
    for (int j = 0; j < i; ++j) add(s.to, Tableau::A[i][j], k[j]);
    s.to.at.time = y.at.time + Tableau::c[i] * h;
    if (i < last) k[i] = change(system, s.to, frame, in, h);
  }
  const auto end = at_end(s.to);
  for (int i = 0; i < last; ++i) add(s.error, Tableau::error[i], plainly(k[i]));
  add(s.error, Tableau::error[last], plainly(end));
  if constexpr (std::is_same_v<std::decay_t<decltype(end)>, Y>) {
    bend(s, k[0], end);
  } else {
    auto bare = values(s);
    bend(bare, values(k[0]), end);
    s.first = lifted<T>(bare.first), s.second = lifted<T>(bare.second), s.bare_inside = true;
  }
  return s;
}
template <class Tableau, class System, class T, class Inputs>
TENDONLAB_INLINE auto advance_explicitly(const System& system, const StateOf<System, T>& y,
                                         const Frame<System, T>& frame, const Inputs& in, Plain<T> h) {
  return advance_explicitly<Tableau>(system, y, frame, in, h, [&](const StateOf<System, T>& to) TENDONLAB_ALWAYS {
    return change(system, to, frame, in, h);
  });
}
}  // namespace tendonlab::integrate
