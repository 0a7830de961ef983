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
  static constexpr bool asks_if_mirrored() {
    bool asks = false;
    List::for_each([&](auto* law) { asks = asks || tendonlab::asks_if_mirrored<std::decay_t<decltype(*law)>>; });
    return asks;
  }
  static constexpr int gaps() {
    int n = 0;
    List::for_each([&](auto* law) { n += opens_gap<std::decay_t<decltype(*law)>>; });
    return n;
  }
  static_assert(count<role::signal>() == 0, "a law of a signal in a slot: its place is a chain");
  static_assert(gaps() <= 1, "two gaps in a slot need a mode each");
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

  /// What is left of a motion behind the laws that change it. A law changes the part of the port that it knows.
  template <class Port>
  TENDONLAB_INLINE Port moved(Port at) const {
    each<role::motion>([&](const auto& law) {
      using Known = decltype(law.motion(at));
      static_cast<Known&>(at) = law.motion(at);
    });
    return at;
  }
  /// Dry friction level, a magnitude, at the given sliding.
  template <class Port, class S = typename Port::Scalar>
  S dry_level(const Port& at) const {
    S sum{};
    each<role::level>([&](const auto& law) { sum = sum + law.level(at); });
    each<role::factor>([&](const auto& law) { sum = sum * law.factor(at); });
    return sum;
  }
  /// What can stick: the part of the level that a bristle has not taken over, and what forces that ask for the
  /// direction add along it. Counts at rest.
  template <class Port, class S = typename Port::Scalar>
  S stick_level(const Port& at) const {
    S sum = left_to_slide(dry_level(at));
    each<role::force>([&](const auto& law) {
      if constexpr ((std::decay_t<decltype(law)>::sees & sees_direction) != 0) {
        Port still = at;
        still.direction = {};
        sum = sum + at.direction * (law.force(at) - law.force(still));
      }
    });
    return sum;
  }
  /// Is a gap open to the motion, and half of its width, 0 without one.
  bool gapped() const {
    bool open = false;
    each<role::motion>([&](const auto& law) { open = open || opens_gap<std::decay_t<decltype(law)>>; });
    return open;
  }
  T half_gap() const {
    T gap(0.0);
    each<role::motion>([&](const auto& law) {
      if constexpr (opens_gap<std::decay_t<decltype(law)>>) gap = law.half_gap();
    });
    return gap;
  }
  /// The part of the dry friction that no memory takes over.
  template <class S>
  S left_to_slide(S dry) const {
    each<role::memory>([&](const auto& law) {
      if constexpr (takes_over_dry_friction<std::decay_t<decltype(law)>>) dry = law.dry_share() * dry;
    });
    return dry;
  }
  /// Fields of a port that the laws look at.
  static constexpr int num_seen = [] {
    int n = 0;
    Sliding<double>::for_each_field([&](std::string_view, unsigned bit, auto) { n += (sees & bit) != 0; });
    return n;
  }();
  /// The port in Duals of what the laws look at, then of the state; `source` names the quantities that stand for it.
  template <class D>
  TENDONLAB_INLINE auto by_fields(const Sliding<D>& at, const D* (&source)[num_seen + 1]) const {
    using L = Dual<typename UnderOf<D>::type, num_seen + states>;
    Sliding<L> own;
    own.direction = at.direction, own.side = at.side;
    int k = 0;
    Sliding<D>::for_each_field([&](std::string_view, unsigned bit, auto access) __attribute__((always_inline)) {
      if ((sees & bit) == 0) return;
      access(own) = variable<L>(access(at).value, k);
      source[k++] = &access(at);
    });
    return own;
  }
  template <class Port, class S = typename Port::Scalar>
  TENDONLAB_INLINE Response<S> respond(const Port& at, const S& z) const {
    if constexpr (std::is_same_v<Port, Sliding<S>> && states == 0 && num_seen > 0 && (partials < S >> num_seen)) {
      if (active == 0) return {};
      const S* source[num_seen + 1];
      const auto own = by_fields(at, source);
      const auto by_field = respond_at(own, lift<std::decay_t<decltype(own.velocity)>>(z.value)).force;
      S force = chain(by_field.value, by_field.d[0], *source[0]);
      for (std::size_t k = 1; k < num_seen; ++k)
        for (std::size_t q = 0; q < force.d.size(); ++q) force.d[q] = force.d[q] + by_field.d[k] * source[k]->d[q];
      return {force, {}};
    } else {
      return respond_at(at, z);
    }
  }

 private:
  template <class Port, class S = typename Port::Scalar>
  TENDONLAB_INLINE Response<S> respond_at(const Port& seen, const S& z) const {
    if constexpr (count<role::motion>() == 0)
      return respond_behind(seen, z);
    else
      return respond_behind(moved(seen), z);
  }
  /// To a motion behind the laws that change it.
  template <class Port, class S = typename Port::Scalar>
  TENDONLAB_INLINE Response<S> respond_behind(const Port& at, const S& z) const {
    const S dry = dry_level(at);
    Response<S> out;
    each<role::force>([&](const auto& law) { out.force = out.force + law.force(at); });
    each<role::memory>([&](const auto& law) {
      out.rate = law.state_rate(at, dry, z);
      out.force = out.force + law.state_force(at, z, out.rate);
    });
    out.force = out.force + at.direction * left_to_slide(dry);
    return out;
  }
};
/// One slot with the laws of both, those of `a` first.
template <class T, class A, class B>
Slot<T, typename Joined<A, B>::type> joined(const Slot<T, A>& a, const Slot<T, B>& b) {
  return {std::tuple_cat(a.laws, b.laws), a.active | b.active << A::count};
}
}  // namespace tendonlab
