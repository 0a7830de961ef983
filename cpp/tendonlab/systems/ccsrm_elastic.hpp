#pragma once
#include "tendonlab/systems/ccsrm_tables.hpp"

namespace tendonlab::systems {
/// The same where the end sections stretch, so that slip is a motion of its own: DoF 1 + i is the slip of contact i as
/// an angle, w / r. A wrapped cable weighs next to nothing: its mass only makes the slip a state.
template <class T>
struct CcsrmElastic : CcsrmTables<T> {
  using Base = CcsrmTables<T>;
  using Base::joint, Base::c11, Base::c12, Base::c21, Base::c22, Base::cable, Base::e11;
  static constexpr double mass = 1e-6;  ///< kg: far below that of a strand, so that slip follows the forces at once
  static constexpr int dof = 5, stated = 1, directions = 5;
  static constexpr auto ports = ccsrm_ports(
      {contact_ports[0].turns(1), contact_ports[1].turns(2), contact_ports[2].turns(3), contact_ports[3].turns(4)});
  static constexpr bool joined[10][5] = {
      {true}, {false, true}, {false, false, true}, {false, false, false, true}, {false, false, false, false, true}};
  std::array<T, 5> inverse_inertia;
  T lever[10][5];

  void prepare() {
    const T& r = this->pulley_radius;
    inverse_inertia[0] = 1.0 / this->inertia;
    for (std::size_t i = 1; i < 5; ++i) inverse_inertia[i] = 1.0 / (mass * r * r);
    for (auto& row : lever)
      for (auto& cell : row) cell = T(0.0);
    lever[joint][0] = T(1.0);
    for (std::size_t i = 0; i < 4; ++i) lever[c11 + i][1 + i] = r;
  }
  std::array<T, 5> rigid_shape() const { return {T(1.0), T(-1.0), T(1.0), T(1.0), T(-1.0)}; }
  /// Nothing is stretched at first: slip is that of the joints.
  template <class Inputs>
  void begin(Motion<T, 5>& at, const Inputs& in) const {
    const T turn[2] = {at.position[0], in.template input<0>(at.time)};
    for (std::size_t i = 0; i < 4; ++i) at.position[1 + i] = Base::flip[i] * turn[i % 2];
  }

  template <class S, class Modes, class Inputs>
  Coupling<S, 10, 5> couple(const Motion<S, 5>& at, const Modes& mode, const Inputs& in) const {
    Coupling<S, 10, 5> c;
    const T& r = this->pulley_radius;
    const S turn[2] = {at.position[0], in.template input<0>(at.time)};
    const auto& slip = at.position;
    const S stretch[2] = {-r * (slip[1] + slip[2]), -r * (slip[3] + slip[4])};
    const S rate[2] = {-r * (at.velocity[1] + at.velocity[2]), -r * (at.velocity[3] + at.velocity[4])};
    c.port[cable].position = 0.5 * (stretch[1] - stretch[0]);
    c.port[cable].velocity = 0.5 * (rate[1] - rate[0]);
    this->load_contacts(&c.port[c11], c.port[cable], std::get<cable>(this->slot), turn, stretch);
    for (std::size_t i = 0; i < 4; ++i) {
      c.port[c11 + i].velocity = r * at.velocity[1 + i];
      c.port[c11 + i].direction = mode[1 + i];
      auto& end = c.port[e11 + i];
      end.position = r * (slip[1 + i] - Base::flip[i] * turn[i % 2]);
      end.load = Base::pulling(S(this->pretension + std::get<e11>(this->slot).respond(end, S{}).force));
      c.applied[1 + i] = r * (c.port[c11 + i].load - end.load);
    }
    c.applied[0] = r * (c.port[e11 + 2].load - c.port[e11].load);
    c.port[joint].position = at.position[0];
    c.port[joint].velocity = at.velocity[0];
    c.port[joint].load = c.applied[0];
    c.port[joint].direction = mode[0];
    return c;
  }
  template <class S, class Force, class PortAt>
  std::array<S, 7> observe(const Motion<S, 5>& at, const Force&, const PortAt& port) const {
    const auto load = [&](auto i) { return port(i).load; };
    return {at.position[0],
            load(std::integral_constant<int, e11>{}),
            load(std::integral_constant<int, c11>{}),
            load(std::integral_constant<int, e11 + 1>{}),
            load(std::integral_constant<int, e11 + 2>{}),
            load(std::integral_constant<int, c21>{}),
            load(std::integral_constant<int, e11 + 3>{})};
  }
};
}  // namespace tendonlab::systems
