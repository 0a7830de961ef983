#pragma once
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// Motor and joint joined by an elastic cable over a gear ratio N:
///   J_m q_m'' = u - friction_m - f/N,   J_l q_l'' = f - friction_l - g_tau sin q_l + known,
///   f = k (q_m/N - q_l) + c (q_m'/N - q_l').
template <class T>
struct TwoInertia {
  static constexpr std::string_view name = "two_inertia",
                                    equation =
                                        "J_m q_m'' = u - friction_m - f/N; J_l q_l'' = f - friction_l - g_tau "
                                        "sin(q_l) + known_torque; f = k (q_m/N - q_l) + c (q_m'/N - q_l')";
  static constexpr int dof = 2, directions = 2, sides = 1;
  enum PortOf { motor, joint, contact, cable };
  static constexpr std::array<Port, 4> ports{{{"motor", 0}, {"joint", 1}, {"contact", 1}, {"cable", -1, 2}}};
  static constexpr bool joined[4][2] = {{true, false}, {false, true}, {false, true}, {true, true}};
  static constexpr std::array<Input, 2> inputs{
      {{"motor_torque", "torque of the motor", Dimension::command, true, Between::hold},
       {"known_torque", "effort known to act on the joint", Dimension::effort, false, Between::hold}}};
  static constexpr std::array<Output, 3> outputs{
      {{"motor_angle", "angle of the motor", Dimension::displacement, 0},
       {"joint_angle", "angle of the joint", Dimension::displacement, 1},
       {"cable_torque", "torque of the cable on the joint", Dimension::effort, -1}}};
  static constexpr std::array<std::string_view, 1> structural{"cable:compliance"};
  static constexpr std::array<std::string_view, 4> nominal{"motor:coulomb", "motor:viscous", "joint:coulomb",
                                                           "joint:viscous"};
  static constexpr int gradient_words = 2;
  static constexpr bool commanded = true;  ///< input 0 is the command of an actuator
  static constexpr bool plain_names = false;

  using Friction = Slot<T, friction::All>;
  std::tuple<Friction, Friction, Slot<T, Seeing<sees_load, friction::All>>, Slot<T, transmission::All>> slot;
  Chain<T, loading::All> load;
  Chain<T, actuation::All> actuation;
  std::array<Chain<T, sensing::All>, 3> sensor;
  T motor_inertia, joint_inertia, gear_ratio, gravity_torque;
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
                                0.0, -inf, inf, "gravity torque at 90 degrees")};
  }
  void prepare() {
    inverse_inertia = {1.0 / motor_inertia, 1.0 / joint_inertia};
    lever[motor][0] = lever[joint][1] = lever[contact][1] = T(1.0);
    lever[motor][1] = lever[joint][0] = lever[contact][0] = T(0.0);
    lever[cable][0] = 1.0 / gear_ratio;
    lever[cable][1] = T(-1.0);
  }
  std::array<T, dof> rigid_shape() const { return {T(1.0), lever[cable][0]}; }
  T effort_per_command() const { return T(1.0); }
  template <class S, class Modes, class Inputs>
  Coupling<S, 4, 2> couple(const Motion<S, 2>& at, const Modes& mode, const Inputs& in) const {
    Coupling<S, 4, 2> c;
    const S torque = actuation.apply(S(in.command(at)));
    const S gravity = gravity_torque * sin(at.position[1]), known = load.apply(in.template input<1>(at.time));
    auto& pull = c.port[cable];
    pull.position = lever[cable][0] * at.position[0] - at.position[1];
    pull.velocity = lever[cable][0] * at.velocity[0] - at.velocity[1];
    pull.side = mode[2];
    const S tension = std::get<cable>(slot).respond(pull, S{}).force;  // a function of position and velocity only
    c.port[motor] = {at.velocity[0], at.position[0], torque, mode[0], {}};
    c.port[joint] = {at.velocity[1], at.position[1], 0.5 * (tension + gravity - known), mode[1], {}};
    c.port[contact] = {at.velocity[1], at.position[1], tension, mode[1], {}};
    c.applied = {torque, known - gravity};
    return c;
  }
  template <class S, class Force>
  std::array<S, 3> observe(const Motion<S, 2>& at, const Force& force) const {
    return {at.position[0], at.position[1], force(std::integral_constant<int, cable>{})};
  }
};
}  // namespace tendonlab::systems
