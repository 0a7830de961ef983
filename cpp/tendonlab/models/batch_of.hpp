#pragma once
// Simulations of one experiment at many points, eight at a time: a lane takes the next point as soon as it is free.
#include "tendonlab/core/error.hpp"
#include "tendonlab/integrate/lockstep.hpp"
#include "tendonlab/models/run.hpp"

namespace tendonlab::systems {
/// Simulates points that have the same effects on.
template <template <class> class Of>
class BatchOf {
  using Simulation = integrate::Simulation<Of, double>;
  using Recorder = integrate::Recorder<Of, double>;
  using Running = typename integrate::Lockstep<Of>::Simulations;
  using Plans = std::array<typename Simulation::Attempt, Lanes::count>;
  struct Lane {
    std::size_t point = 0;
    Configuration with;
    Of<double> system;
    Of<Lanes> alike;  ///< the same in every lane
    integrate::Trajectory out;
    std::optional<Recorder> recorder;
    std::optional<Simulation> simulation;  ///< none: the lane is free
    std::optional<typename Simulation::Attempt> planned;
  };

 public:
  BatchOf(const Description& of, const integrate::Experiment& of_all, const integrate::Settings& with, PointSink& into)
      : described(of), experiment(of_all), settings(with), sink(into), lockstep(of_all, with) {}

  void run(const Points& points, const std::vector<std::size_t>& which) {
    std::size_t next = 0;
    do {
      for (std::size_t l = 0; l < lane.size(); ++l)
        while (!lane[l].simulation && next < which.size()) start(l, points, which[next++]);
    } while (step() || next < which.size());
  }

 private:
  void start(std::size_t l, const Points& points, std::size_t point) {
    Lane& own = lane[l];
    own.point = point;
    own.with = configuration(described.info, points, point);
    own.out.channels = static_cast<int>(Of<double>::outputs.size());
    own.out.samples = static_cast<int>(experiment.time.size());
    own.out.attempts = own.out.rejected = own.out.events = 0;
    guarded(own, [&] {
      own.system = assemble<Of<double>, double>(described, own.with.values, own.with);
      own.simulation.emplace(own.system, own.system, experiment, settings, drive_of<double>(own.system, experiment));
      const auto* position = points.position + point * static_cast<std::size_t>(described.info.dof);
      const auto* velocity = points.velocity + point * static_cast<std::size_t>(described.info.dof);
      std::copy_n(position, described.info.dof, own.simulation->y.at.position.begin());
      std::copy_n(velocity, described.info.dof, own.simulation->y.at.velocity.begin());
      subtract_biases(own.system, experiment, own.simulation->y.at);
      own.recorder.emplace(own.system, experiment, own.out, sink.rows(point), 0, 0, integrate::PortRows{});
      own.alike = assemble_alike<Of>(described, own.with);
      own.recorder->write_together(own.alike);
      own.simulation->begin();
      take_numbers(l);
    });
  }
  /// The numbers of lane l, for the steps that are computed together.
  void take_numbers(std::size_t l) {
    const auto& values = lane[l].with.values;
    if (numbers.empty()) numbers.assign(values.begin(), values.end());
    for (std::size_t k = 0; k < values.size(); ++k) numbers[k].set(static_cast<int>(l), values[k]);
    effects = lane[l].with;
    assembled = false;
  }
  const Of<Lanes>& system_in_lanes() {
    if (!assembled) system = assemble<Of<Lanes>, Lanes>(described, numbers, effects);
    assembled = true;
    return system;
  }
  /// One attempt of some that run; false if none does.
  bool step() {
    Running running{};
    Plans plan;
    if (!plan_all(running, plan)) return false;
    lockstep.attempt(running, system_in_lanes(), plan, [&](std::size_t l, double wish, bool crosses, auto&& step) {
      Lane& own = lane[l];
      own.planned.reset();
      guarded(own, [&] {
        own.simulation->take_judged(plan[l], wish, crosses, step, own.out, *own.recorder);
        if (own.simulation->done()) finish(own, {});
      });
    });
    return true;
  }
  /// What each simulation tries next; false if none runs.
  bool plan_all(Running& running, Plans& plan) {
    bool any_runs = false;
    for (std::size_t l = 0; l < lane.size(); ++l) {
      Lane& own = lane[l];
      if (own.simulation && !own.planned) guarded(own, [&] { own.planned = own.simulation->plan(own.out); });
      if (!own.simulation) continue;
      running[l] = &*own.simulation, plan[l] = *own.planned, any_runs = true;
    }
    return any_runs;
  }
  template <class F>
  void guarded(Lane& own, F&& f) {
    try {
      f();
    } catch (const NumericalError& error) {
      finish(own, error.what());
    }
  }
  void finish(Lane& own, const std::string& message) {
    sink.done(own.point, message);
    own.simulation.reset();
    own.planned.reset();
  }

  const Description& described;
  const integrate::Experiment& experiment;
  const integrate::Settings& settings;
  PointSink& sink;
  integrate::Lockstep<Of> lockstep;
  std::array<Lane, Lanes::count> lane;
  Configuration effects;  ///< of every point
  std::vector<Lanes> numbers;
  Of<Lanes> system{};
  bool assembled = false;  ///< has `system` these numbers?
};
}  // namespace tendonlab::systems
