#pragma once
// Where laws sit, and how they combine: motion, sum of levels, product of factors, sum of forces, memory.
#include "tendonlab/core/law.hpp"

namespace tendonlab {
template <class S>
struct Response {
  S force{}, rate{};
};

/// The laws of one port. `active` has one bit per law: a law that is off is not evaluated, so off means off, bit for
/// bit.
template <class T, class List>
struct Slot {
  using Laws = typename List::template With<T>;
  static constexpr int size = List::count;
  Laws laws;
  unsigned active = 0;

  template <class F, std::size_t... i>
  static constexpr void each_index(std::index_sequence<i...>, F&& f) {
    (f(std::integral_constant<std::size_t, i>{}), ...);
  }
  template <unsigned wanted, class F>
  void each(F&& f) const {
    each_index(
        std::make_index_sequence<size>{}, [&](auto i) __attribute__((always_inline)) {
          using Law = std::tuple_element_t<i, Laws>;
          if constexpr ((Law::roles & wanted) != 0)
            if (active >> i & 1u) f(std::get<i>(laws));
        });
  }
  template <unsigned wanted>
  static constexpr int count() {
    int n = 0;
    List::for_each([&](auto* law) { n += (std::decay_t<decltype(*law)>::roles & wanted) != 0; });
    return n;
  }
  static constexpr unsigned seen() {
    unsigned s = 0;
    List::for_each([&](auto* law) { s |= std::decay_t<decltype(*law)>::sees; });
    return s;
  }
  static constexpr int states = count<role::memory>();
  static_assert(states <= 1, "two memories in a slot need a state each");
  static constexpr unsigned sees = seen();

  bool has(unsigned wanted) const {
    bool found = false;
    each_index(std::make_index_sequence<size>{}, [&](auto i) {
      found = found || ((std::tuple_element_t<i, Laws>::roles & wanted) != 0 && (active >> i & 1u));
    });
    return found;
  }
  /// Does any active law ask for the direction of sliding?
  bool directed() const {
    bool asks = has(role::level | role::factor | role::memory);
    each_index(std::make_index_sequence<size>{}, [&](auto i) {
      asks = asks || ((std::tuple_element_t<i, Laws>::sees & sees_direction) != 0 && (active >> i & 1u));
    });
    return asks;
  }

  /// Dry friction level, a magnitude, at the given sliding.
  template <class S>
  S dry_level(const Sliding<S>& at) const {
    S sum{};
    each<role::level>([&](const auto& law) { sum = sum + law.level(at); });
    each<role::factor>([&](const auto& law) { sum = sum * law.factor(at); });
    return sum;
  }
  /// What can stick: the part of the level that a bristle has not taken over, and what forces that ask for the
  /// direction add along it. Counts at rest.
  template <class S>
  S stick_level(const Sliding<S>& at) const {
    S sum = dry_level(at);
    each<role::memory>([&](const auto& law) { sum = law.dry_share() * sum; });
    each<role::force>([&](const auto& law) {
      if constexpr ((std::decay_t<decltype(law)>::sees & sees_direction) != 0) {
        Sliding<S> still = at;
        still.direction = {};
        sum = sum + at.direction * (law.force(at) - law.force(still));
      }
    });
    return sum;
  }
  /// Half of the gap that the laws of motion leave open, 0 without a gap.
  T half_gap() const {
    T gap(0.0);
    each<role::motion>([&](const auto& law) { gap = gap + law.half_gap(); });
    return gap;
  }
  template <class S>
  TENDONLAB_INLINE Response<S> respond(Sliding<S> at, const S& z) const {
    each<role::motion>([&](const auto& law) { at = law.motion(at); });
    S dry = dry_level(at);
    Response<S> out;
    each<role::force>([&](const auto& law) { out.force = out.force + law.force(at); });
    each<role::memory>([&](const auto& law) {
      out.rate = law.rate(at, dry, z);
      out.force = out.force + law.bristle_force(at, z, out.rate);
      dry = law.dry_share() * dry;
    });
    out.force = out.force + at.direction * dry;
    return out;
  }
};
}  // namespace tendonlab
