#pragma once
// Eight simulations of one experiment whose steps are computed together, one in each lane. Whatever is decided follows
// from a lane's own numbers: so the answer of one does not depend on its neighbours.
#include "tendonlab/integrate/lane_readings.hpp"
#include "tendonlab/integrate/simulation.hpp"

namespace tendonlab::integrate {
template <template <class> class Of, class Tableau = Rodas5P>
class Lockstep {
  using One = Simulation<Of, double>;
  using System = Of<Lanes>;
  static constexpr int n = System::dof, nz = memories<System>;
  static constexpr auto count = static_cast<std::size_t>(Lanes::count);

 public:
  using Simulations = std::array<One*, count>;  ///< null: nothing runs in this lane
  Lockstep(const Experiment& experiment, const Settings& with) : settings(with), in(experiment) {}

  /// An attempt of some of the simulations, at least one: those that take a step of the kind that most of them want,
  /// where one that has waited counts more. taken(lane, wish, crosses, step) gets each, judged as `take_judged` wants.
  template <class Plans, class Taken>
  void attempt(const Simulations& all, const System& system, const Plans& plans, Taken&& taken) {
    int votes = 0;
    for (std::size_t l = 0; l < count; ++l)
      if (all[l]) votes += (plans[l].explicitly ? 1 : -1) * (1 + waited[l]);
    const bool explicitly = votes > 0;
    for (std::size_t l = 0; l < count; ++l) waited[l] = all[l] && plans[l].explicitly != explicitly ? waited[l] + 1 : 0;
    gather(all, plans, explicitly);
    const auto step = explicitly ? advance_explicitly<Kutta>(system, y, frame, in, length)
                                 : advance<Tableau>(system, y, frame, in, length);
    const auto mean_square = [&](auto method) {
      return mean_square_error<decltype(method), System, Lanes>(system, settings, y, step, memory_level);
    };
    const Lanes wish =
        explicitly ? growth_after<Kutta>(mean_square(Kutta{})) : growth_after<Tableau>(mean_square(Tableau{}));
    double wishes[count];
    wish.store(wishes);
    const unsigned crossing = crossings(system, step.to);
    for (std::size_t l = 0; l < count; ++l)
      if (all[l] && plans[l].explicitly == explicitly)
        taken(l, wishes[l], (crossing >> l & 1u) != 0 || all[l]->inputs().saturates(), [&] {
          const int k = static_cast<int>(l);
          return Step<StateOf<Of<double>, double>>{lane(k, step.from),   lane(k, step.to),    lane(k, step.first),
                                                   lane(k, step.second), lane(k, step.third), {}};
        });
  }

 private:
  /// Puts the simulations that take part into their lanes; one of them fills the others.
  template <class Plans>
  void gather(const Simulations& all, const Plans& plans, bool explicitly) {
    const One* one[Lanes::count] = {};
    double by[Lanes::count];
    const auto takes_part = [&](std::size_t l) { return all[l] && plans[l].explicitly == explicitly; };
    std::size_t some = 0;
    while (!takes_part(some)) ++some;
    frame.holds = false;
    for (std::size_t l = 0; l < count; ++l) {
      const std::size_t from = takes_part(l) ? l : some;
      one[l] = all[from], by[l] = plans[from].length;
      frame.holds = frame.holds || one[l]->modes_now().holds;
    }
    const auto numbers = [&](auto of) TENDONLAB_ALWAYS {
      return by_lane<Lanes>([&](int l) TENDONLAB_ALWAYS { return of(*one[l]); });
    };
    length = Lanes(by);
    for (std::size_t j = 0; j < n; ++j) {
      y.at.position[j] = numbers([&](const One& s) { return s.y.at.position[j]; });
      y.at.velocity[j] = numbers([&](const One& s) { return s.y.at.velocity[j]; });
    }
    for (std::size_t i = 0; i < nz; ++i) y.memory[i] = numbers([&](const One& s) { return s.y.memory[i]; });
    unroll<slots<System>>([&](auto i) {
      if constexpr (SlotOf<System, i>::states > 0)
        memory_level[i] = numbers([&](const One& s) { return s.memory_levels()[i]; });
    });
    y.at.time = numbers([](const One& s) { return s.y.at.time; });
    for (std::size_t m = 0; m < frame.mode.size(); ++m)
      frame.mode[m] = numbers([&](const One& s) { return s.modes_now().mode[m]; });
    if (frame.holds)
      for (int j = 0; j < n; ++j)
        for (int k = 0; k < n; ++k)
          frame.keep[j][k] = numbers([&](const One& s) {
            const auto& modes = s.modes_now();
            return modes.holds ? modes.keep[j][k] : j == k ? 1.0 : 0.0;
          });
    in.follow_each([&](int l) -> const Readings<double>& { return one[l]->inputs(); });
  }
  /// A bit for each lane in which a port that slid or a gap may have passed its guard.
  unsigned crossings(const System& system, const StateOf<System, Lanes>& to) const {
    const Contact<System, Lanes> contact(system, in);
    PackMask<Lanes::count> crossed{};
    for (int m = 0; m < modes<System>; ++m) {
      if (!contact.guarded(m)) continue;
      const Lanes& mode = frame.mode[static_cast<std::size_t>(m)];
      if (m < System::directions) {
        crossed = crossed | (mode * contact.sliding_velocity(m, to, frame, in) < -One::on_guard);
      } else if constexpr (System::sides > 0) {
        const Lanes stretch = contact.stretch(m, to, frame, in), gap = contact.half_gap(m);
        crossed = crossed | (select(mode == 0.0, gap - abs(stretch), mode * stretch - gap) < -One::on_guard);
      }
    }
    return bits_of(crossed);
  }
  static StateOf<Of<double>, double> lane(int l, const StateOf<System, Lanes>& of) {
    StateOf<Of<double>, double> out;
    for (std::size_t j = 0; j < n; ++j) {
      out.at.position[j] = of.at.position[j][l];
      out.at.velocity[j] = of.at.velocity[j][l];
    }
    out.at.time = of.at.time[l];
    for (std::size_t i = 0; i < nz; ++i) out.memory[i] = of.memory[i][l];
    return out;
  }

  const Settings& settings;
  LaneReadings in;
  StateOf<System, Lanes> y;
  Frame<System, Lanes> frame{};
  Lanes length{1.0};
  std::array<Lanes, slots<System>> memory_level;
  std::array<int, count> waited{};  ///< attempts that a simulation was left out of
};
}  // namespace tendonlab::integrate
