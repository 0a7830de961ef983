#pragma once
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// Motor and joint joined by an elastic cable over a gear ratio N:
///   J_m q_m'' = K_t u - friction_m - f/N,   J_l q_l'' = f - friction_l - g_tau sin q_l + known,
///   f = k (q_m/N - q_l) + c (q_m'/N - q_l').
template <class T>
struct TwoInertia : SystemDefaults {
  static constexpr std::string_view name = "two_inertia",
                                    equation =
                                        "J_m q_m'' = K_t u - friction_m - f/N; J_l q_l'' = f - friction_l - g_tau "
                                        "sin(q_l) + known_torque; f = k (q_m/N - q_l) + c (q_m'/N - q_l')";
  static constexpr int dof = 2, directions = 2, sides = 1;
  enum PortOf { motor, joint, contact, cable };
  enum ModeOf { motor_sense, joint_sense, flank };
  static constexpr std::array ports{port("motor").turns(motor_sense), port("joint").turns(joint_sense),
                                    port("contact").turns(joint_sense), port("cable").with_gap(flank)};
  static constexpr bool joined[4][2] = {{true, false}, {false, true}, {false, true}, {true, true}};
  static constexpr std::array inputs{
      input("motor_torque", Dimension::command, Between::hold, "command to the motor").required(),
      input("known_torque", Dimension::effort, Between::hold, "effort known to act on the joint")};
  static constexpr std::array outputs{
      output("motor_angle", Dimension::displacement, "angle of the motor").position_of(0),
      output("joint_angle", Dimension::displacement, "angle of the joint").position_of(1),
      output("cable_torque", Dimension::effort, "torque of the cable on the joint")};
  static constexpr std::array<std::string_view, 1> structural{"cable:compliance"};
  static constexpr std::array<std::string_view, 4> nominal{"motor:coulomb", "motor:viscous", "joint:coulomb",
                                                           "joint:viscous"};
  static constexpr bool commanded = true;

  using Friction = Slot<T, friction::All>;
  std::tuple<Friction, Friction, Slot<T, Seeing<sees_load, friction::All>>, Slot<T, transmission::All>> slot;
  Chain<T, loading::All> load;
  Chain<T, actuation::All> actuation;
  std::array<Chain<T, sensing::All>, 3> sensor;
  T motor_inertia, joint_inertia, gear_ratio, gravity_torque, torque_constant;
  std::array<T, dof> inverse_inertia;
  T lever[4][dof];

  static constexpr auto parameters() {
    return std::tuple{parameter(&TwoInertia::motor_inertia, "motor_inertia", Dimension::inertia, Purpose::structure,
                                1.0, 1e-12, inf, "inertia of the motor"),
                      parameter(&TwoInertia::joint_inertia, "joint_inertia", Dimension::inertia, Purpose::structure,
                                1.0, 1e-12, inf, "inertia of the joint with its load"),
                      parameter(&TwoInertia::gear_ratio, "gear_ratio", Dimension::ratio, Purpose::structure, 1.0, 1e-9,
                                inf, "turns of the motor per turn of the joint"),
                      parameter(&TwoInertia::gravity_torque, "gravity_torque", Dimension::effort, Purpose::structure,
                                0.0, -inf, inf, "gravity torque at 90 degrees", ParameterRole::payload),
                      command_gain(&TwoInertia::torque_constant)};
  }
  void prepare() {
    inverse_inertia = {1.0 / motor_inertia, 1.0 / joint_inertia};
    lever[motor][0] = lever[joint][1] = lever[contact][1] = T(1.0);
    lever[motor][1] = lever[joint][0] = lever[contact][0] = T(0.0);
    lever[cable][0] = 1.0 / gear_ratio;
    lever[cable][1] = T(-1.0);
  }
  std::array<T, dof> rigid_shape() const { return {T(1.0), lever[cable][0]}; }
  T effort_per_command() const { return torque_constant; }
  template <class S, class Modes, class Inputs>
  Coupling<S, 4, 2> couple(const Motion<S, 2>& at, const Modes& mode, const Inputs& in) const {
    const S torque = actuation.apply(S(torque_constant * in.command(at)));
    const S gravity = gravity_torque * sin(at.position[1]), known = load.apply(in.template input<1>(at.time));
    Sliding<S> pull;
    pull.position = lever[cable][0] * at.position[0] - at.position[1];
    pull.velocity = lever[cable][0] * at.velocity[0] - at.velocity[1];
    pull.side = mode[flank];
    const S tension = std::get<cable>(slot).respond(pull, S{}).force;  // a function of position and velocity only
    const S load_of_joint = 0.5 * (tension + gravity - known);
    return {{{{at.velocity[0], at.position[0], torque, mode[motor_sense], {}},
              {at.velocity[1], at.position[1], load_of_joint, mode[joint_sense], {}},
              {at.velocity[1], at.position[1], tension, mode[joint_sense], {}},
              pull}},
            {torque, known - gravity}};
  }
  template <class S, class Force, class PortAt>
  std::array<S, 3> observe(const Motion<S, 2>& at, const Force& force, const PortAt&) const {
    return {at.position[0], at.position[1], force(std::integral_constant<int, cable>{})};
  }
};
}  // namespace tendonlab::systems
