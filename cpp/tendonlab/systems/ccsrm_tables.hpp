#pragma once
#include "tendonlab/systems/ccsrm_cables.hpp"

namespace tendonlab::systems {
/// All ports of the mechanism, with contacts that turn as `contact` says.
constexpr std::array<Port, 10> ccsrm_ports(const std::array<Port, 4>& contact) {
  const Port end = port("ends").along(Axis::linear);
  return {port("joint").turns(0), contact[0],          contact[1],          contact[2],         contact[3], cable_port,
          end.named("end_11"),    end.named("end_12"), end.named("end_21"), end.named("end_22")};
}

/// Two joints that two S-shaped cables couple to turn by equal angles over two pulleys (S4). Joint 2 is driven:
///   J theta_1'' = r (T_21 - T_11) - friction
/// The part that does not depend on whether the end sections stretch.
template <class T>
struct CcsrmTables : CcsrmCables<T> {
  static constexpr std::string_view name = "ccsrm",
                                    equation =
                                        "J theta_1'' = r (T_21 - T_11) - friction; T_i2 = T_p -+ k r (theta_2 - "
                                        "theta_1); T_i1 = T_i2 - f_i1; T_i3 = T_i2 - f_i2";
  using Cables = CcsrmCables<T>;
  enum PortOf { joint, c11, c12, c21, c22, cable, e11, e12, e21, e22 };
  static constexpr std::array inputs{Cables::driver_angle};
  static constexpr std::array outputs{output("joint_angle", Dimension::displacement, "angle of joint 1").position_of(0),
                                      Cables::sections[0],
                                      Cables::sections[1],
                                      Cables::sections[2],
                                      Cables::sections[3],
                                      Cables::sections[4],
                                      Cables::sections[5]};
  static constexpr std::array places{Place{"ends", "in the cable ends"}};

  using Contact = typename Cables::Contact;
  using Ends = Slot<T, transmission::Ends>;
  std::tuple<Slot<T, friction::All>, Contact, Contact, Contact, Contact, typename Cables::Middle, Ends, Ends, Ends,
             Ends>
      slot;
  Chain<T, Laws<>> load, actuation;
  std::array<Chain<T, sensing::All>, 7> sensor;
  T inertia;

  static constexpr auto parameters() {
    return std::tuple_cat(Cables::parameters(),
                          std::tuple{parameter(&CcsrmTables::inertia, "inertia", Dimension::inertia, Purpose::structure,
                                               0.01, 1e-12, inf, "inertia of what joint 1 carries")});
  }
  T effort_per_command() const { return T(1.0); }
};
}  // namespace tendonlab::systems
