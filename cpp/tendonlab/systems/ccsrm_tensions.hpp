#pragma once
#include "tendonlab/systems/ccsrm_cables.hpp"
#include "tendonlab/systems/sampled.hpp"

namespace tendonlab::systems {
/// The six tensions of the cables of S4, sample by sample, where both angles were measured: no inertia, nothing to
/// integrate but the bristles. So k, T_p and friction are fitted to tensions whatever moves joint 1 (S4 eqs 37, 38).
/// Between samples a bristle goes the way that its contact went, which decides it, not the speed: contacts are as in
/// the middle of the interval. They begin relaxed, and the end sections do not stretch.
template <class T>
struct CcsrmTensions : CcsrmCables<T> {
  static constexpr std::string_view name = "ccsrm_tensions",
                                    equation =
                                        "T_i2 = T_p -+ k r (theta_2 - theta_1); T_i1 = T_i2 - f_i1; T_i3 = T_i2 - "
                                        "f_i2";
  using Base = CcsrmCables<T>;
  enum PortOf { c11, c12, c21, c22, cable };
  static constexpr int dof = 0;
  static constexpr bool sampled = true;
  using Carried = std::array<T, 2>;  ///< angles of joints 1 and 2 at the sample before
  static constexpr std::array ports{contact_ports[0], contact_ports[1], contact_ports[2], contact_ports[3], cable_port};
  static constexpr std::array inputs{
      Base::driver_angle, input("joint_angle", Dimension::angle, Between::smooth, "angle of joint 1").required()};
  static constexpr auto& outputs = Base::sections;

  using Contact = typename Base::Contact;
  std::tuple<Contact, Contact, Contact, Contact, typename Base::Middle> slot;
  Chain<T, Laws<>> load, actuation;
  std::array<Chain<T, sensing::All>, 6> sensor;

  template <class Inputs, class Memory>
  Sample<T, 6, 5> evaluate(const Inputs& in, Memory& memory) const {
    const auto& laws = std::get<c11>(slot);  // those of every contact
    const T angle[2] = {in.template input<1>(), in.template input<0>()};
    const T rate[2] = {in.template slope<1>(), in.template slope<0>()};
    if (in.dt > 0.0) {
      const T mean[2] = {0.5 * (memory.own[0] + angle[0]), 0.5 * (memory.own[1] + angle[1])};
      const T moved[2] = {(angle[0] - memory.own[0]) / in.dt, (angle[1] - memory.own[1]) / in.dt};
      const auto on_the_way = seen(mean, moved);
      for (std::size_t i = c11; i < cable; ++i) memory.slot[i] = advanced(laws, on_the_way[i], memory.slot[i], in.dt);
    }
    memory.own = {angle[0], angle[1]};

    Sample<T, 6, 5> of;
    of.port = seen(angle, rate);
    std::array<T, 4> load_of, friction;
    for (std::size_t i = c11; i < cable; ++i) {
      load_of[i] = of.port[i].load;
      friction[i] = of.force[i] = laws.respond(of.port[i], memory.slot[i]).force;
    }
    of.force[cable] = std::get<cable>(slot).respond(of.port[cable], T(0.0)).force;
    of.output = Base::tensions(load_of, friction);
    return of;
  }

 private:
  /// What the ports see at these angles and rates of joints 1 and 2.
  std::array<Sliding<T>, 5> seen(const T (&angle)[2], const T (&rate)[2]) const {
    std::array<Sliding<T>, 5> port;
    this->follow_joints(port.data(), port[cable], std::get<cable>(slot), angle, rate);
    for (auto& at : port) at = sliding(at.velocity, at.position, at.load, at.wrap);
    return port;
  }
};
}  // namespace tendonlab::systems
