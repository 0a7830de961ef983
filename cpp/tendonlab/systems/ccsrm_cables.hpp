#pragma once
#include "tendonlab/systems/system.hpp"

namespace tendonlab::systems {
/// The ports of S4: a contact at each pulley of each cable, the middle sections as one port.
inline constexpr Port contact_port = port("contact").along(Axis::linear),
                      cable_port = port("cable").along(Axis::linear);
inline constexpr std::array contact_ports{contact_port.named("contact_11"), contact_port.named("contact_12"),
                                          contact_port.named("contact_21"), contact_port.named("contact_22")};

/// The cables of S4: two S-shaped ones run over two pulleys and couple joint 1 to joint 2, with friction at every
/// contact.
///   T_12 = T_p - k r (theta_2 - theta_1),  T_22 = T_p + k r (theta_2 - theta_1)               middle sections
///   T_11 = T_12 - f_11,  T_13 = T_12 - f_12,  T_21 = T_22 - f_21,  T_23 = T_22 - f_22         end sections
/// Slip v is positive towards the middle section, so f opposes it: v = r (-theta_1', theta_2', theta_1', -theta_2')
/// while the end sections do not stretch. All systems of these cables inherit from this.
template <class T>
struct CcsrmCables : SystemDefaults {
  static constexpr std::array sections{output("tension_11", Dimension::force, "tension of cable 1 beyond pulley 1"),
                                       output("tension_12", Dimension::force, "tension of cable 1 between the pulleys"),
                                       output("tension_13", Dimension::force, "tension of cable 1 beyond pulley 2"),
                                       output("tension_21", Dimension::force, "tension of cable 2 beyond pulley 1"),
                                       output("tension_22", Dimension::force, "tension of cable 2 between the pulleys"),
                                       output("tension_23", Dimension::force, "tension of cable 2 beyond pulley 2")};
  static constexpr Input driver_angle =
      input("driver_angle", Dimension::angle, Between::smooth, "angle of the driven joint 2").required();
  static constexpr std::array<std::string_view, 4> nominal{"contact:capstan", "contact:presliding", "contact:stribeck",
                                                           "contact:viscous"};
  static constexpr bool plain_names = true;
  static constexpr std::array<Renamed, 1> renamed{{{"contact:viscous", "viscous", "contact_viscous"}}};

  using Contact =
      Slot<T, typename Joined<transmission::Contacts, Laws<friction::Presliding, friction::Viscous, friction::Coulomb,
                                                           friction::LoadDependence>>::type>;
  using Middle = Slot<T, Laws<friction::Viscous>>;
  T cable_stiffness, pretension, pulley_radius, initial_wrap_angle;

  static constexpr auto parameters() {
    using Own = CcsrmCables;
    return std::tuple{parameter(&Own::cable_stiffness, "cable_stiffness", Dimension::line_stiffness, Purpose::structure,
                                1e5, 1e-3, inf, "tension per stretch of a middle section"),
                      parameter(&Own::pretension, "pretension", Dimension::force, Purpose::structure, 50.0, 0.0, inf,
                                "tension of both cables at equal angles without friction"),
                      parameter(&Own::pulley_radius, "pulley_radius", Dimension::length, Purpose::structure, 0.012,
                                1e-6, inf, "radius of the pulleys"),
                      parameter(&Own::initial_wrap_angle, "initial_wrap_angle", Dimension::angle, Purpose::structure,
                                1.69, 1e-3, inf, "wrap angle of every contact at angle 0")};
  }

 protected:
  static constexpr double flip[4] = {-1.0, 1.0, 1.0, -1.0};  ///< slip of each contact per turn of its joint

  /// A cable does not push.
  template <class S>
  static S pulling(const S& tension) {
    return select(plain(tension) > 0.0, tension, constant<S>(0.0));
  }
  /// Of the four contacts the wrap angles (S4 eq. 16), and as loads the middle tensions where cable 1 is longer by
  /// stretch[0] and cable 2 by stretch[1], m; `middle` sees half of their difference, and its laws add to the tension.
  template <class S>
  void load_contacts(Sliding<S>* contact, const Sliding<S>& middle, const Middle& laws, const S (&angle)[2],
                     const S (&stretch)[2]) const {
    const S more = laws.respond(middle, S{}).force;  // of positions and velocities only
    const S tension[2] = {pulling(S(pretension + cable_stiffness * stretch[0] - more)),
                          pulling(S(pretension + cable_stiffness * stretch[1] + more))};
    for (std::size_t i = 0; i < 4; ++i) {
      contact[i].load = tension[i / 2];
      contact[i].wrap = initial_wrap_angle - flip[i] * angle[i % 2];
    }
  }
  /// The four contacts and the middle sections at angles and rates of joints 1 and 2 where the end sections do not
  /// stretch.
  template <class S>
  void follow_joints(Sliding<S>* contact, Sliding<S>& middle, const Middle& laws, const S (&angle)[2],
                     const S (&rate)[2]) const {
    const S longer = pulley_radius * (angle[1] - angle[0]), stretch[2] = {-longer, longer};
    const S speed[2] = {pulley_radius * rate[0], pulley_radius * rate[1]};
    for (std::size_t i = 0; i < 4; ++i) contact[i].velocity = flip[i] * speed[i % 2];
    middle.position = longer;
    middle.velocity = speed[1] - speed[0];
    load_contacts(contact, middle, laws, angle, stretch);
  }
  /// All six tensions: what each contact's friction leaves of its load (S4 eq. 31).
  template <class S>
  static std::array<S, 6> tensions(const std::array<S, 4>& load, const std::array<S, 4>& friction) {
    return {load[0] - friction[0], load[0], load[1] - friction[1],
            load[2] - friction[2], load[2], load[3] - friction[3]};
  }
};
}  // namespace tendonlab::systems
