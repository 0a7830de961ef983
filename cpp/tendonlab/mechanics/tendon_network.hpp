#pragma once
// The mechanism of S1 for any number of joints: torques of motors and joints, with losses on branches and
// reducers.
#include <vector>

#include "tendonlab/mechanics/tendon_routing.hpp"

namespace tendonlab::mechanics {
/// One transmission per joint. `Branch`: a slot of friction laws without memory; `Gear`: a law with a level.
template <class Branch, class Gear>
struct TendonNetwork {
  using Vector = std::vector<double>;
  using Rows = std::vector<Vector>;
  Rows radius;          ///< signed, m; [i][j]: of transmission i at joint j, of the own joint with the reducer's ratio
  Vector motor_radius;  ///< m
  std::vector<std::vector<Branch>> branch;
  std::vector<Gear> gear, motor_gear;
  AtRest at_rest;
  double sign_velocity = 0.0;  ///< m/s: above 0 the sense of a branch is tanh(v / sign_velocity), else its sign

  /// One state of the mechanism. `torque`: of the motors or of the joints, whichever was asked for.
  struct Statics {
    Vector torque;
    Propagation<Vector, Rows> inside;
    Rows velocity;  ///< of the branches, m/s
  };

  std::size_t size() const { return motor_radius.size(); }
  /// Motor torques that give `torque` to the joints while these move with `joint_velocity`.
  Statics to_motors(const Vector& torque, const Vector& joint_velocity) const {
    Statics of{Vector(size()), room(), branch_motion(radius, joint_velocity)};
    const auto before = [&](std::size_t i, std::size_t link, double behind) {
      return effort_before_loss(behind,
                                [&](const auto& tension) { return loss(i, link, of.velocity[i][link], tension); });
    };
    const auto input = [&](std::size_t j, double output) { return gear_input(gear[j], output, joint_velocity[j]); };
    of.inside = propagate_to_motors(radius, torque, before, input, std::move(of.inside));
    for (std::size_t i = 0; i < size(); ++i)
      of.torque[i] = gear_input(motor_gear[i], motor_radius[i] * of.inside.tension[i][0], motor_velocity(of, i));
    return of;
  }
  /// Joint torques from those of the motors: the inverse of `to_motors`.
  Statics to_joints(const Vector& motor_torque, const Vector& joint_velocity) const {
    Statics of{{}, room(), branch_motion(radius, joint_velocity)};
    for (std::size_t i = 0; i < size(); ++i)
      of.inside.tension[i][0] = gear_output(motor_gear[i], motor_torque[i], motor_velocity(of, i)) / motor_radius[i];
    const auto behind = [&](std::size_t i, std::size_t link, double before) {
      return before - loss(i, link, of.velocity[i][link], before);
    };
    const auto output = [&](std::size_t j, double input) { return gear_output(gear[j], input, joint_velocity[j]); };
    of.inside = propagate_to_joints(radius, behind, output, std::move(of.inside));
    of.torque = joint_torque(radius, of.inside);
    return of;
  }
  /// Motion of the joints from that of the motors.
  Vector joints_of(Vector motor) const {
    for (std::size_t i = 0; i < size(); ++i) motor[i] *= motor_radius[i];
    return joint_motion(radius, motor);
  }

 private:
  Propagation<Vector, Rows> room() const { return {Vector(size()), Rows(size(), Vector(size() + 1))}; }
  double motor_velocity(const Statics& of, std::size_t i) const { return of.velocity[i][0] / motor_radius[i]; }
  template <class S>
  S loss(std::size_t i, std::size_t link, double velocity, const S& before) const {
    Sliding<S> at;
    at.velocity = constant<S>(velocity);
    at.load = before;
    at.direction =
        sign_velocity > 0 ? std::tanh(velocity / sign_velocity) : static_cast<double>((velocity > 0) - (velocity < 0));
    return branch[i][link].respond(at, S{}).force;
  }
  template <class S>
  S gear_loss(const Gear& law, const S& output, double velocity) const {
    return reducer_loss([&](const Sliding<S>& at) -> S { return at.direction * law.level(at); }, output, velocity,
                        at_rest);
  }
  double gear_input(const Gear& law, double output, double velocity) const {
    return output + gear_loss(law, output, velocity);
  }
  double gear_output(const Gear& law, double input, double velocity) const {
    return effort_behind_loss(input, [&](const auto& output) { return gear_loss(law, output, velocity); });
  }
};
}  // namespace tendonlab::mechanics
