#pragma once
#include "tendonlab/systems/sampled.hpp"

namespace tendonlab::systems {
/// Steady points of a loaded transmission: one friction torque per input speed, whatever came before.
///
///   T = T_f(speed; relative load, transmission ratio)                     (S0 eq. 10)
///
/// speed: of the input, rad/s; T: on the input's side, N·m, with the sign of the speed. The slot carries the relative
/// load (1: own weight only), so that `contact:load_dependence` is in N·m per unit of it. The default friction is the
/// load-and-ratio model; a simulator that knows no load has `contact:static_lugre` and `contact:viscous` instead.
template <class T>
struct FrictionMap : SystemDefaults {
  static constexpr std::string_view name = "friction_map", equation = "T = friction(speed, relative_load)";
  static constexpr int dof = 0;
  static constexpr bool sampled = true, plain_names = true;
  static constexpr std::array ports{port("contact").loaded_by(Dimension::ratio)};
  static constexpr std::array inputs{
      input("speed", Dimension::flow, Between::linear, "speed of the input shaft").required()};
  static constexpr std::array outputs{
      output("friction_torque", Dimension::effort, "friction on the side of the input")};
  static constexpr std::array places{Place{"contact", "at the contact"}};
  static constexpr std::array<std::string_view, 1> nominal{"contact:load_and_ratio"};

  static constexpr std::array<Renamed, 4> renamed{
      // apart from those of the ordinary terms in the same slot
      {{"contact:static_lugre", "coulomb", "contact_lugre_coulomb"},
       {"contact:static_lugre", "static_friction", "contact_lugre_static_friction"},
       {"contact:static_lugre", "stribeck_velocity", "contact_lugre_stribeck_velocity"},
       {"contact:static_lugre", "stribeck_exponent", "contact_lugre_stribeck_exponent"}}};

  using Terms = Without<role::memory, friction::All>;  // at a steady speed no bristle moves
  std::tuple<Slot<T, typename Joined<friction::Curves, Terms>::type>> slot;
  Chain<T, Laws<>> load, actuation;
  std::array<Chain<T, Laws<sensing::Bias>>, 1> sensor;
  T relative_load;

  static constexpr auto parameters() {
    return std::tuple{parameter(&FrictionMap::relative_load, "relative_load", Dimension::ratio, Purpose::condition, 1.0,
                                1e-6, inf, "load of the bearings over their load by own weight")};
  }
  template <class Inputs, class Memory>
  Sample<T, 1, 1> evaluate(const Inputs& in, Memory&) const {
    Sample<T, 1, 1> of;
    of.port[0] = sliding(in.template input<0>(), T(0.0), relative_load);
    of.output[0] = of.force[0] = std::get<0>(slot).respond(of.port[0], T(0.0)).force;
    return of;
  }
};
}  // namespace tendonlab::systems
