#pragma once
#include "tendonlab/systems/sampled.hpp"
#include "tendonlab/transmission/velocity_gate.hpp"

namespace tendonlab::systems {
/// Two pretensioned tendons in sheaths join a drive to a load, sample by sample (S3 eq. 18-21):
///   target = K_in tau_in - friction(v),   tau_out[k] = h target + (1 - h) tau_out[k-1],
///   h = tanh(s_v (v² - v_t²))/2 + 1/2   for a step of the 1 kHz control loop.
/// K_in = r_out/r_in unless the sheath is bent unevenly. Velocities and torques of the sheath are those of the drive
/// and of the output. The output before the first sample is K_in tau_in, the middle of the loop: 0 from rest. A bristle
/// (`sheath:presliding`) takes the place of the gate by its share. Axial stiffness and length cancel out of the torque.
template <class T>
struct BowdenPair {
  static constexpr std::string_view name = "bowden_pair",
                                    equation =
                                        "tau_out[k] = h (K_in tau_in - friction(v)) + (1 - h) tau_out[k-1], h = "
                                        "tanh(s_v (v^2 - v_t^2))/2 + 1/2";
  static constexpr int dof = 0;
  static constexpr bool sampled = true, commanded = false, plain_names = true;
  static constexpr std::size_t carried = 3;    ///< output of the gate, torque that is held, travel of the drive
  static constexpr double gate_period = 1e-3;  ///< s, of the control loop whose steps the gate speaks of
  static constexpr std::array<Port, 1> ports{{{"sheath"}}};
  static constexpr std::array<Input, 2> inputs{
      {{"input_torque", "torque of the drive", Dimension::effort, true, Between::linear},
       {"input_velocity", "velocity of the drive", Dimension::flow, true, Between::linear}}};
  static constexpr std::array<Output, 1> outputs{{{"output_torque", "torque on the load", Dimension::effort, -1}}};
  static constexpr std::array<std::string_view, 0> structural{};
  static constexpr std::array<std::string_view, 1> nominal{"sheath:capstan"};

  using Laws = typename Joined<transmission::Sheath, friction::All>::type;
  std::tuple<Slot<T, Laws>> slot;
  Chain<T, tendonlab::Laws<>> load;
  Chain<T, tendonlab::Laws<tendonlab::actuation::GainError, tendonlab::actuation::Offset,
                           tendonlab::actuation::DriveInertia>>
      actuation;
  std::array<Chain<T, sensing::All>, 1> sensor;
  T threshold_velocity, threshold_slope, input_radius, output_radius, sheath_length, cable_stiffness, pretension,
      wrap_angle;

  static constexpr auto parameters() {
    return std::tuple{
        parameter(&BowdenPair::threshold_velocity, "threshold_velocity", Dimension::flow, Purpose::structure, 0.1, 0.0,
                  inf, "speed of the drive at which half of a step gets through the gate"),
        parameter(&BowdenPair::threshold_slope, "threshold_slope", Dimension::per_flow_squared, Purpose::structure, 1e3,
                  1e-9, inf, "steepness of the gate over the square of the speed"),
        parameter(&BowdenPair::input_radius, "input_radius", Dimension::length, Purpose::structure, 0.05, 1e-9, inf,
                  "radius of the drive's pulley"),
        parameter(&BowdenPair::output_radius, "output_radius", Dimension::length, Purpose::structure, 0.05, 1e-9, inf,
                  "radius of the load's pulley"),
        parameter(&BowdenPair::sheath_length, "sheath_length", Dimension::length, Purpose::structure, 1.0, 1e-9, inf,
                  "length of a sheath; cancels out of the torque"),
        parameter(&BowdenPair::cable_stiffness, "cable_stiffness", Dimension::force, Purpose::structure, 1e5, 1e-9, inf,
                  "axial stiffness EA of a cable; cancels out of the torque"),
        parameter(&BowdenPair::pretension, "pretension", Dimension::force, Purpose::condition, 100.0, 0.0, inf,
                  "pretension of each cable"),
        parameter(&BowdenPair::wrap_angle, "wrap_angle", Dimension::angle, Purpose::condition, 1.0, 0.0, inf,
                  "angle that a sheath turns by on its whole length")};
  }
  void prepare() {}

  template <class Inputs, class Memory>
  Sample<T, 1, 1> evaluate(const Inputs& in, Memory& memory) const {
    const auto& sheath = std::get<0>(slot);
    const T torque = driving(in), velocity = in.template input<1>();
    T& travel = memory.own[2];
    travel = travel + in.dt * velocity;
    Sliding<T> at = sliding(velocity, travel, T((output_radius / input_radius) * torque), wrap_angle);
    at.preload = 2.0 * output_radius * pretension;
    const Sliding<T> seen = moved(at);
    const T friction = answer(sheath, at, memory.slot[0], in.dt), middle = gain(seen) * at.load;
    if (!memory.begun) memory.own = {middle, middle, travel};
    T output = gated(T(middle - friction), velocity, memory.begun ? in.dt / gate_period : 1.0, memory.own[0]);
    each_of<transmission::DistributedPresliding<T>>([&](const auto& law) {
      memory.own[1] = law.held(memory.own[1], middle, sheath.dry_level(seen));
      T smooth{};
      sheath.template each<role::force>([&](const auto& other) { smooth = smooth + other.force(seen); });
      output = output + law.share * (memory.own[1] - smooth - output);
    });
    return {{output}, {at}, {friction}};
  }

 private:
  /// The torque that reaches the sheath's pulley.
  template <class Inputs>
  T driving(const Inputs& in) const {
    T torque = actuation.apply(in.template input<0>());
    actuation.each([&](const auto& law) {
      if constexpr (std::is_same_v<std::decay_t<decltype(law)>, tendonlab::actuation::DriveInertia<T>>)
        torque = torque - law.reaction(in.template slope<1>());
    });
    return torque;
  }
  /// Calls f(law) for the laws of the sheath of type `Law` that are on.
  template <class Law, class F>
  void each_of(F&& f) const {
    std::get<0>(slot).template each<Law::roles>([&](const auto& law) {
      if constexpr (std::is_same_v<std::decay_t<decltype(law)>, Law>) f(law);
    });
  }
  /// What the laws see behind those that change it.
  Sliding<T> moved(Sliding<T> at) const {
    std::get<0>(slot).template each<role::motion>([&](const auto& law) { at = law.motion(at); });
    return at;
  }
  /// K_in over the ratio of radii: 1 but for a sheath that is bent unevenly.
  T gain(const Sliding<T>& seen) const {
    T gain(1.0);
    if (plain(seen.skew) == 0.0 && !varies(seen.skew)) return gain;
    each_of<transmission::SheathCapstan<T>>([&](const auto& law) { gain = law.pair(seen).torque_gain(); });
    return gain;
  }
  /// The output behind the gate, remembered in `before`; a bristle takes the place of the gate by its share.
  T gated(const T& target, const T& velocity, double periods, T& before) const {
    T kept = transmission::VelocityGate<T>{threshold_velocity, threshold_slope}.kept(velocity, periods);
    std::get<0>(slot).template each<role::memory>([&](const auto& law) { kept = law.dry_share() * kept; });
    return before = transmission::follow(target, before, kept);
  }
};
}  // namespace tendonlab::systems
