#pragma once
#include "tendonlab/integrate/readings.hpp"

namespace tendonlab::integrate {
/// What a system reads from its inputs, in lanes.
class LaneReadings : public Readings<Lanes> {
 public:
  using Readings<Lanes>::Readings;
  explicit LaneReadings(const Experiment& of) : Readings<Lanes>(of, 0.0, 0.0, 0.0) {}
  /// Every lane reads as `one` does now.
  void follow(const Readings<double>& one) {
    late = one.late, sensor_late = one.sensor_late, bias = one.bias, held = one.held, side = one.side, pull = one.pull;
    follow_pasts([&](int) -> const Readings<double>& { return one; });
    for (std::size_t k = 0; k < from.inputs.size(); ++k)
      if (from.inputs[k].holds) piece[k].fill(one.piece[k]);
    if (from.loop.reference.holds) reference_piece.fill(one.reference_piece);
    if (from.loop.disturbance.holds) disturbance_piece.fill(one.disturbance_piece);
  }
  /// Lane l reads as `one(l)` does now.
  template <class One>
  void follow_each(One one) {
    const auto numbers = [&](auto field)
                             TENDONLAB_ALWAYS { return by_lane<Lanes>([&](int l) { return one(l).*field; }); };
    const auto pieces = [&](auto field) {
      PieceOf<Lanes> all;
      for (std::size_t l = 0; l < all.size(); ++l) all[l] = field(one(static_cast<int>(l)));
      return all;
    };
    using R = Readings<double>;
    late = numbers(&R::late), sensor_late = numbers(&R::sensor_late), bias = numbers(&R::bias);
    held = numbers(&R::held), side = numbers(&R::side), pull = numbers(&R::pull);
    follow_pasts(one);
    for (std::size_t k = 0; k < from.inputs.size(); ++k)
      if (from.inputs[k].holds) piece[k] = pieces([&](const R& of) { return of.piece[k]; });
    if (from.loop.reference.holds) reference_piece = pieces([](const R& of) { return of.reference_piece; });
    if (from.loop.disturbance.holds) disturbance_piece = pieces([](const R& of) { return of.disturbance_piece; });
  }

 private:
  /// A sampled loop reads its past at its ticks, which its own simulation passes.
  template <class One>
  void follow_pasts(One one) {
    remembers = false;
    for (int l = 0; l < Lanes::count && !samples(); ++l) remembers = remembers || one(l).remembers;
    if (remembers) past.follow_each([&](int l) { return one(l).remembers ? &one(l).past : nullptr; });
  }
};
}  // namespace tendonlab::integrate
