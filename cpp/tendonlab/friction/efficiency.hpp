#pragma once
#include "tendonlab/core/law.hpp"

namespace tendonlab::friction {
/// Gear efficiency: dry friction in proportion to the torque that is passed on, driving or driven back.
///
///   g = l |F_load|  while driving (s F_load >= 0),   g = r l |F_load|  while driven back          (S1 eqs 9, 10)
///
/// F_load: torque given to the output, N·m (N). s: direction of the output. g: its share of the dry level, N·m (N),
/// felt at the input times the ratio. l = 1/eta - 1 with the driving efficiency eta; r = 1: the same loss both ways, so
/// that the efficiency driven back is 2 - 1/eta; r l >= 1: the gear locks. l = 0 switches it off. No memory.
template <class T>
struct Efficiency {
  static constexpr std::string_view name = "efficiency", noun = "power-proportional loss", source = "S1 eqs 9, 10",
                                    equation = "l |F_load| sgn(v), times r where v F_load < 0",
                                    summary = "gear efficiency: loss in proportion to the power passed on";
  static constexpr unsigned roles = role::level, sees = sees_load;
  T loss, back_driven;

  static constexpr auto parameters() {
    return std::tuple{parameter(&Efficiency::loss, "efficiency_loss", Dimension::ratio, Purpose::amplitude, 0.1, 0.0,
                                1.0, "loss per power passed on while driving, 1/efficiency - 1"),
                      parameter(&Efficiency::back_driven, "back_driven_loss", Dimension::ratio, Purpose::shape, 1.0,
                                0.0, inf, "loss while driven back over that while driving")};
  }
  template <class S>
  S level(const Sliding<S>& at) const {
    const auto share = select(plain(at.load) * at.direction >= 0.0, loss, T(loss * back_driven));
    return share * abs(at.load);
  }
};
}  // namespace tendonlab::friction
