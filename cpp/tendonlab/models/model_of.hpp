#pragma once
// The one place where a system template becomes a Model: its description and its simulations.
#include "tendonlab/core/error.hpp"
#include "tendonlab/integrate/balance.hpp"
#include "tendonlab/models/batch_of.hpp"

namespace tendonlab {
template <template <class> class Of>
class ModelOf final : public Model {
  using Seeds = std::vector<integrate::Seed>;

 public:
  const SystemInfo& info() const override { return description.info; }
  RigidMotion rigid_motion(const Configuration& with) const override {
    if constexpr (Of<double>::sampled) {
      return {{}, 0.0, 1.0};
    } else {
      const auto system = systems::assemble<Of<double>, double>({description, with, {}, 0, 0});
      const auto shape = system.rigid_shape();
      RigidMotion rigid{{shape.begin(), shape.end()}, 0.0, 1.0};
      if constexpr (Of<double>::commanded) rigid.effort_per_command = system.effort_per_command();
      for (std::size_t j = 0; j < shape.size(); ++j) rigid.inertia += square(shape[j]) / system.inverse_inertia[j];
      rigid.inertia /= rigid.effort_per_command;
      return rigid;
    }
  }
  integrate::Trajectory simulate(const Configuration& with, const integrate::Experiment& experiment, const Seeds& seeds,
                                 const integrate::Settings& settings) const override {
    require_matching(experiment, seeds);
    integrate::Trajectory out;
    out.channels = static_cast<int>(Of<double>::outputs.size());
    out.samples = static_cast<int>(experiment.time.size());
    out.width = static_cast<int>(seeds.size());
    const auto cells = static_cast<std::size_t>(out.channels) * experiment.time.size();
    out.value.assign(cells, 0.0);
    out.gradient.assign(cells * seeds.size(), 0.0);
    if (settings.ports.any())
      out.port.assign(Of<double>::ports.size() * settings.ports.count() * experiment.time.size(), 0.0);
    if (seeds.empty()) systems::run<Of, double>({{description, with, seeds, 0, 0}, experiment, settings, out});
    for (std::size_t first = 0; first < seeds.size(); first += seeds_at_once()) {
      const std::size_t count = std::min(seeds.size() - first, seeds_at_once());
      const systems::Job job{{description, with, seeds, first, count}, experiment, settings, out};
      if constexpr (most_directions > Gradient::width)
        if (count > Gradient::width) {
          systems::run<Of, WideGradient>(job);
          continue;
        }
      systems::run<Of, Gradient>(job);
    }
    return out;
  }
  void simulate_points(const Points& points, const std::vector<std::size_t>& which,
                       const integrate::Experiment& experiment, const integrate::Settings& settings,
                       PointSink& sink) const override {
    require_matching(experiment, {});
    if constexpr (Of<double>::sampled) {
      for (const std::size_t point : which) {
        const Configuration with = configuration(info(), points, point);
        const auto rows = sink.rows(point);
        std::string message;
        try {
          auto run = simulate(with, experiment, {}, settings);
          const auto from = run.rows(~0u);
          for (std::size_t c = 0; c < rows.size(); ++c)
            if (rows[c]) std::copy_n(from[c], run.samples, rows[c]);
        } catch (const NumericalError& error) {
          message = error.what();
        }
        sink.done(point, message);
      }
    } else {
      systems::BatchOf<Of>(description, experiment, settings, sink).run(points, which);
    }
  }
  integrate::Balance balance(const Configuration& with, const integrate::Experiment& experiment,
                             const integrate::MeasuredMotion& motion) const override {
    require_matching(experiment, {});
    if constexpr (Of<double>::sampled) {
      throw ParameterError(sentence(Of<double>::name, ": expected a system with an equation of motion"));
    } else {
      const std::size_t cells = experiment.position.size() * experiment.time.size();
      if (motion.position.size() != cells || motion.velocity.size() != cells)
        throw ParameterError(sentence("motion: expected ", cells, " positions and as many velocities"));
      const auto system = systems::assemble<Of<double>, double>({description, with, {}, 0, 0});
      return integrate::Balancing<Of<double>>(system, experiment).along(motion);
    }
  }

 private:
  /// What was made for another system, or asks for what this one has not, must not reach the stepper.
  void require_matching(const integrate::Experiment& experiment, const Seeds& seeds) const {
    using System = Of<double>;
    constexpr auto stated = static_cast<std::size_t>(systems::stated<System>);
    const auto index = [](std::string_view of, std::size_t value, std::size_t count) {
      if (value >= count)
        throw ParameterError(sentence(of, " ", static_cast<long>(value), ": ", System::name, " has ", count));
    };
    if (experiment.inputs.size() != System::inputs.size() || experiment.position.size() != stated)
      throw ParameterError(sentence("experiment with ", experiment.inputs.size(), " inputs and ",
                                    experiment.position.size(), " positions: ", System::name, " expects ",
                                    System::inputs.size(), " and ", stated));
    if (!System::sampled) index("loop: axis", static_cast<std::size_t>(experiment.loop.axis), stated);
    index("loop: output", static_cast<std::size_t>(experiment.loop.output), System::outputs.size());
    for (const auto& seed : seeds)
      if (seed.of == integrate::Seed::Of::parameter)
        index("derivative by parameter", static_cast<std::size_t>(seed.index), description.info.parameters.size());
      else
        index("derivative by initial state", static_cast<std::size_t>(seed.index),
              numbers_of(seed.of, experiment).size());
  }

  const Description description = systems::describe<Of<double>>();
};

/// The model of a system. Each is compiled once, in a file of its own; the list of systems and joined systems call it.
template <template <class> class Of>
std::unique_ptr<Model> make_model();

/// A system that an effect turns into a system with more degrees of freedom: its `Grown`, of the same tables, takes its
/// place while the effect `grown_by` is on, so that simulations without the effect pay nothing for it.
template <template <class> class Of, template <class> class Grown>
class ModelOrGrown final : public Model {
 public:
  const SystemInfo& info() const override { return usual.info(); }
  RigidMotion rigid_motion(const Configuration& with) const override { return usual.rigid_motion(with); }
  integrate::Trajectory simulate(const Configuration& with, const integrate::Experiment& experiment,
                                 const std::vector<integrate::Seed>& seeds,
                                 const integrate::Settings& settings) const override {
    return with.active[switching] ? grown->simulate(with, experiment, seeds, settings)
                                  : usual.simulate(with, experiment, seeds, settings);
  }
  void simulate_points(const Points& points, const std::vector<std::size_t>& which,
                       const integrate::Experiment& experiment, const integrate::Settings& settings,
                       PointSink& sink) const override {
    if (which.empty()) return;
    const bool grows = points.active[which.front() * info().effects.size() + switching] != 0;
    return (grows ? static_cast<const Model&>(*grown) : usual)
        .simulate_points(points, which, experiment, settings, sink);
  }
  integrate::Balance balance(const Configuration& with, const integrate::Experiment& experiment,
                             const integrate::MeasuredMotion& motion) const override {
    return usual.balance(with, experiment, motion);
  }

 private:
  std::size_t find() const {
    const auto& effects = usual.info().effects;
    std::size_t i = 0;
    while (effects.at(i).name != Of<double>::grown_by) ++i;
    return i;
  }
  const ModelOf<Of> usual;
  const std::unique_ptr<Model> grown = make_model<Grown>();
  const std::size_t switching = find();
};

template <template <class> class Of, bool grows = !Of<double>::grown_by.empty()>
struct ModelForOf {
  using type = ModelOf<Of>;
};
template <template <class> class Of>
struct ModelForOf<Of, true> {
  using type = ModelOrGrown<Of, Of<double>::template Grown>;
};
template <template <class> class Of>
using ModelFor = typename ModelForOf<Of>::type;
}  // namespace tendonlab
