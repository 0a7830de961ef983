#pragma once
#include "tendonlab/systems/sampled.hpp"
#include "tendonlab/systems/tendon_signals.hpp"
#include "tendonlab/transmission/routing.hpp"

namespace tendonlab::systems {
/// Motor torques that coupled tendon transmissions need to give `external_torque` to four joints in motion  (S1 fig.
/// 4):
///   S' = R q',  R_m q_m' = R q',   T_before = T_behind + loss(T_before, S'),   C_m = R_m T_0.
/// Net tensions T in N, positive towards +q of the own joint; velocities S' of the branches in m/s. `external_torque`
/// is what the transmissions give, minus what the environment does. Losses on a branch are laws of its slot: constant,
/// viscous and tension-proportional ones as the parameters say, and what `cable` adds on every branch. Reducers sit on
/// the driven pulleys; at rest they drive. Fewer joints: unit radii, no losses and no load for the others.
template <class T>
struct TendonRouting : SystemDefaults, tendon::Entries<T> {
  static constexpr std::string_view name = "tendon_routing",
                                    equation =
                                        "R_m q_m' = R q'; tension before a branch = tension behind it + loss; "
                                        "C_m = R_m tension at the motor";
  static constexpr int dof = 0;
  static constexpr bool sampled = true;
  static constexpr std::size_t n = tendon::joints, branches = tendon::branches;
  static constexpr std::size_t carried = branches;  ///< travel of each branch
  static constexpr auto ports = tendon::ports();
  static constexpr auto inputs = tendon::inputs();
  static constexpr auto outputs = tendon::outputs();
  static constexpr std::array places{Place{"load", "of the load"}};
  /// Losses of the parameters are no effects. Effects that refine dry friction ask for `cable:coulomb`, perhaps of 0.
  static constexpr std::array<std::string_view, 0> nominal{};

  using Cable = Slot<T, friction::All>;
  using Gear = Slot<T, Laws<friction::Efficiency>>;
  std::tuple<Cable, Cable, Cable, Cable, Cable, Cable, Cable, Cable, Cable, Cable, Gear, Gear, Gear, Gear> slot;
  Chain<T, loading::Known> load;
  Chain<T, Laws<>> actuation;
  std::array<Chain<T, sensing::All>, n> sensor;

  static constexpr auto parameters() {
    return tendon::table<TendonRouting, T>(std::make_index_sequence<tendon::count>{});
  }
  void prepare() {
    const auto value = this->values();
    const auto of = [&](tendon::KindOf kind, std::size_t place) -> const T& {
      return value[tendon::index_of(kind, place)];
    };
    for (std::size_t i = 0; i < n; ++i) {
      motor_radius[i] = of(tendon::motor_radius, i);
      has_reducer[i] = plain(of(tendon::reducer_ratio, i)) != 1.0;
      reducer[i] = {1.0 / of(tendon::reducer_efficiency, i) - 1.0, T(1.0)};
      for (std::size_t j = 0; j <= i; ++j) {
        const std::size_t b = tendon::cell(i, j);
        radius[i][j] = of(tendon::radius, b);
        branch[b] = std::get<0>(slot);
        add(branch[b], &friction::Coulomb<T>::coulomb, of(tendon::constant_loss, b));
        add(branch[b], &friction::LoadDependence<T>::load_dependence, of(tendon::tension_loss, b));
        add(branch[b], &friction::Viscous<T>::viscous, of(tendon::viscous_loss, b));
      }
      if (plain(radius[i][i]) == 0.0)
        throw ParameterError(sentence("radius_", i + 1, "_", i + 1, " = 0: expected a driven pulley, m"));
      radius[i][i] = radius[i][i] * of(tendon::reducer_ratio, i);
    }
  }

  template <class Inputs, class Memory>
  Sample<T, n, branches + n> evaluate(const Inputs& in, Memory& memory) const {
    Sample<T, n, branches + n> out;
    State of = moved(in, memory);
    const auto before = [&](std::size_t i, std::size_t link, const T& behind) {
      const std::size_t b = tendon::cell(i, link);
      const T tension = tension_before(b, of.velocity[i][link], memory.own[b], behind, memory.slot[b], in.dt);
      out.port[b] = sliding(of.velocity[i][link], memory.own[b], tension);
      out.force[b] = tension - behind;
      return tension;
    };
    const auto input = [&](std::size_t j, const T& output) {
      const auto resist = [&](const Sliding<T>& at) -> T { return reducer_friction(j, at); };
      const T loss = transmission::reducer_loss(resist, output, of.joint[j], transmission::AtRest::drive);
      out.port[branches + j] = sliding(of.joint[j], T(0.0), output);
      out.force[branches + j] = loss;
      return T(output + loss);
    };
    transmission::propagate_to_motors(radius, of.torque, before, input, of.tension, of.own);
    for (std::size_t i = 0; i < n; ++i) out.output[i] = motor_radius[i] * of.tension[i][0];
    return out;
  }

 private:
  using Vector = std::array<T, n>;
  /// One sample: what moves, what is asked for, and the tensions that follow.
  struct State {
    Vector joint{}, torque{}, own{};
    std::array<Vector, n> velocity{};
    std::array<std::array<T, n + 1>, n> tension{};
  };
  std::array<Vector, n> radius{};  ///< signed; of the own joint with the reducer's ratio
  Vector motor_radius{};
  std::array<friction::Efficiency<T>, n> reducer{};
  std::array<bool, n> has_reducer{};
  std::array<Cable, branches> branch{};

  /// Adds to the amplitude of a law of the slot, which is on from then on.
  template <class Law>
  static void add(Cable& to, T Law::*amplitude, const T& value) {
    unsigned bit = 0, next = 1;
    friction::All::for_each([&](auto* law) {
      if (std::remove_pointer_t<decltype(law)>::name == Law::name) bit = next;
      next <<= 1;
    });
    T& now = std::get<Law>(to.laws).*amplitude;
    now = (to.active & bit) != 0 ? T(now + value) : value;
    to.active |= bit;
  }
  template <class Inputs, class Memory>
  State moved(const Inputs& in, Memory& memory) const {
    State of;
    Vector taken_up{in.template input<0>(), in.template input<1>(), in.template input<2>(), in.template input<3>()};
    for (std::size_t i = 0; i < n; ++i) taken_up[i] = motor_radius[i] * taken_up[i];
    transmission::joint_motion(radius, taken_up, of.joint);
    transmission::branch_motion(radius, of.joint, of.velocity);
    of.torque = {load.apply(in.template input<4>()), load.apply(in.template input<5>()),
                 load.apply(in.template input<6>()), load.apply(in.template input<7>())};
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j <= i; ++j) {
        T& travel = memory.own[tendon::cell(i, j)];
        travel = travel + in.dt * of.velocity[i][j];
      }
    return of;
  }
  /// Tension before branch b. A bristle moves under the dry friction of the tension that steady sliding would need, so
  /// that in steady sliding it gives what dry friction does.
  T tension_before(std::size_t b, const T& velocity, const T& travel, const T& behind, T& bristle, double dt) const {
    const Cable& laws = branch[b];
    const auto seen = [&](const auto& tension) {
      using S = std::decay_t<decltype(tension)>;
      return sliding(lift<S>(velocity), lift<S>(travel), tension, constant<S>(0.0));
    };
    if (laws.has(role::memory)) {
      const T steady = transmission::beside_loss(behind, -1.0, [&](const auto& tension) {
        const auto at = seen(tension);
        auto sum = at.direction * laws.dry_level(at);
        laws.template each<role::force>([&](const auto& law) { sum = sum + law.force(at); });
        return sum;
      });
      answer(laws, sliding(velocity, travel, steady), bristle, dt);
    }
    return transmission::beside_loss(behind, -1.0, [&](const auto& tension) {
      const auto at = seen(tension);
      return laws.respond(at, lift<std::decay_t<decltype(tension)>>(bristle)).force;
    });
  }
  /// Loss of the reducer on joint j: as its efficiency says, and what `gear` adds where there is one.
  T reducer_friction(std::size_t j, const Sliding<T>& at) const {
    const T own = at.direction * reducer[j].level(at);
    return has_reducer[j] ? T(own + std::get<branches>(slot).respond(at, T(0.0)).force) : own;
  }
};
}  // namespace tendonlab::systems
