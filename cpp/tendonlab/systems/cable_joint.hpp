#pragma once
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// A joint of two equal geared rotations theta, pulled by two antagonist cables that a motor winds over gear and screw:
///   I(theta) theta'' = r cos(theta) (F_1 - F_2) + tau_g + 2 m_2 l_1 d_21 sin(theta) theta'^2 - friction     (S2 eq. 5)
///   J_m omega'' = k i - friction - N (F_act_1 - F_act_2),   u' = N omega                                    (S2 eq. 1)
///   F_i = max(0, T + K x_i + c x_i'),  x_1 = u - r sin(theta) + x_0 = -x_2                             (S2 eqs 2, 3)
/// Where the path of both cables grows with theta, F_i counts that too, and so does the torque on the joint.
/// Friction of the bushings acts between guide and nut: it shows in F_act_i = F_i + F_a_i and brakes the motor, not the
/// joint, in the sense of the nuts, so that it never feeds their motion (S2 fig. 2). u counts from where the joint
/// rests at theta = 0, which is x_0. A nut velocity that is prescribed takes the place of the motor, which then idles,
/// and bushings follow the sense of the joint, as the paper's simulation has it, or hold by stiction.
template <class T>
struct CableJoint : SystemDefaults {
  static constexpr std::string_view name = "cable_joint",
                                    equation =
                                        "I(theta) theta'' = r cos(theta) (F_1 - F_2) + tau_g(theta) + 2 m_2 l_1 d_21 "
                                        "sin(theta) theta'^2; J_m omega' = k i - friction - N (F_act_1 - F_act_2); "
                                        "F_i = max(0, T + K x_i + c x_i'); F_act_i = F_i + F_a_i; x_1 = u - r "
                                        "sin(theta) + x_0 = -x_2, u: travel of nut 1, x_0: stretch that holds the "
                                        "joint at theta = 0";
  static constexpr int dof = 2, stated = 1, directions = 4, driver = 1;
  static constexpr bool commanded = true, moving = true;
  enum PortOf {
    joint,
    motor,
    winding,
    gear,
    cable_1,
    cable_2,
    bushing_1,
    bushing_2,
    stiction_1,
    stiction_2,
    num_ports
  };
  enum ModeOf { joint_sense, motor_sense, guide_sense, nut_sense };
  static constexpr std::array ports{
      port("joint").turns(joint_sense),
      port("motor").turns(motor_sense),
      port("winding").loaded_by(Dimension::voltage),
      port("gear"),
      port("cable").named("cable_1").along(Axis::linear),
      port("cable").named("cable_2").along(Axis::linear),
      port("bushing_1").along(Axis::linear).turns(motor_sense).while_driven(guide_sense),
      port("bushing_2").along(Axis::linear).turns(motor_sense).while_driven(guide_sense).mirrored(),
      port("stiction").named("stiction_1").along(Axis::linear).turns(motor_sense).while_driven(nut_sense),
      port("stiction").named("stiction_2").along(Axis::linear).turns(motor_sense).while_driven(nut_sense)};
  static constexpr bool joined[num_ports][2] = {{true, false}, {false, true}, {false, true}, {false, true},
                                                {true, true},  {true, true},  {false, true}, {false, true},
                                                {false, true}, {false, true}};
  static constexpr std::array inputs{input("voltage", Dimension::voltage, Between::hold, "voltage at the motor")
                                         .required()
                                         .replaced_by("actuator_velocity"),
                                     input("actuator_velocity", Dimension::speed, Between::linear,
                                           "velocity of the nut that pulls cable 1, by the drive")};
  static constexpr std::array outputs{
      output("joint_angle", Dimension::displacement, "angle of the first link from the base").position_of(0),
      output("joint_velocity", Dimension::flow, "velocity of the joint"),
      output("cable_force_1", Dimension::force, "force of cable 1 at its nut"),
      output("cable_force_2", Dimension::force, "force of cable 2 at its nut"),
      output("motor_velocity", Dimension::angular_speed, "velocity of the motor")};
  static constexpr std::array places{Place{"winding", "in the motor winding"}, Place{"stiction", "in the guides"}};
  static constexpr std::array<std::string_view, 2> structural{"winding:winding", "cable:taut_compliance"};
  static constexpr std::array<std::string_view, 4> nominal{"motor:viscous", "gear:arctan", "bushing_1:bushing_branches",
                                                           "bushing_2:bushing_branches"};
  static constexpr std::array<Renamed, 4> renamed{{{"cable:taut_compliance", "pretension", "pretension"},
                                                   {"winding:winding", "torque_constant", "torque_constant"},
                                                   {"winding:winding", "resistance", "motor_resistance"},
                                                   {"winding:winding", "inductance", "motor_inductance"}}};

  using Bushing =
      Slot<T, typename Joined<friction::Bushing, Laws<friction::Coulomb, friction::Viscous, friction::Stribeck>>::type>;
  using Cable = Slot<T, transmission::Cable>;
  using Stiction = Slot<T, Laws<transmission::Hold>>;
  std::tuple<Slot<T, friction::All>, Slot<T, friction::All>, Slot<T, actuation::Motor>,
             Slot<T, Laws<friction::Arctan, transmission::Ripple>>, Cable, Cable, Bushing, Bushing, Stiction, Stiction>
      slot;
  Chain<T, loading::All> load;
  Chain<T, actuation::All> actuation;
  std::array<Chain<T, sensing::All>, 5> sensor;
  T motor_inertia, gear_ratio, screw_pitch, anchor_distance, link_1_mass, link_1_inertia, link_1_length, link_1_center,
      link_2_mass, link_2_inertia, link_2_center, mounting_angle, gravity;
  std::array<T, 2> inverse_inertia;  ///< at theta = 0
  T per_turn, travel, rest_stretch;

  static constexpr auto parameters() {
    using C = CableJoint;
    const auto own = [](T C::*field, std::string_view of, Dimension dimension, double lower, std::string_view meaning) {
      return parameter(field, of, dimension, Purpose::structure, 1.0, lower, inf, meaning);
    };
    return std::tuple{
        own(&C::motor_inertia, "motor_inertia", Dimension::inertia, 1e-12, "inertia of everything on the motor shaft"),
        own(&C::gear_ratio, "gear_ratio", Dimension::ratio, 1e-9, "turns of the motor per turn of the screw"),
        own(&C::screw_pitch, "screw_pitch", Dimension::length, 1e-9, "travel of the nut per turn of the screw"),
        own(&C::anchor_distance, "anchor_distance", Dimension::length, 1e-9, "r: of the cables' anchors from the axis"),
        own(&C::link_1_mass, "link_1_mass", Dimension::mass, 0.0, "mass of the first link"),
        own(&C::link_1_inertia, "link_1_inertia", Dimension::inertia, 1e-12, "of the first link about its own centre"),
        own(&C::link_1_length, "link_1_length", Dimension::length, 0.0, "distance of the two axes"),
        own(&C::link_1_center, "link_1_center", Dimension::length, 0.0, "of its centre of mass from the first axis"),
        own(&C::link_2_mass, "link_2_mass", Dimension::mass, 0.0, "mass of the second link"),
        own(&C::link_2_inertia, "link_2_inertia", Dimension::inertia, 0.0, "of the second link about its own centre"),
        own(&C::link_2_center, "link_2_center", Dimension::length, 0.0, "of its centre of mass from the second axis"),
        own(&C::mounting_angle, "mounting_angle", Dimension::angle, -inf, "of the base from the horizontal"),
        own(&C::gravity, "gravity", Dimension::acceleration, 0.0, "0: the joint moves in a horizontal plane")};
  }
  void prepare() {
    per_turn = inverse_turn * screw_pitch;
    travel = per_turn / gear_ratio;
    rest_stretch = holding_stretch(T(0.0), T(0.0));
    inverse_inertia = {1.0 / inertia(T(1.0)), 1.0 / motor_inertia};
  }
  std::array<T, dof> rigid_shape() const { return {T(1.0), anchor_distance / travel}; }
  T effort_per_command() const {
    const auto& drive = std::get<actuation::Winding<T>>(std::get<winding>(slot).laws);
    return drive.torque_constant * anchor_distance / (travel * drive.resistance);
  }
  /// The nuts start where they hold the joint and its load at rest; a motor that drives them starts with the joint's
  /// velocity.
  template <class Inputs>
  void begin(Motion<T, 2>& at, const Inputs& in) const {
    const T theta = at.position[0], held = holding_stretch(theta, load.apply(T{}));
    const T goal = anchor_distance * sin(theta) + held - rest_stretch;
    at.position[1] = goal / travel;
    Nut<T> nut = carried(at.position[1], T(1.0));
    for (int i = 0; i < 8; ++i) {  // Newton: the ripple is a small part of the travel
      at.position[1] = at.position[1] - (nut.position - goal) / nut.velocity;
      nut = carried(at.position[1], T(1.0));
    }
    const bool idles = in.template given<driver>();
    at.velocity[1] = idles ? T(0.0) : anchor_distance * cos(theta) * at.velocity[0] / nut.velocity;
  }
  /// Not inlined: ten ports in every stage of every scalar would compile for minutes and gain nothing.
  template <class S, class Modes, class Inputs>
  [[gnu::noinline]] MovingCoupling<S, num_ports, 2> couple(const Motion<S, 2>& at, const Modes& mode,
                                                           const Inputs& in) const {
    MovingCoupling<S, num_ports, 2> c;
    const S theta = at.position[0], omega = at.velocity[1], cosine = cos(theta), arm = anchor_distance * cosine;
    const bool idles = in.template given<driver>();
    const S turned = at.position[1] + in.template integral<1>(at.time) / travel;
    const S turning = omega + in.template input<1>(at.time) / travel;
    const Nut<S> nut = carried(turned, constant<S>(1.0));  // velocity: travel per motor angle
    const S nut_velocity = nut.velocity * turning, guided = arm * at.velocity[0];
    const S path = path_slope(theta), longer = path * at.velocity[0], pulled = nut_velocity - guided;
    set(c.port[cable_1], longer + pulled, nut.position - anchor_distance * sin(theta) + rest_stretch);
    set(c.port[cable_2], longer - pulled, -c.port[cable_1].position);
    c.port[cable_1].wrap = c.port[cable_2].wrap = theta;
    pass_bushings(c, theta, guided, nut_velocity, mode, idles);
    const S pull = tension<cable_1>(c) - tension<cable_2>(c), gravity_torque = weight(theta);
    const S known = load.apply(S{});
    set(c.port[joint], at.velocity[0], theta, 0.5 * (arm * pull - gravity_torque - known), mode[joint_sense]);
    set(c.port[motor], omega, at.position[1], nut.velocity * pull, mode[motor_sense]);
    set(c.port[winding], omega, at.position[1], idles ? S{} : actuation.apply(S(in.command(at))));
    set(c.port[gear], turning, turned / gear_ratio);  // one turn of the screw is one cycle of a ripple
    c.applied[0] = gravity_torque + whirl(theta) * square(at.velocity[0]) + known;
    c.inverse_inertia = {1.0 / inertia(cosine), constant<S>(1.0) / motor_inertia};
    c.lever[joint][0] = c.lever[motor][1] = c.lever[winding][1] = constant<S>(1.0);
    c.lever[cable_1][0] = path - arm;
    c.lever[cable_2][0] = path + arm;
    if (idles) return c;
    c.lever[gear][1] = constant<S>(1.0);
    for (int i : {cable_1, bushing_1, stiction_1}) {
      c.lever[i][1] = nut.velocity;
      c.lever[i + 1][1] = -nut.velocity;
    }
    return c;
  }
  template <class S, class Force, class PortAt>
  std::array<S, 5> observe(const Motion<S, 2>& at, const Force& force, const PortAt& port) const {
    const auto of = [&](auto i) { return force(i); };
    const S one = of(at_port<cable_1>) + of(at_port<bushing_1>) + of(at_port<stiction_1>);
    const S two = of(at_port<cable_2>) + of(at_port<bushing_2>) + of(at_port<stiction_2>);
    return {at.position[0], at.velocity[0], one, two, port(at_port<gear>).velocity};
  }

 private:
  template <int i>
  static constexpr std::integral_constant<int, i> at_port{};
  template <class S>
  struct Nut {
    S position, velocity;
  };
  template <class S>
  static void set(Sliding<S>& port, const S& velocity, const S& position, const S& load = S{},
                  const Plain<S>& direction = {}) {
    port.velocity = velocity;
    port.position = position;
    port.load = load;
    port.direction = direction;
  }
  /// Where gear and screw take the nut, and how fast, where the motor has turned by `angle` and turns with `velocity`.
  template <class S>
  Nut<S> carried(const S& angle, const S& velocity) const {
    Sliding<S> at;
    at.position = angle / gear_ratio;
    at.velocity = velocity;
    std::get<gear>(slot).template each<role::motion>([&](const auto& law) { at = law.motion(at); });
    return {per_turn * at.position, travel * at.velocity};
  }
  /// What the path of either cable gains per angle of the joint.
  template <class S>
  S path_slope(const S& theta) const {
    S sum{};
    std::get<cable_1>(slot).template each<role::motion>([&](const auto& law) {
      if constexpr ((std::decay_t<decltype(law)>::sees & sees_wrap) != 0) sum = sum + law.slope(theta);
    });
    return sum;
  }
  template <int i, class S>
  S tension(const MovingCoupling<S, num_ports, 2>& c) const {
    return std::get<i>(slot).respond(c.port[i], S{}).force;
  }
  /// What the guides see, forwards as each cable runs, and what they would do in the sense in which nuts that are
  /// prescribed (`idles`: so the motor does) last moved.
  template <class S, class Modes>
  void pass_bushings(MovingCoupling<S, num_ports, 2>& c, const S& theta, const S& guided, const S& nut_velocity,
                     const Modes& mode, bool idles) const {
    const T& preload = std::get<transmission::TautCompliance<T>>(std::get<cable_1>(slot).laws).pretension;
    for (int i : {0, 1}) {
      const double forwards = i == 0 ? 1.0 : -1.0;
      auto& guide = c.port[static_cast<std::size_t>(bushing_1 + i)];
      auto& still = c.port[static_cast<std::size_t>(stiction_1 + i)];
      set(guide, S(forwards * (idles ? guided : nut_velocity)), S(forwards * anchor_distance * sin(theta)),
          lift<S>(preload), forwards * mode[idles ? guide_sense : motor_sense]);
      guide.wrap = theta;
      set(still, S(forwards * nut_velocity), guide.position, S{}, forwards * mode[idles ? nut_sense : motor_sense]);
    }
    if (std::get<stiction_1>(slot).active == 0 || !idles) return;
    held<bushing_1, stiction_1>(c);
    held<bushing_2, stiction_2>(c);
  }
  template <int of, int at, class S>
  void held(MovingCoupling<S, num_ports, 2>& c) const {
    const auto& guide = std::get<of>(slot);
    Sliding<S> last = c.port[of];
    last.direction = c.port[at].direction;
    c.port[at].load = guide.respond(last, S{}).force - guide.respond(c.port[of], S{}).force;
  }
  /// I(theta), from the cosine of theta (S2 eq. 5).
  template <class S>
  S inertia(const S& cosine) const {
    const T fixed = link_1_inertia + 4.0 * link_2_inertia + link_1_mass * square(link_1_center) +
                    link_2_mass * (square(link_1_length) + 4.0 * square(link_2_center));
    return fixed + (4.0 * link_2_mass * link_1_length * link_2_center) * cosine;
  }
  /// Half of dI/dtheta, with its sign turned: what acts on the joint per squared velocity.
  template <class S>
  S whirl(const S& theta) const {
    return (2.0 * link_2_mass * link_1_length * link_2_center) * sin(theta);
  }
  /// Torque of gravity on the joint (S2 eq. 6, with signed forces).
  template <class S>
  S weight(const S& theta) const {
    const S first = cos(theta + mounting_angle), second = cos(2.0 * theta + mounting_angle);
    const T near = link_1_mass * link_1_center + link_2_mass * link_1_length, far = 2.0 * link_2_mass * link_2_center;
    return -(gravity * (near * first + far * second));
  }
  /// Elongation of cable 1, but for the path that both cables gain, that holds the joint and the torque `known` on it
  /// at rest, by Newton: with both cables taut and linear in one step.
  T holding_stretch(const T& theta, const T& known) const {
    using D = Dual<T, 1>;
    const auto& cable = std::get<cable_1>(slot);
    const T& stiffness = std::get<transmission::TautCompliance<T>>(cable.laws).stiffness;
    const auto stretches = plain(stiffness) > 0.0;
    if (!any(stretches)) return T(0.0);
    const T arm = anchor_distance * cos(theta), wanted = -((weight(theta) + known) / arm),
            path = path_slope(theta) / arm;
    T stretch = wanted / (2.0 * stiffness);
    for (int i = 0; i < 20; ++i) {
      Sliding<D> pulled, released;
      pulled.position = variable<D>(stretch, 0);
      released.position = -pulled.position;
      pulled.wrap = released.wrap = lift<D>(theta);
      const D one = cable.respond(pulled, D{}).force, two = cable.respond(released, D{}).force;
      const D pull = one - two - path * (one + two);
      const auto taut = plain(pull.d[0]) > 0.0;  // one of the cables
      if (!any(taut)) break;
      stretch = select(taut, T(stretch + (wanted - pull.value) / pull.d[0]), stretch);
    }
    return select(stretches, stretch, T(0.0));
  }
};
}  // namespace tendonlab::systems
