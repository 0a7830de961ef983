#pragma once
// One simulation of a system in one scalar: from numbers to a system, and through an experiment.
#include <algorithm>

#include "tendonlab/integrate/recorder.hpp"
#include "tendonlab/integrate/sampling.hpp"
#include "tendonlab/models/describe.hpp"

namespace tendonlab::systems {
using Seeds = std::vector<integrate::Seed>;

/// The numbers of a system, with derivatives by `count` seeds from `first` on.
struct Assembly {
  const Description& described;
  const Configuration& with;
  const Seeds& seeds;
  std::size_t first, count;

  /// Numbers with the derivatives of those that the seeds of a kind name.
  template <class T>
  std::vector<T> seeded(const std::vector<double>& plain, [[maybe_unused]] integrate::Seed::Of of) const {
    std::vector<T> all(plain.begin(), plain.end());
    if constexpr (!std::is_same_v<T, double>)
      for (std::size_t k = 0; k < count; ++k)
        if (const auto& seed = seeds[first + k]; seed.of == of)
          all[static_cast<std::size_t>(seed.index)].seed(static_cast<int>(k), 1.0);
    return all;
  }
};
/// What to simulate. The seeds fill as many columns of the trajectory's gradient.
struct Job : Assembly {
  const integrate::Experiment& experiment;
  const integrate::Settings& settings;
  integrate::Trajectory& out;

  /// Ports are recorded once, with the first seeds.
  integrate::PortRows ports() const { return first == 0 ? settings.ports : integrate::PortRows{}; }
};

/// Hands out the numbers of a system, field by field. A call for each, rather than a copy of this code for each.
template <class T>
class FieldValues {
 public:
  FieldValues(const Description& described, const std::vector<T>& given)
      : values(given), next(described.parameter_of_field.begin()) {}
  template <class Field>
  [[gnu::noinline]] void read(Field& field) {
    field = values[*next++];
  }

 private:
  const std::vector<T>& values;
  std::vector<std::size_t>::const_iterator next;
};

/// The system with these values of its parameters, and the effects of `with`.
template <class System, class T>
System assemble(const Description& described, const std::vector<T>& given, const Configuration& with) {
  System system{};
  FieldValues<T> values(described, given);
  for_each_field(system, [&](auto& field) { values.read(field); });
  std::size_t effect = 0;
  for_each_place(system, [&](auto& laws, unsigned& active) {
    constexpr std::size_t count = std::tuple_size_v<std::decay_t<decltype(laws)>>;
    active = active_bits(with, effect, count);
    effect += count;
  });
  share_slots(system, std::make_index_sequence<System::ports.size()>{});
  system.prepare();
  return system;
}
template <class System, class T>
System assemble(const Assembly& of) {
  return assemble<System, T>(of.described, of.seeded<T>(of.with.values, integrate::Seed::Of::parameter), of.with);
}
/// The system with the same numbers in every lane.
template <template <class> class Of>
Of<Lanes> assemble_alike(const Description& described, const Configuration& with) {
  return assemble<Of<Lanes>, Lanes>(described, {with.values.begin(), with.values.end()}, with);
}
template <class T, class System>
integrate::Drive<T> drive_of(const System& system, const integrate::Experiment& experiment) {
  const auto& sensor = system.sensor[static_cast<std::size_t>(experiment.loop.output)];
  return {experiment, system.actuation.delay(), sensor.delay(), sensor.bias()};
}

/// Frees the initial positions of the biases of the sensors that told them.
template <class System, class Motion>
void subtract_biases(const System& system, const integrate::Experiment& experiment, Motion& at) {
  for (const integrate::TakenReading& reading : experiment.taken) {
    auto& position = at.position[static_cast<std::size_t>(reading.axis)];
    position = position - reading.share * system.sensor[static_cast<std::size_t>(reading.output)].bias();
  }
}

template <template <class> class Of, class T>
void step_through(const Of<T>& system, const Of<double>& plain, const Job& job) {
  const auto& experiment = job.experiment;
  integrate::Simulation<Of, T> simulation(system, plain, experiment, job.settings, drive_of<T>(system, experiment));
  const auto position = job.seeded<T>(experiment.position, integrate::Seed::Of::position);
  const auto velocity = job.seeded<T>(experiment.velocity, integrate::Seed::Of::velocity);
  std::copy(position.begin(), position.end(), simulation.y.at.position.begin());
  std::copy(velocity.begin(), velocity.end(), simulation.y.at.velocity.begin());
  subtract_biases(system, experiment, simulation.y.at);
  integrate::Recorder<Of, T> recorder(system, experiment, job.out, job.out.rows(job.settings.outputs),
                                      static_cast<int>(job.first), static_cast<int>(job.count), job.ports());
  std::optional<Of<Lanes>> alike;
  if constexpr (std::is_same_v<T, double>) {
    alike = assemble_alike<Of>(job.described, job.with);
    recorder.write_together(*alike);
  }
  simulation.run(job.out, recorder);
}

template <template <class> class Of, class T>
void run(const Job& job) {
  using System = Of<T>;
  const System system = assemble<System, T>(job);
  if constexpr (System::sampled)
    integrate::Sampling<System, T>(
        system, job.experiment, job.seeded<T>(job.experiment.reading, integrate::Seed::Of::reading), job.out,
        static_cast<int>(job.first), static_cast<int>(job.count), job.ports(), job.settings.outputs);
  else if constexpr (std::is_same_v<T, double>)
    step_through<Of, T>(system, system, job);
  else
    step_through<Of, T>(system, assemble<Of<double>, double>(job), job);
}
}  // namespace tendonlab::systems
