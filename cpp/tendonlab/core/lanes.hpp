#pragma once
// Numbers that go through the same operations side by side: simulations, instants of one, ports that are alike. As many
// words as the processor needs for them, so that a program and its results look the same on each.
#include "tendonlab/core/word.hpp"

namespace tendonlab {
/// What a comparison of packs gives: all bits of a lane or none.
template <int size>
struct PackMask {
  static constexpr int word_size = size < widest_word ? size : widest_word, words = size / word_size;
  typename WordOf<word_size>::Bits word[words];
};
/// A pack (or a mask) of which f(i) gives word i. Written out: loops would keep packs in memory.
template <class Packed, class F>
TENDONLAB_INLINE Packed by_words(F f) {
  static_assert(Packed::words == 1 || Packed::words == 2 || Packed::words == 4);
  Packed out;
  out.word[0] = f(0);
  if constexpr (Packed::words > 1) out.word[1] = f(1);
  if constexpr (Packed::words > 2) out.word[2] = f(2), out.word[3] = f(3);
  return out;
}
template <int size>
struct Pack {
  using Mask = PackMask<size>;
  static constexpr int count = size, word_size = Mask::word_size, words = Mask::words;
  using Reals = typename WordOf<word_size>::Reals;
  Reals word[words];

  Pack() : word{} {}
  Pack(double a) : Pack(by_words<Pack>([&](int) TENDONLAB_ALWAYS { return Reals{} + a; })) {}
  /// The numbers from `first` on, and back.
  explicit Pack(const double* first) { std::memcpy(word, first, sizeof word); }
  void store(double* first) const { std::memcpy(first, word, sizeof word); }
  double operator[](int lane) const { return word[lane / word_size][lane % word_size]; }
  void set(int lane, double a) { word[lane / word_size][lane % word_size] = a; }
};
/// Eight simulations, or eight instants.
using Lanes = Pack<8>;
template <class T>
inline constexpr bool in_lanes = std::is_same_v<T, Lanes>;

/// A pack of which f(l) gives lane l. Written out, so that they come together in registers.
template <class Packed, class F>
TENDONLAB_INLINE Packed by_lane(F f) {
  return by_words<Packed>([&](int i) __attribute__((always_inline)) {
    const int l = i * Packed::word_size;
    using Reals = typename Packed::Reals;
    if constexpr (Packed::word_size == 8)
      return Reals{f(l), f(l + 1), f(l + 2), f(l + 3), f(l + 4), f(l + 5), f(l + 6), f(l + 7)};
    else if constexpr (Packed::word_size == 4)
      return Reals{f(l), f(l + 1), f(l + 2), f(l + 3)};
    else
      return Reals{f(l), f(l + 1)};
  });
}
#define TENDONLAB_PACK(Result) \
  template <int size>          \
  TENDONLAB_INLINE Result<size>
#define TENDONLAB_LANES(op)                                                                      \
  TENDONLAB_PACK(Pack) operator op(const Pack<size>& a, const Pack<size>& b) {                   \
    return by_words<Pack<size>>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op b.word[i]; }); \
  }                                                                                              \
  TENDONLAB_PACK(Pack) operator op(double a, const Pack<size>& b) {                              \
    return by_words<Pack<size>>([&](int i) TENDONLAB_ALWAYS { return a op b.word[i]; });         \
  }                                                                                              \
  TENDONLAB_PACK(Pack) operator op(const Pack<size>& a, double b) {                              \
    return by_words<Pack<size>>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op b; });         \
  }
#define TENDONLAB_MASK(op)                                                                           \
  TENDONLAB_PACK(PackMask) operator op(const Pack<size>& a, const Pack<size>& b) {                   \
    return by_words<PackMask<size>>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op b.word[i]; }); \
  }                                                                                                  \
  TENDONLAB_PACK(PackMask) operator op(const Pack<size>& a, double b) {                              \
    return a op Pack<size>(b);                                                                       \
  }

TENDONLAB_LANES(+)
TENDONLAB_LANES(-)
TENDONLAB_LANES(*)
TENDONLAB_LANES(/)
TENDONLAB_MASK(<)
TENDONLAB_MASK(<=)
TENDONLAB_MASK(>)
TENDONLAB_MASK(>=)
TENDONLAB_MASK(==)
TENDONLAB_MASK(!=)
#undef TENDONLAB_MASK
#undef TENDONLAB_LANES
TENDONLAB_PACK(Pack) operator-(const Pack<size>& a) {
  return by_words<Pack<size>>([&](int i) TENDONLAB_ALWAYS { return -a.word[i]; });
}
/// Does a condition hold in any lane?
template <int size>
TENDONLAB_INLINE bool any(const PackMask<size>& m) {
  auto found = m.word[0];
  for (int i = 1; i < PackMask<size>::words; ++i) found |= m.word[i];
  return any_bit(found);
}
template <int size>
TENDONLAB_INLINE PackMask<size> operator|(const PackMask<size>& a, const PackMask<size>& b) {
  return by_words<PackMask<size>>([&](int i) TENDONLAB_ALWAYS { return a.word[i] | b.word[i]; });
}
/// A bit for each lane in which a condition holds.
template <int size>
TENDONLAB_INLINE unsigned bits_of(const PackMask<size>& m) {
  unsigned bits = 0;
  for (int i = 0; i < PackMask<size>::words; ++i) bits |= sign_bits(m.word[i]) << (i * PackMask<size>::word_size);
  return bits;
}
TENDONLAB_PACK(Pack) select(const PackMask<size>& m, const Pack<size>& a, const Pack<size>& b) {
  return by_words<Pack<size>>([&](int i) TENDONLAB_ALWAYS { return m.word[i] ? a.word[i] : b.word[i]; });
}
TENDONLAB_PACK(Pack) select(const PackMask<size>& m, const Pack<size>& a, double b) {
  return select(m, a, Pack<size>(b));
}
TENDONLAB_PACK(Pack) select(const PackMask<size>& m, double a, double b) {
  return select(m, Pack<size>(a), Pack<size>(b));
}
TENDONLAB_PACK(Pack) select(bool m, const Pack<size>& a, const Pack<size>& b) {
  return m ? a : b;
}
TENDONLAB_PACK(Pack) abs(const Pack<size>& a) {
  return select(a < 0.0, -a, a);
}
template <int size>
inline const Pack<size>& plain(const Pack<size>& a) {
  return a;
}
template <int size>
inline bool varies(const Pack<size>&) {
  return false;
}

TENDONLAB_PACK(Pack) exp(const Pack<size>& a) {
  using P = Pack<size>;
  using Bits = typename WordOf<P::word_size>::Bits;
  return by_words<P>([&](int i) TENDONLAB_ALWAYS { return exp_of<typename P::Reals, Bits>(a.word[i]); });
}
TENDONLAB_PACK(Pack) roughly_power(const Pack<size>& a, double exponent) {
  using P = Pack<size>;
  using Bits = typename WordOf<P::word_size>::Bits;
  return by_words<P>([&](int i)
                         TENDONLAB_ALWAYS { return roughly_power_of<typename P::Reals, Bits>(a.word[i], exponent); });
}
TENDONLAB_PACK(Pack) sin(const Pack<size>& a) {
  return turn_sine(a * inverse_turn);
}
TENDONLAB_PACK(Pack) cos(const Pack<size>& a) {
  return turn_sine(a * inverse_turn + 0.25);
}
TENDONLAB_PACK(Pack) sqrt(const Pack<size>& a) {
  return by_lane<Pack<size>>([&](int l) __attribute__((always_inline)) { return __builtin_sqrt(a[l]); });
}
TENDONLAB_PACK(Pack) log(const Pack<size>& a) {
  return by_lane<Pack<size>>([&](int l) { return log(a[l]); });
}
TENDONLAB_PACK(Pack) tanh(const Pack<size>& a) {
  return by_lane<Pack<size>>([&](int l) { return tanh(a[l]); });
}
TENDONLAB_PACK(Pack) atan(const Pack<size>& a) {
  return by_lane<Pack<size>>([&](int l) { return atan(a[l]); });
}
TENDONLAB_PACK(Pack) expm1(const Pack<size>& a) {
  return by_lane<Pack<size>>([&](int l) { return expm1(a[l]); });
}
#undef TENDONLAB_PACK
}  // namespace tendonlab
