#pragma once
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// A joint that a servo turns under its own position control, with a winding that follows at once:
///
///   (J + J_a) q'' = tau - friction - g_tau sin q
///   tau = k_t (V - k_t q') / R,   V = clip(k_p (target - q - angle_offset), V_max)
///
/// While `torque_enable` is 0 the servo coasts: tau = 0.
template <class T>
struct ServoPendulum : SystemDefaults {
  static constexpr std::string_view name = "servo_pendulum",
                                    equation =
                                        "(J + J_a) q'' = k_t (V - k_t q') / R - friction - g_tau sin(q), V = clip(k_p "
                                        "(target - q - angle_offset), +-V_max)";
  static constexpr int dof = 1, directions = 1;
  static constexpr std::array ports{port("joint").turns(0)};
  static constexpr bool joined[1][1] = {{true}};
  static constexpr std::array inputs{
      input("target_angle", Dimension::displacement, Between::hold, "position that the servo is to take").required(),
      input("supply_voltage", Dimension::voltage, Between::linear, "largest voltage, in place of voltage_limit")
          .limit(),
      input("torque_enable", Dimension::ratio, Between::hold,
            "whether the servo drives (1) or coasts (0), 1 unless logged")};
  static constexpr std::array outputs{
      output("joint_angle", Dimension::displacement, "position of the joint").position_of(0),
      output("joint_velocity", Dimension::flow, "velocity of the joint")};
  static constexpr std::array<std::string_view, 2> nominal{"joint:coulomb", "joint:viscous"};
  static constexpr bool plain_names = true;

  std::tuple<Slot<T, friction::All>> slot;
  Chain<T, loading::All> load;
  Chain<T, actuation::All> actuation;
  std::array<Chain<T, sensing::All>, 2> sensor;
  T inertia, armature, gravity_torque, torque_constant, resistance, proportional_gain, voltage_limit, angle_offset;
  T motor_inertia_share;
  std::array<T, dof> inverse_inertia;
  T torque_per_voltage;
  T lever[1][dof];

  static constexpr auto parameters() {
    using P = ServoPendulum;
    const auto own = [](T P::*field, std::string_view of, Dimension dimension, double typical, double lower,
                        std::string_view meaning, ParameterRole role = ParameterRole::none) {
      return parameter(field, of, dimension, Purpose::structure, typical, lower, inf, meaning, role);
    };
    return std::tuple{
        own(&P::inertia, "inertia", Dimension::inertia, 1.0, 1e-12, "inertia of the load"),
        own(&P::armature, "armature", Dimension::inertia, 0.0, 0.0, "inertia of motor and gear, as felt at the joint"),
        own(&P::gravity_torque, "gravity_torque", Dimension::effort, 0.0, -inf, "gravity torque at 90 degrees",
            ParameterRole::payload),
        own(&P::torque_constant, "torque_constant", Dimension::torque_per_current, 1.0, 1e-12,
            "torque per current, and voltage per speed, at the joint"),
        own(&P::resistance, "resistance", Dimension::resistance, 1.0, 1e-12, "resistance of the winding"),
        own(&P::proportional_gain, "proportional_gain", Dimension::voltage_per_displacement, 1.0, 0.0,
            "voltage per position error"),
        own(&P::voltage_limit, "voltage_limit", Dimension::voltage, 1.0, 0.0,
            "largest voltage where supply_voltage is not logged"),
        own(&P::angle_offset, "angle_offset", Dimension::displacement, 0.0, -inf,
            "how much more the servo reads than the joint's angle"),
        systems::motor_inertia_share(&P::motor_inertia_share)};
  }
  void prepare() {
    inverse_inertia[0] = 1.0 / (inertia + armature);
    torque_per_voltage = torque_constant / resistance;
    lever[0][0] = T(1.0);
  }
  std::array<T, dof> rigid_shape() const { return {T(1.0)}; }
  template <class S, class Modes, class Inputs>
  Coupling<S, 1, 1> couple(const Motion<S, 1>& at, const Modes& mode, const Inputs& in) const {
    S motor = actuation.apply(torque(at, in));
    if (in.template given<2>()) motor = in.template input<2>(at.time) * motor;
    const S gravity = gravity_torque * sin(at.position[0]), known = load.apply(S{});
    return single_joint(at, mode[0], motor, gravity, known, motor_inertia_share);
  }
  template <class S, class Force, class PortAt>
  std::array<S, 2> observe(const Motion<S, 1>& at, const Force&, const PortAt&) const {
    return {at.position[0], at.velocity[0]};
  }

 private:
  template <class S, class Inputs>
  S torque(const Motion<S, 1>& at, const Inputs& in) const {
    const S most = in.template given<1>() ? in.template input<1>(at.time) : lift<S>(voltage_limit);
    const S asked = proportional_gain * (in.command(at) - at.position[0] - angle_offset);
    const S below = select(plain(asked) > plain(most), most, asked);
    const S voltage = select(plain(below) < -plain(most), -most, below);
    return torque_per_voltage * (voltage - torque_constant * at.velocity[0]);
  }
};
}  // namespace tendonlab::systems
