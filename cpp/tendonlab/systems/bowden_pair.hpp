#pragma once
#include "tendonlab/systems/sampled.hpp"
#include "tendonlab/transmission/velocity_gate.hpp"

namespace tendonlab::systems {
/// Two pretensioned tendons in sheaths join a drive to a load, sample by sample (S3 eq. 18-21):
///   target = K_in tau_in - friction(v),   tau_out[k] = h target + (1 - h) tau_out[k-1],
///   h = tanh(s_v (v² - v_t²))/2 + 1/2   for a step of the 1 kHz control loop.
/// K_in = r_out/r_in unless the sheath is bent unevenly. Velocities and torques of the sheath are those of the drive
/// and of the output; the velocity less what only stretches the cables, where they have `cable:compliance`. The output
/// before the first sample is K_in tau_in, the middle of the loop: 0 from rest. A bristle (`sheath:presliding`) takes
/// the place of the gate by its share. Axial stiffness and length cancel out of the torque of cables that do not
/// stretch.
///
/// Of a shape's curvature the torque sees two numbers up to order (mu theta)³: the wrap angle and the mean angle turned
/// along the sheath, which `curvature_skew` states as the linear curvature that has it.
template <class T>
struct BowdenPair : SystemDefaults {
  static constexpr std::string_view name = "bowden_pair",
                                    equation =
                                        "tau_out[k] = h (K_in tau_in - friction(v)) + (1 - h) tau_out[k-1], h = "
                                        "tanh(s_v (v^2 - v_t^2))/2 + 1/2";
  static constexpr int dof = 0;
  static constexpr bool sampled = true, plain_names = true;
  static constexpr std::size_t carried = 4;    ///< output of the gate, torque that is held and its input, travel
  static constexpr double gate_period = 1e-3;  ///< s, of the control loop whose steps the gate speaks of
  static constexpr std::array ports{port("sheath"), port("cable")};
  static constexpr std::array inputs{
      input("input_torque", Dimension::effort, Between::linear, "torque of the drive").required(),
      input("input_velocity", Dimension::flow, Between::linear, "velocity of the drive").required()};
  static constexpr std::array outputs{output("output_torque", Dimension::effort, "torque on the load")};
  static constexpr std::array places{Place{"actuation", "of the drive"}};
  static constexpr std::array<std::string_view, 1> nominal{"sheath:capstan"};

  using Laws = typename Joined<transmission::Sheath, friction::All>::type;
  std::tuple<Slot<T, Laws>, Slot<T, transmission::Tendons>> slot;
  Chain<T, tendonlab::Laws<>> load;
  Chain<T, tendonlab::Laws<tendonlab::actuation::GainError, tendonlab::actuation::Offset,
                           tendonlab::actuation::DriveInertia>>
      actuation;
  std::array<Chain<T, sensing::All>, 1> sensor;
  T threshold_velocity, threshold_slope, input_radius, output_radius, sheath_length, cable_stiffness, pretension,
      wrap_angle, curvature_skew;

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
                  "length of a sheath; the torque sees it by the stretch of the cables alone"),
        parameter(&BowdenPair::cable_stiffness, "cable_stiffness", Dimension::force, Purpose::structure, 1e5, 1e-9, inf,
                  "axial stiffness EA of a cable; the torque sees it by their stretch alone"),
        parameter(&BowdenPair::pretension, "pretension", Dimension::force, Purpose::condition, 100.0, 0.0, inf,
                  "pretension of each cable"),
        parameter(&BowdenPair::wrap_angle, "wrap_angle", Dimension::angle, Purpose::condition, 1.0, 0.0, inf,
                  "angle that a sheath turns by on its whole length"),
        parameter(&BowdenPair::curvature_skew, "curvature_skew", Dimension::ratio, Purpose::condition, 0.0, -3.0, 3.0,
                  "how much more a sheath is bent towards the output, 0 for a shape that is the same from both ends")};
  }

  template <class Inputs, class Memory>
  Sample<T, 1, 2> evaluate(const Inputs& in, Memory& memory) const {
    const T torque = driving(in);
    const Sliding<T> stretch = stretching(in), lost = moved<1>(stretch);
    const T velocity = lost_motion() ? T(in.template input<1>() - lost.velocity) : in.template input<1>();
    T& travel = memory.own[2];
    travel = travel + in.dt * velocity;
    Sliding<T> at = sliding(velocity, travel, T((output_radius / input_radius) * torque), wrap_angle);
    at.preload = 2.0 * output_radius * pretension, at.skew = curvature_skew;
    const Sliding<T> seen = moved<0>(at);
    const T friction = answer(std::get<0>(slot), at, memory.slot[0], in.dt), middle = gain(seen) * at.load;
    if (!memory.begun) memory.own[0] = memory.own[1] = memory.own[3] = middle;
    const T behind_gate =
        gated(T(middle - friction), velocity, memory.begun ? in.dt / gate_period : 1.0, memory.own[0]);
    return {{spread(behind_gate, T(middle - smooth(seen)), seen, memory)}, {at, stretch}, {friction, torque}};
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
  /// What the laws of slot i see behind those that change it.
  template <std::size_t i>
  Sliding<T> moved(Sliding<T> at) const {
    std::get<i>(slot).template each<role::motion>([&](const auto& law) { at = law.motion(at); });
    return at;
  }
  bool lost_motion() const { return std::get<1>(slot).active != 0; }
  /// How far cables that stretch on their whole length would do so, as an angle of the drive.
  template <class Inputs>
  Sliding<T> stretching(const Inputs& in) const {
    const T per_torque = sheath_length / (2.0 * cable_stiffness * square(input_radius)),
            torque = in.template input<0>();
    return sliding(T(per_torque * in.template slope<0>()), T(per_torque * torque), torque);
  }
  /// Friction of the sheath that has no memory and no edge.
  T smooth(const Sliding<T>& seen) const {
    T sum{};
    std::get<0>(slot).template each<role::force>([&](const auto& law) { sum = sum + law.force(seen); });
    return sum;
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
  /// The output where presliding is spread along the cable, whose dry friction acts about `middle`.
  template <class Memory>
  T spread(T output, const T& middle, const Sliding<T>& seen, Memory& memory) const {
    each_of<transmission::DistributedPresliding<T>>([&](const auto& law) {
      T &held = memory.own[1], &before = memory.own[3];
      held = law.held(held, before, middle, std::get<0>(slot).dry_level(seen));
      before = middle;
      output = output + law.share * (held - output);
    });
    return output;
  }
};
}  // namespace tendonlab::systems
