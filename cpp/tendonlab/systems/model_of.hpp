#pragma once
// The one place where a system template becomes a Model: its description and its simulations in every scalar.
#include <algorithm>
#include <optional>

#include "tendonlab/integrate/recorder.hpp"
#include "tendonlab/integrate/sampling.hpp"
#include "tendonlab/systems/assemble.hpp"
#include "tendonlab/systems/model.hpp"

namespace tendonlab {
namespace systems {
template <class System>
std::string axis_of(const std::string& element) {
  for (const auto& port : System::ports)
    if (port.element == element && port.axis != Axis::of_system) return port.axis == Axis::rotary ? "rotary" : "linear";
  return {};
}
/// The parameter with what an effort per load is under the load of its element.
template <class System>
ParameterInfo under_load(ParameterInfo p) {
  if (p.dimension != Dimension::effort_per_load) return p;
  for (const auto& port : System::ports)
    if (port.element == p.element && port.load == Dimension::ratio) {
      p.dimension = Dimension::effort, p.upper = inf;
      return p;
    }
  p.dimension = Dimension::ratio;
  return p;
}
/// The index of the parameter that `holder` calls `own`, if it has been listed.
inline std::optional<std::size_t> place_of(const std::vector<ParameterInfo>& parameters, const Holder& holder,
                                           std::string_view own) {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].own == own && holder.holds(parameters[i].element, parameters[i].effect)) return i;
  return {};
}
}  // namespace systems

/// What a system states of itself, and which public parameter each field is, in the order of the walk.
struct Description {
  SystemInfo info{};
  std::vector<std::size_t> parameter_of_field;
};

/// Describes a system: its own facts, then place by place those of its laws.
template <class System>
class Describe {
 public:
  static Description all() {
    Describe one;
    one.signals();
    for_each_parameter<System>([&](const auto& p) { one.add({}, p); });
    const auto names = systems::place_names<System>();
    auto name = names.begin();
    System system{};
    systems::for_each_place(system, [&](auto& laws, unsigned) {
      const std::string& element = *name++;
      one.info.elements.push_back({element, systems::axis_of<System>(element), systems::place_words<System>(element),
                                   systems::acts_on<System>(element)});
      std::apply([&](auto&... law) { (one.add_law(element, law), ...); }, laws);
    });
    return one.made;
  }

 private:
  void signals() {
    info.kind = System::name, info.equation = System::equation, info.dof = systems::stated<System>;
    info.commanded = System::commanded, info.sampled = System::sampled;
    if constexpr (System::sampled) info.steady = integrate::memories<System> == 0 && System::carried == 0;
    info.inputs.assign(System::inputs.begin(), System::inputs.end());
    info.outputs.assign(System::outputs.begin(), System::outputs.end());
    for (const auto& port : System::ports)
      info.ports.push_back({std::string(port.name), std::string(port.element), port.load});
    for (const auto& name : System::nominal) info.nominal.emplace_back(name);
  }
  /// A parameter of a law, or of the system itself; a law's partner may have stated it before.
  template <class Row>
  void add(const systems::Holder& of, const Row& p) {
    const auto known = systems::place_of(info.parameters, of, p.name);
    made.parameter_of_field.push_back(known.value_or(info.parameters.size()));
    if (known) return;
    info.parameters.push_back(systems::under_load<System>(
        {systems::parameter_name<System>(of.element, of.law, p.name), of.element, std::string(of.law),
         std::string(p.name), p.dimension, p.purpose, p.role, p.typical, p.lower, p.upper, std::string(p.meaning)}));
  }
  template <class Law>
  void add_law(const std::string& element, const Law&) {
    const systems::Holder holder{element, Law::name, systems::PartnerOf<Law>::name};
    const std::string name = element + ":" + std::string(Law::name);
    EffectInfo effect{name,
                      element,
                      std::string(Law::name),
                      std::string(Law::noun),
                      std::string(Law::noun) + " " + systems::place_words<System>(element),
                      std::string(Law::equation),
                      std::string(Law::source),
                      std::string(Law::summary),
                      {},
                      {},
                      Law::roles,
                      systems::is_structural<System>(name)};
    for_each_parameter<Law>([&](const auto& p) {
      add(holder, p);
      const auto& owner = info.parameters[made.parameter_of_field.back()];
      const std::string holding = owner.element + ":" + owner.effect;
      if (owner.effect == Law::name)
        effect.parameters.push_back(owner.name);
      else if (!systems::is_structural<System>(holding))  // structural effects are always there
        effect.needs.push_back(holding);
    });
    info.effects.push_back(std::move(effect));
  }

  Description made;
  SystemInfo& info = made.info;
};

/// The system with numbers in it; `count` seeds from `first` on are seeded into the derivatives of `T`.
template <class System, class T>
System assemble(const Description& described, const Configuration& with, const std::vector<integrate::Seed>& seeds,
                std::size_t first, std::size_t count) {
  System system{};
  auto next = described.parameter_of_field.begin();
  systems::for_each_field(system, [&](auto& field) {
    const std::size_t index = *next++;
    T value(with.values[index]);
    if constexpr (!std::is_same_v<T, double>)
      for (std::size_t k = 0; k < count; ++k)
        if (seeds[first + k].of == integrate::Seed::Of::parameter &&
            static_cast<std::size_t>(seeds[first + k].index) == index)
          value.seed(static_cast<int>(k), 1.0);
    field = value;
  });
  std::size_t effect = 0;
  systems::for_each_place(system, [&](auto& laws, unsigned& active) {
    for (unsigned law = 0; law < std::tuple_size_v<std::decay_t<decltype(laws)>>; ++law)
      if (with.active[effect++]) active |= 1u << law;
  });
  systems::share_slots(system, std::make_index_sequence<System::ports.size()>{});
  system.prepare();
  return system;
}

template <template <class> class Of>
class ModelOf final : public Model {
  using Seeds = std::vector<integrate::Seed>;

 public:
  const SystemInfo& info() const override { return description.info; }
  RigidMotion rigid_motion(const Configuration& with) const override {
    const auto system = assemble<Of<double>, double>(description, with, {}, 0, 0);
    if constexpr (Of<double>::sampled) {
      return {{}, 0.0, 1.0};
    } else {
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
    if (settings.ports) out.port.assign(Of<double>::ports.size() * 4 * experiment.time.size(), 0.0);
    if (seeds.empty()) run<double>(with, experiment, seeds, 0, 0, settings, out);
    constexpr int words = Of<double>::gradient_words;
    for (std::size_t first = 0; first < seeds.size();) {
      const std::size_t left = seeds.size() - first;
      const bool wide = words > 1 && left > 8;
      const std::size_t count = std::min<std::size_t>(left, wide ? 8 * words : 8);
      if (wide)
        run<Gradient<words>>(with, experiment, seeds, first, count, settings, out);
      else
        run<Gradient<1>>(with, experiment, seeds, first, count, settings, out);
      first += count;
    }
    return out;
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
      index(seed.of == integrate::Seed::Of::parameter ? "derivative by parameter" : "derivative by degree of freedom",
            static_cast<std::size_t>(seed.index),
            seed.of == integrate::Seed::Of::parameter ? description.info.parameters.size() : stated);
  }
  template <class T>
  void run(const Configuration& with, const integrate::Experiment& experiment, const Seeds& seeds, std::size_t first,
           std::size_t count, const integrate::Settings& settings, integrate::Trajectory& out) const {
    using System = Of<T>;
    const System system = assemble<System, T>(description, with, seeds, first, count);
    const auto column = static_cast<int>(first), columns = static_cast<int>(count);
    const bool shows = settings.ports && first == 0;
    if constexpr (System::sampled)
      integrate::Sampling<System, T>(system, experiment, out, column, columns, shows);
    else
      integrate_steps<T>(system, experiment, seeds, first, count, settings,
                         integrate::Recorder<System, T>(system, experiment, out, column, columns, shows), out);
  }
  template <class T, class Record>
  static void integrate_steps(const Of<T>& system, const integrate::Experiment& experiment, const Seeds& seeds,
                              std::size_t first, std::size_t count, const integrate::Settings& settings,
                              Record&& record, integrate::Trajectory& out) {
    using System = Of<T>;
    const auto& sensor = system.sensor[static_cast<std::size_t>(experiment.loop.output)];
    integrate::Simulation<System, T> simulation(
        system, experiment, settings,
        integrate::Drive<T>(experiment, system.actuation.delay(), sensor.delay(), sensor.bias()));
    for (std::size_t j = 0; j < static_cast<std::size_t>(systems::stated<System>); ++j) {
      simulation.y.at.position[j] = T(experiment.position[j]);
      simulation.y.at.velocity[j] = T(experiment.velocity[j]);
    }
    if constexpr (!std::is_same_v<T, double>)
      for (std::size_t k = 0; k < count; ++k) {
        const auto& seed = seeds[first + k];
        auto& of = seed.of == integrate::Seed::Of::position ? simulation.y.at.position : simulation.y.at.velocity;
        if (seed.of != integrate::Seed::Of::parameter)
          of[static_cast<std::size_t>(seed.index)].seed(static_cast<int>(k), 1.0);
      }
    simulation.run(out, record);
  }

  const Description description = Describe<Of<double>>::all();
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
