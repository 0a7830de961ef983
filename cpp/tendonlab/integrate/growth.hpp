#pragma once
// The error of a step, and what follows from it for the length of the next one: of one simulation, or of lanes.
#include <algorithm>

#include "tendonlab/integrate/experiment.hpp"
#include "tendonlab/integrate/step.hpp"

namespace tendonlab::integrate {
template <class P>
TENDONLAB_INLINE P larger(const P& a, const P& b) {
  return select(a < b, b, a);
}

/// The mean square of the error over its scale: of positions and velocities relative to their size, of each memory
/// relative to the deflection that `memory_level`, the friction level of its slot, allows.
template <class Method, class System, class T>
TENDONLAB_INLINE Plain<T> mean_square_error(const System& system, const Settings& settings,
                                            const StateOf<System, T>& from, const Step<StateOf<System, T>>& s,
                                            const std::array<Plain<T>, slots<System>>& memory_level) {
  using P = Plain<T>;
  constexpr int n = System::dof, judged = systems::stated<System>;
  P sum(0.0);
  const auto add = [&](const T& error, const T& a, const T& b, double scale) TENDONLAB_ALWAYS {
    sum = sum + square(P(plain(error) / (scale + larger(P(abs(plain(a))), P(abs(plain(b)))))));
  };
  for (std::size_t j = 0; j < n; ++j) {
    add(s.error.at.position[j], from.at.position[j], s.to.at.position[j], settings.position_scale);
    if (j < judged) add(s.error.at.velocity[j], from.at.velocity[j], s.to.at.velocity[j], settings.velocity_scale);
  }
  int counted = n + judged;
  unroll<slots<System>>([&](auto i) TENDONLAB_ALWAYS {
    if constexpr (SlotOf<System, i>::states > 0) {
      const auto& slot = std::get<static_cast<std::size_t>(i)>(system.slot);
      slot.template each<role::memory>([&](const auto& law) TENDONLAB_ALWAYS {
        const P scale = law.state_scale(larger(memory_level[i], P(1e-300)));
        sum = sum + square(P(plain(s.error.memory[memory_before<System, i>()]) / scale));
        ++counted;
      });
    }
  });
  return sum * (square(Method::error_weight / settings.tolerance) / counted);
}
/// By how much the next step may grow (> 0), or minus the factor by which this one must shrink.
template <class Method, class P>
TENDONLAB_INLINE P growth_after(const P& mean_square) {
  const P factor = 0.9 * roughly_power(larger(mean_square, P(1e-12)), -0.5 / (Method::error_order + 1));
  const P judged = select(mean_square <= 1.0, P(-larger(P(-factor), P(-6.0))), P(-factor));
  return select(mean_square < 1e300, judged, P(-0.15));  // else it is infinite or NaN
}

/// How the lengths that the error allows change from step to step. Where they fall, as before a breakaway, they fall
/// on: without this foresight every other step would be rejected (Gustafsson's predictive control).
class Trend {
 public:
  /// The length of the next step, from the one that the error of this step `allowed`.
  double next(double allowed) {
    const double fall = before > 0 ? std::min(1.0, allowed / before) : 1.0;
    before = allowed;
    return allowed * std::max(steepest, fall);
  }

 private:
  static constexpr double steepest = 0.3;
  double before = 0;  ///< what the step before allowed, 0: no step that tells
};
}  // namespace tendonlab::integrate
