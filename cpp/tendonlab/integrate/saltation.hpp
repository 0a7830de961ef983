#pragma once
// Derivatives across an event: time stays plain, and where the rate jumps the state's derivative jumps by
// (rate before - rate after) dt/dp. For plain scalars this is nothing.
#include "tendonlab/integrate/contact.hpp"

namespace tendonlab::integrate {
template <class System, class T>
class Jump {
  static constexpr int n = System::dof, nz = memories<System>;

 public:
  /// Before the modes change: how the instant of the event moves with the parameters. mode -1: a jump of the inputs;
  /// `toward`: the side on which a gap is left.
  template <class Simulation>
  Jump(const Simulation& s, int mode, double toward) : happens(mode >= 0 || varies(s.drive.moves_at(s.t))) {
    if constexpr (!std::is_same_v<T, double>) {
      if (!happens) return;
      before = s.plain_rate();
      if (mode < 0)
        moves = s.drive.moves_at(s.t);  // delays are parameters, which move the jump
      else
        moves = of_guard(s, mode, toward);
    } else {
      static_cast<void>(s), static_cast<void>(mode), static_cast<void>(toward);
    }
  }
  template <class Simulation>
  void apply(Simulation& s) const {
    if constexpr (!std::is_same_v<T, double>) {
      if (!happens) return;
      const auto after = s.plain_rate();
      for (std::size_t j = 0; j < n; ++j) shift(s.y.at.velocity[j], before.acceleration[j] - after.acceleration[j]);
      for (std::size_t i = 0; i < nz; ++i) shift(s.y.memory[i], before.memory[i] - after.memory[i]);
    } else {
      static_cast<void>(s);
    }
  }

 private:
  void shift(T& x, double jump) const { x.d = x.d + (jump * moves).d; }
  /// dt/dp = -g_p / g_t of the guard g whose root the event is; its value is of no interest.
  template <class Simulation>
  T of_guard(const Simulation& s, int mode, double toward) const {
    const double change = mode < modes<System> ? s.guard_rate(mode, before) : 0.0;
    if (mode < System::directions) {
      if (s.frame.mode[static_cast<std::size_t>(mode)] == 0.0) return T(0.0);  // a release: the rate is continuous
      return quotient(s.contact.sliding_velocity(mode, s.y, s.frame, s.drive), change);
    }
    if (mode >= modes<System>) return T(0.0);  // saturation: the rate is continuous
    const double flank = s.frame.mode[static_cast<std::size_t>(mode)], side = flank == 0.0 ? toward : flank;
    return quotient(s.contact.stretch(mode, s.y, s.frame, s.drive) - side * s.contact.half_gap(mode), change);
  }
  static T quotient(const T& guard, double rate) { return rate == 0.0 ? T(0.0) : (-1.0 / rate) * guard; }

  bool happens;  ///< most inputs jump at instants that no parameter moves
  Rate<double, n, nz> before;
  T moves{};
};
}  // namespace tendonlab::integrate
