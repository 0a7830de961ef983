// One joint on which up to 64 bristles act: how a step grows with contacts, beyond what any system of the library has.
#include "tendonlab/friction/coulomb.hpp"
#include "tendonlab/friction/presliding.hpp"
#include "tendonlab/friction/stribeck.hpp"
#include "tendonlab/friction/viscous.hpp"
#include "tendonlab/integrate/simulation.hpp"
#include "tendonlab/systems/system.hpp"

namespace tendonlab {
namespace {
using Friction = Laws<friction::Coulomb, friction::Viscous, friction::Stribeck, friction::Presliding>;

template <class T, class Index>
struct Contacts;
template <class T, std::size_t... i>
struct Contacts<T, std::index_sequence<i...>> : systems::SystemDefaults {
  static constexpr int dof = 1, directions = 1, count = static_cast<int>(sizeof...(i));
  static constexpr std::array<systems::Port, sizeof...(i)> ports{
      (static_cast<void>(i), systems::port("contact").turns(0))...};
  static constexpr bool joined[count][1] = {{i + 1 > 0}...};
  template <std::size_t>
  using One = Slot<T, Friction>;
  std::tuple<One<i>...> slot;
  std::array<T, 1> inverse_inertia{T(1.0)};
  T lever[count][1];

  Contacts() {
    for (auto& row : lever) row[0] = T(1.0);
    const double share = 1.0 / count;
    std::get<0>(slot).laws = {friction::Coulomb<T>{share}, friction::Viscous<T>{0.4 * share},
                              friction::Stribeck<T>{0.5 * share, 1e-3},
                              friction::Presliding<T>{1e5 * share, 316.0 * share, 1.0}};
    std::get<0>(slot).active = (1u << std::tuple_size_v<decltype(std::get<0>(slot).laws)>)-1u;
    ((std::get<i>(slot) = std::get<0>(slot)), ...);
  }
  template <class S, class Modes, class Inputs>
  systems::Coupling<S, count, 1> couple(const systems::Motion<S, 1>& at, const Modes& mode, const Inputs& in) const {
    systems::Coupling<S, count, 1> c;
    for (auto& port : c.port) {
      port.velocity = at.velocity[0];
      port.direction = mode[0];
    }
    c.applied[0] = in.command(at);
    return c;
  }
};
template <int count>
struct Of {
  template <class T>
  using System = Contacts<T, std::make_index_sequence<static_cast<std::size_t>(count)>>;
};

/// A second under a sine force of amplitude 2: the number of steps that were tried.
template <int count>
long simulate(double tolerance) {
  constexpr int pieces = 1000;
  integrate::Experiment experiment;
  integrate::Signal force;
  for (int k = 0; k < pieces; ++k) {  // a parabola and more through each millisecond: Taylor's
    const double w = 6.283185307179586, t = 1e-3 * k, s = 2.0 * std::sin(w * t), c = 2.0 * std::cos(w * t);
    force.knots.push_back(t);
    force.coefficients.push_back({s, w * c, -0.5 * w * w * s, -w * w * w * c / 6.0});
  }
  force.prepare();
  experiment.time = {0.0, 1.0};
  experiment.inputs = {force};
  integrate::Settings settings;
  settings.tolerance = tolerance;
  const typename Of<count>::template System<double> system;
  integrate::Trajectory trajectory;
  integrate::Simulation<Of<count>::template System, double> simulation(
      system, system, experiment, settings, integrate::Drive<double>(experiment, 0.0, 0.0, 0.0));
  simulation.y.at.position = {0.0}, simulation.y.at.velocity = {0.0};
  simulation.run(trajectory, [](const auto&...) {});
  return trajectory.attempts;
}
}  // namespace
}  // namespace tendonlab

extern "C" long simulate(int contacts, double tolerance) {
  using namespace tendonlab;
  switch (contacts) {
    case 1:
      return tendonlab::simulate<1>(tolerance);
    case 4:
      return tendonlab::simulate<4>(tolerance);
    case 16:
      return tendonlab::simulate<16>(tolerance);
    case 32:
      return tendonlab::simulate<32>(tolerance);
    case 64:
      return tendonlab::simulate<64>(tolerance);
    default:
      return -1;
  }
}
