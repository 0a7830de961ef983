#pragma once
// Eight simulations of one experiment whose steps are computed together, one in each lane. Whatever is decided, each
// simulation decides for itself: so the answer of one does not depend on its neighbours.
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
  explicit Lockstep(const Experiment& experiment) : in(experiment) {}

  /// An attempt of some of the simulations, at least one: those that take a step of the kind that most of them want.
  /// `taken(lane, attempt, step)` gets each.
  template <class Plans, class Taken>
  void attempt(const Simulations& all, const System& system, const Plans& plans, Taken&& taken) {
    int votes = 0;
    for (std::size_t l = 0; l < count; ++l)
      if (all[l]) votes += plans[l].explicitly ? 1 : -1;
    const bool explicitly = votes > 0;
    gather(all, plans, explicitly);
    const auto step = explicitly ? advance_explicitly<Kutta>(system, y, frame, in, length)
                                 : advance<Tableau>(system, y, frame, in, length);
    for (std::size_t l = 0; l < count; ++l)
      if (all[l] && plans[l].explicitly == explicitly)
        taken(l, Step<StateOf<Of<double>, double>>{
                     lane(static_cast<int>(l), step.from), lane(static_cast<int>(l), step.to),
                     lane(static_cast<int>(l), step.first), lane(static_cast<int>(l), step.second),
                     lane(static_cast<int>(l), step.third), lane(static_cast<int>(l), step.error)});
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
    const auto numbers = [&](auto of)
                             TENDONLAB_ALWAYS { return by_lane([&](int l) TENDONLAB_ALWAYS { return of(*one[l]); }); };
    length = Lanes(by);
    for (std::size_t j = 0; j < n; ++j) {
      y.at.position[j] = numbers([&](const One& s) { return s.y.at.position[j]; });
      y.at.velocity[j] = numbers([&](const One& s) { return s.y.at.velocity[j]; });
    }
    for (std::size_t i = 0; i < nz; ++i) y.memory[i] = numbers([&](const One& s) { return s.y.memory[i]; });
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
    in.follow([&](int l) -> const Readings<double>& { return one[l]->inputs(); });
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

  LaneReadings in;
  StateOf<System, Lanes> y;
  Frame<System, Lanes> frame{};
  Lanes length{1.0};
};
}  // namespace tendonlab::integrate
