#pragma once
#include "tendonlab/systems/sampled.hpp"

namespace tendonlab::systems {
/// Two pretensioned tendons in sheaths join a drive to a load, sample by sample (S3 eq. 18-21):
///   target = K_in tau_in - friction(v),   tau_out[k] = h target + (1 - h) tau_out[k-1]
/// h: transmission::VelocityGate. K_in = r_out/r_in unless the sheath is bent unevenly. The sheath slides with the
/// velocity of the drive, less the part that only stretches the cables (`cable:compliance`), and carries the torque of
/// the output. The velocity is that of a smooth curve within the noise of its samples, under which the gate would
/// chatter, and where the curve misses a sample by more, as at a sudden stop, that sample. The output before the first
/// sample is the first one measured (S3 sec. 2.1); where none was, K_in tau_in, the middle of the loop: 0 from rest. A
/// bristle (`sheath:presliding`) replaces the gate by its share. Axial stiffness and length cancel out of the torque of
/// cables that do not stretch.
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
  static constexpr std::array ports{port("sheath"), port("cable")};
  static constexpr std::array inputs{
      input("input_torque", Dimension::effort, Between::sloped, "torque of the drive").required(),
      input("input_velocity", Dimension::flow, Between::smooth, "velocity of the drive").required()};
  static constexpr std::array outputs{output("output_torque", Dimension::effort, "torque on the load").held()};
  static constexpr std::array places{Place{"actuation", "of the drive"}};
  static constexpr std::string_view passing = "sheath";
  static constexpr std::array<std::string_view, 1> structural{"sheath:velocity_gate"}, nominal{"sheath:capstan"};
  static constexpr std::array<Renamed, 3> renamed{{{"sheath:velocity_gate", "threshold_velocity", "threshold_velocity"},
                                                   {"sheath:velocity_gate", "threshold_slope", "threshold_slope"},
                                                   {"sheath:velocity_gate", "gate_share", "gate_share"}}};

  using Laws = typename Joined<transmission::Sheath, friction::All>::type;
  std::tuple<Slot<T, Laws>, Slot<T, transmission::Tendons>> slot;
  Chain<T, tendonlab::Laws<>> load;
  Chain<T, tendonlab::Laws<tendonlab::actuation::GainError, tendonlab::actuation::Offset,
                           tendonlab::actuation::DriveInertia>>
      actuation;
  std::array<Chain<T, sensing::All>, 1> sensor;
  Chain<T, transmission::SheathEffort> passed;
  struct Carried {
    T travel{}, velocity{};
    typename decltype(passed)::States states{};
  };
  T input_radius, output_radius, sheath_length, cable_stiffness, pretension, wrap_angle, curvature_skew;

  static constexpr auto parameters() {
    return std::tuple{
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
    const auto& sheath = std::get<0>(slot);
    const DriveEffort effort{{in.template input<0>(), in.dt}, in.template slope<0>(), in.template slope<1>()};
    const PairSliding drive = at_drive(in.template input<1>(), effort);
    const T torque = actuation.pass(effort), velocity = std::get<1>(slot).moved(drive).velocity;
    const T on_the_way = 0.5 * (velocity + memory.own.velocity);  // since the sample before
    memory.own = {memory.own.travel + in.dt * on_the_way, velocity, memory.own.states};
    const SheathSliding at = at_sheath(velocity, memory.own.travel, torque);
    memory.slot[0] = advanced(sheath, at_sheath(on_the_way, at.position, torque), memory.slot[0], in.dt);
    const T friction = sheath.respond(at, memory.slot[0]).force;
    return {{passed.pass(transmitted(at, friction, in), memory.own.states)}, {at, stretch(drive)}, {friction, torque}};
  }

 private:
  using DriveEffort = tendonlab::actuation::DriveEffort<T>;
  using PairSliding = transmission::PairSliding<T>;
  using SheathSliding = transmission::SheathSliding<T>;
  using TransmittedEffort = transmission::TransmittedEffort<T>;

  PairSliding at_drive(const T& velocity, const DriveEffort& effort) const {
    PairSliding at;
    static_cast<Sliding<T>&>(at) = sliding(velocity, T(0.0), effort.signal);
    at.load_rate = effort.slope;
    at.compliance = transmission::pair_compliance(sheath_length, cable_stiffness, input_radius);
    return at;
  }
  /// Stretch of cables that stretch on their whole length, as an angle of the drive.
  static Sliding<T> stretch(const PairSliding& drive) {
    return sliding(T(drive.compliance * drive.load_rate), T(drive.compliance * drive.load), drive.load);
  }
  SheathSliding at_sheath(const T& velocity, const T& position, const T& torque) const {
    SheathSliding at;
    static_cast<Sliding<T>&>(at) = sliding(velocity, position, T((output_radius / input_radius) * torque), wrap_angle);
    at.preload = 2.0 * output_radius * pretension;
    at.curvature.skew = curvature_skew;
    return at;
  }
  /// The torque on the load, of `friction` at this sliding, before the laws that hold it.
  template <class Inputs>
  TransmittedEffort transmitted(const SheathSliding& at, const T& friction, const Inputs& in) const {
    const auto& sheath = std::get<0>(slot);
    const SheathSliding seen = sheath.moved(at);
    T frictionless = at.load;
    sheath.template each<role::gain>([&](const auto& law) { frictionless = law.gain(seen) * frictionless; });
    T smooth{};  // friction without memory and edge
    sheath.template each<role::force>([&](const auto& law) { smooth = smooth + law.force(seen); });
    TransmittedEffort of;
    of.signal = frictionless - friction, of.dt = in.dt, of.smooth = frictionless - smooth;
    of.start = in.template before<0>().value_or(frictionless);
    of.dry_level = sheath.dry_level(seen), of.bristle_share = 1.0 - sheath.left_to_slide(T(1.0));
    of.velocity = at.velocity;
    return of;
  }
};
}  // namespace tendonlab::systems
