#pragma once
#include "tendonlab/systems/ccsrm_tables.hpp"

namespace tendonlab::systems {
template <class T>
struct CcsrmElastic;

/// The mechanism as the paper has it: the end sections do not stretch, so the joints' motion is the slip.
template <class T>
struct Ccsrm : CcsrmTables<T> {
  static constexpr std::string_view grown_by = "ends:compliance";
  template <class S>
  using Grown = CcsrmElastic<S>;
  using Base = CcsrmTables<T>;
  using Base::joint, Base::c11, Base::c12, Base::c21, Base::c22, Base::cable, Base::e11;
  static constexpr int dof = 1, directions = 2;
  static constexpr auto ports = ccsrm_ports({contact_ports[0].turns(0), contact_ports[1].turns_as_driven(1),
                                             contact_ports[2].turns(0), contact_ports[3].turns_as_driven(1)});
  static constexpr bool joined[10][1] = {{true}, {true}, {false}, {true}};
  std::array<T, 1> inverse_inertia;
  T lever[10][1];

  void prepare() {
    inverse_inertia[0] = 1.0 / this->inertia;
    for (auto& row : lever) row[0] = T(0.0);
    lever[joint][0] = T(1.0);
    lever[c11][0] = -this->pulley_radius;
    lever[c21][0] = this->pulley_radius;
  }
  std::array<T, 1> rigid_shape() const { return {T(1.0)}; }

  template <class S, class Modes, class Inputs>
  Coupling<S, 10, 1> couple(const Motion<S, 1>& at, const Modes& mode, const Inputs& in) const {
    Coupling<S, 10, 1> c;
    const S angle[2] = {at.position[0], in.template input<0>(at.time)};
    const S rate[2] = {at.velocity[0], in.template slope<0>(at.time)};
    this->follow_joints(&c.port[c11], c.port[cable], std::get<cable>(this->slot), angle, rate);
    for (std::size_t i = 0; i < 4; ++i) c.port[c11 + i].direction = Base::flip[i] * mode[i % 2];
    c.applied[0] = this->pulley_radius * (c.port[c21].load - c.port[c11].load);
    c.port[joint].position = at.position[0];
    c.port[joint].velocity = at.velocity[0];
    c.port[joint].load = c.applied[0];
    c.port[joint].direction = mode[0];
    return c;
  }
  template <class S, class Force, class PortAt>
  std::array<S, 7> observe(const Motion<S, 1>& at, const Force& force, const PortAt& port) const {
    const auto each = [](auto&& of) -> std::array<S, 4> {
      return {of(std::integral_constant<int, c11>{}), of(std::integral_constant<int, c12>{}),
              of(std::integral_constant<int, c21>{}), of(std::integral_constant<int, c22>{})};
    };
    const auto six = Base::tensions(each([&](auto i) { return port(i).load; }), each(force));
    return {at.position[0], six[0], six[1], six[2], six[3], six[4], six[5]};
  }
};
}  // namespace tendonlab::systems
