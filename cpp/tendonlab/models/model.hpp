#pragma once
// A system by name: everything above this line of the library sees parameters, effects, outputs, and no template.
#include <memory>
#include <string>
#include <vector>

#include "tendonlab/core/parameter.hpp"
#include "tendonlab/integrate/experiment.hpp"
#include "tendonlab/integrate/motion.hpp"
#include "tendonlab/models/points.hpp"
#include "tendonlab/systems/signals.hpp"

namespace tendonlab {
struct ParameterInfo {
  std::string name, element, effect, own;
  Dimension dimension;
  Purpose purpose;
  ParameterRole role;
  double typical, lower, upper;
  std::string meaning;
};
struct EffectInfo {
  std::string name, element, effect;
  std::string group;         ///< of its law (models/groups.hpp)
  std::string noun, phrase;  ///< "Stribeck friction", "Stribeck friction at the joint"
  std::string equation, source, summary;
  std::vector<std::string> parameters;
  std::vector<std::string> needs;  ///< effects whose parameters it shares
  unsigned roles, sees;
  bool structural;
};
/// A place where laws sit: its name, its axis (empty: the system's), in words ("at the joint"), and the element with
/// ports whose motion and effort it shares: itself where it has ports.
struct ElementInfo {
  std::string name, axis, place, acts_on;
};
struct PortInfo {
  std::string name, element;
  Dimension load;
};
struct SystemInfo {
  std::string kind, equation;
  int dof;
  std::vector<systems::Input> inputs;
  std::vector<systems::Output> outputs;
  std::vector<ParameterInfo> parameters;
  std::vector<EffectInfo> effects;
  std::vector<ElementInfo> elements;
  std::vector<PortInfo> ports;
  std::vector<std::string> nominal;
  bool commanded, sampled;
  bool steady;  ///< sampled, and no sample depends on another: its rows need no time
};

/// A system with numbers in it: one value per parameter, one flag per effect, in the order of `SystemInfo`.
struct Configuration {
  std::vector<double> values;
  std::vector<bool> active;
};

/// The configuration of a point.
Configuration configuration(const SystemInfo& of, const Points& points, std::size_t point);

/// The system as if nothing stretched: how far each degree of freedom moves with the first, the inertia that the
/// command then moves, per unit of command, and the effort on the first degree of freedom per unit of command.
struct RigidMotion {
  std::vector<double> shape;
  double inertia, effort_per_command;
};

class Model {
 public:
  virtual ~Model() = default;
  virtual const SystemInfo& info() const = 0;
  virtual RigidMotion rigid_motion(const Configuration& with) const = 0;
  /// Simulates `experiment`; the gradient has one column per seed. Throws NumericalError where the integration fails.
  virtual integrate::Trajectory simulate(const Configuration& with, const integrate::Experiment& experiment,
                                         const std::vector<integrate::Seed>& seeds,
                                         const integrate::Settings& settings) const = 0;
  /// Simulates `experiment` at the points `which`, whose flags are all the same.
  virtual void simulate_points(const Points& points, const std::vector<std::size_t>& which,
                               const integrate::Experiment& experiment, const integrate::Settings& settings,
                               PointSink& sink) const = 0;
  /// The equation of motion along a measured motion with the inputs of `experiment`, at its samples. Throws
  /// ParameterError for a system without one.
  virtual integrate::Balance balance(const Configuration& with, const integrate::Experiment& experiment,
                                     const integrate::MeasuredMotion& motion) const = 0;
};
/// How many directions one simulation carries along; more take further ones.
std::size_t seeds_at_once();
/// All systems of the library, in the order in which they are listed.
const std::vector<std::unique_ptr<Model>>& models();
/// The system of that kind; throws ParameterError, naming those there are.
const Model& model(const std::string& kind);
}  // namespace tendonlab
