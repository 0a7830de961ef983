#pragma once
#include "tendonlab/mechanics/tendon_routing.hpp"
#include "tendonlab/systems/sampled.hpp"
#include "tendonlab/systems/tendon_signals.hpp"

namespace tendonlab::systems {
/// Motor torques that coupled tendon transmissions need to give `external_torque` to four joints in motion  (S1 fig.
/// 4):
///   S' = R q',  R_m q_m' = R q',   T_before = T_behind + loss(T_before, S'),   C_m = R_m T_0.
/// Net tensions T in N, positive towards +q of the own joint; velocities S' of the branches in m/s. `external_torque`
/// is the torque that the transmissions give, minus that of the environment. Losses on a branch are laws of its slot:
/// constant, viscous and tension-proportional ones by its parameters, and the laws of `cable` on every branch. Reducers
/// sit on the driven pulleys; at rest they drive. Fewer joints: unit radii, no losses and no load for the others.
template <class T>
struct TendonRouting : SystemDefaults, tendon::Entries<T> {
  static constexpr std::string_view name = "tendon_routing",
                                    equation =
                                        "R_m q_m' = R q'; tension before a branch = tension behind it + loss; "
                                        "C_m = R_m tension at the motor";
  static constexpr int dof = 0;
  static constexpr bool sampled = true;
  static constexpr std::size_t n = tendon::joints, branches = tendon::branches;
  using Carried = std::array<T, branches>;  ///< travel of each branch
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
        const Losses own{{{of(tendon::constant_loss, b)}, {of(tendon::viscous_loss, b)}, {of(tendon::tension_loss, b)}},
                         always};
        branch[b] = joined(own, std::get<0>(slot));
      }
      if (plain(radius[i][i]) == 0.0)
        throw ParameterError(sentence("radius_", i + 1, "_", i + 1, " = 0: expected a driven pulley, m"));
      radius[i][i] = radius[i][i] * of(tendon::reducer_ratio, i);
    }
  }

  template <class Inputs, class Memory>
  Sample<T, n, branches + n> evaluate(const Inputs& in, Memory& memory) const {
    Sample<T, n, branches + n> out;
    const Vector joint = mechanics::joint_motion(radius, taken_up(in)), torque = wanted(in);
    const Rows velocity = mechanics::branch_motion(radius, joint);
    const auto before = [&](std::size_t i, std::size_t link, const T& behind) {
      const std::size_t b = tendon::cell(i, link);
      memory.own[b] = memory.own[b] + in.dt * velocity[i][link];
      const BranchMotion at{b, velocity[i][link], memory.own[b]};
      memory.slot[b] = bristle_after(in.dt, at, behind, memory.slot[b]);
      const T tension = tension_before(at, behind, memory.slot[b]);
      out.port[b] = sliding(at.velocity, at.travel, tension);
      out.force[b] = tension - behind;
      return tension;
    };
    const auto input = [&](std::size_t j, const T& output) {
      const auto resist = [&](const Sliding<T>& at) -> T { return reducer_friction(j, at); };
      const T loss = mechanics::reducer_loss(resist, output, joint[j], mechanics::AtRest::drive);
      out.port[branches + j] = sliding(joint[j], T(0.0), output);
      out.force[branches + j] = loss;
      return T(output + loss);
    };
    const auto statics = mechanics::propagate_to_motors(radius, torque, before, input, Statics{});
    for (std::size_t i = 0; i < n; ++i) out.output[i] = motor_radius[i] * statics.tension[i][0];
    return out;
  }

 private:
  using Vector = std::array<T, n>;
  using Rows = std::array<Vector, n>;
  using Statics = mechanics::Propagation<Vector, std::array<std::array<T, n + 1>, n>>;
  using Losses = Slot<T, friction::Branch>;
  using Branch = Slot<T, typename Joined<friction::Branch, friction::All>::type>;
  static constexpr unsigned always = ~0u >> (32 - Losses::size);
  Rows radius{};  ///< signed; of the own joint with the reducer's ratio
  Vector motor_radius{};
  std::array<friction::Efficiency<T>, n> reducer{};
  std::array<bool, n> has_reducer{};
  std::array<Branch, branches> branch{};  ///< its own losses, then the laws that `cable` adds on every branch

  /// Cable that each motor takes up per time, and torque that each joint needs.
  template <class Inputs>
  Vector taken_up(const Inputs& in) const {
    return {motor_radius[0] * in.template input<0>(), motor_radius[1] * in.template input<1>(),
            motor_radius[2] * in.template input<2>(), motor_radius[3] * in.template input<3>()};
  }
  template <class Inputs>
  Vector wanted(const Inputs& in) const {
    return {load.apply(in.template input<4>()), load.apply(in.template input<5>()), load.apply(in.template input<6>()),
            load.apply(in.template input<7>())};
  }
  /// A branch and its motion.
  struct BranchMotion {
    std::size_t branch;
    T velocity, travel;
  };
  template <class S>
  static Sliding<S> seen(const BranchMotion& at, const S& tension) {
    return sliding(lift<S>(at.velocity), lift<S>(at.travel), tension, constant<S>(0.0));
  }
  /// Tension before a branch where its bristle is deflected by `bristle`.
  T tension_before(const BranchMotion& at, const T& behind, const T& bristle) const {
    return mechanics::effort_before_loss(behind, [&](const auto& tension) {
      return branch[at.branch].respond(seen(at, tension), lift<std::decay_t<decltype(tension)>>(bristle)).force;
    });
  }
  /// The bristle of a branch after `dt`. It moves under the dry friction of the tension that steady sliding would need,
  /// so that in steady sliding it gives the same force as dry friction.
  T bristle_after(double dt, const BranchMotion& at, const T& behind, const T& bristle) const {
    const Branch& laws = branch[at.branch];
    if (!laws.has(role::memory)) return bristle;
    const T steady = mechanics::effort_before_loss(behind, [&](const auto& tension) {
      const auto sees = seen(at, tension);
      auto sum = sees.direction * laws.dry_level(sees);
      laws.template each<role::force>([&](const auto& law) { sum = sum + law.force(sees); });
      return sum;
    });
    return advanced(laws, sliding(at.velocity, at.travel, steady), bristle, dt);
  }
  /// Loss of the reducer on joint j: by its efficiency, and by the laws of `gear` where there is a reducer.
  T reducer_friction(std::size_t j, const Sliding<T>& at) const {
    const T own = at.direction * reducer[j].level(at);
    return has_reducer[j] ? T(own + std::get<branches>(slot).respond(at, T(0.0)).force) : own;
  }
};
}  // namespace tendonlab::systems
