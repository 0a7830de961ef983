#pragma once
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// A joint (or slide) on a rigid transmission:  J q'' = K_t u - friction - g_tau sin q + known.
template <class T>
struct RigidJoint : SystemDefaults {
  static constexpr std::string_view name = "rigid_joint",
                                    equation = "J q'' = K_t u - friction - g_tau sin(q) + known_torque";
  static constexpr int dof = 1, directions = 1;
  static constexpr std::array ports{port("joint").turns(0)};
  static constexpr bool joined[1][1] = {{true}};
  static constexpr std::array inputs{
      input("motor_torque", Dimension::command, Between::hold, "command to the actuator").required(),
      input("known_torque", Dimension::effort, Between::hold, "effort known to act on the joint")};
  static constexpr std::array outputs{
      output("joint_angle", Dimension::displacement, "position of the joint").position_of(0),
      output("joint_velocity", Dimension::flow, "velocity of the joint")};
  static constexpr std::array<std::string_view, 2> nominal{"joint:coulomb", "joint:viscous"};
  static constexpr bool commanded = true, plain_names = true;

  std::tuple<Slot<T, friction::All>> slot;
  Chain<T, loading::All> load;
  Chain<T, actuation::All> actuation;
  std::array<Chain<T, sensing::All>, 2> sensor;
  T inertia, gravity_torque, torque_constant, motor_inertia_share;
  std::array<T, dof> inverse_inertia;
  T lever[1][dof];

  static constexpr auto parameters() {
    return std::tuple{parameter(&RigidJoint::inertia, "inertia", Dimension::inertia, Purpose::structure, 1.0, 1e-12,
                                inf, "inertia of everything that moves"),
                      parameter(&RigidJoint::gravity_torque, "gravity_torque", Dimension::effort, Purpose::structure,
                                0.0, -inf, inf, "gravity torque at 90 degrees", ParameterRole::payload),
                      command_gain(&RigidJoint::torque_constant),
                      systems::motor_inertia_share(&RigidJoint::motor_inertia_share)};
  }
  void prepare() {
    inverse_inertia[0] = 1.0 / inertia;
    lever[0][0] = T(1.0);
  }
  std::array<T, dof> rigid_shape() const { return {T(1.0)}; }
  T effort_per_command() const { return torque_constant; }
  template <class S, class Modes, class Inputs>
  Coupling<S, 1, 1> couple(const Motion<S, 1>& at, const Modes& mode, const Inputs& in) const {
    const S motor = actuation.apply(S(torque_constant * in.command(at)));
    const S gravity = gravity_torque * sin(at.position[0]), known = load.apply(in.template input<1>(at.time));
    return single_joint(at, mode[0], motor, gravity, known, motor_inertia_share);
  }
  template <class S, class Force, class PortAt>
  std::array<S, 2> observe(const Motion<S, 1>& at, const Force&, const PortAt&) const {
    return {at.position[0], at.velocity[0]};
  }
};
}  // namespace tendonlab::systems
