#pragma once
// Eight numbers that go through the same operations: eight simulations, or eight instants of one. As many words as the
// processor needs for them, so that a program and its results look the same on each.
#include "tendonlab/core/word.hpp"

namespace tendonlab {
/// What a comparison of lanes gives: all bits of a lane or none.
struct Mask {
  static constexpr int words = 8 / word_size;
  WordBits word[words];
};
struct Lanes {
  static constexpr int count = 8, words = count / word_size;
  Word word[words];

  Lanes() : word{} {}
  Lanes(double a) {
    for (Word& w : word) w = Word{} + a;
  }
  /// The eight numbers from `first` on, and back.
  explicit Lanes(const double* first) { std::memcpy(word, first, sizeof word); }
  void store(double* first) const { std::memcpy(first, word, sizeof word); }
  double operator[](int lane) const { return word[lane / word_size][lane % word_size]; }
  void set(int lane, double a) { word[lane / word_size][lane % word_size] = a; }
};
template <class T>
inline constexpr bool in_lanes = std::is_same_v<T, Lanes>;

/// Lanes (or a Mask) of which f(i) gives word i.
template <class Packed, class F>
TENDONLAB_INLINE Packed by_words(F f) {
  Packed out;
  for (int i = 0; i < Packed::words; ++i) out.word[i] = f(i);
  return out;
}
/// Lanes of which f(l) gives lane l. Written out, so that they come together in registers.
template <class F>
TENDONLAB_INLINE Lanes by_lane(F f) {
  return by_words<Lanes>([&](int i) __attribute__((always_inline)) {
    const int l = i * word_size;
    if constexpr (word_size == 8)
      return Word{f(l), f(l + 1), f(l + 2), f(l + 3), f(l + 4), f(l + 5), f(l + 6), f(l + 7)};
    else if constexpr (word_size == 4)
      return Word{f(l), f(l + 1), f(l + 2), f(l + 3)};
    else
      return Word{f(l), f(l + 1)};
  });
}
#define TENDONLAB_LANES(op)                                                                 \
  TENDONLAB_INLINE Lanes operator op(const Lanes& a, const Lanes& b) {                      \
    return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op b.word[i]; }); \
  }                                                                                         \
  TENDONLAB_INLINE Lanes operator op(double a, const Lanes& b) {                            \
    return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return a op b.word[i]; });         \
  }                                                                                         \
  TENDONLAB_INLINE Lanes operator op(const Lanes& a, double b) {                            \
    return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op b; });         \
  }
#define TENDONLAB_MASK(op)                                                                   \
  TENDONLAB_INLINE Mask operator op(const Lanes& a, const Lanes& b) {                        \
    return by_words<Mask>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op b.word[i]; });   \
  }                                                                                          \
  TENDONLAB_INLINE Mask operator op(const Lanes& a, double b) {                              \
    return by_words<Mask>([&](int i) TENDONLAB_ALWAYS { return a.word[i] op(Word{} + b); }); \
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
#undef TENDONLAB_MASK
#undef TENDONLAB_LANES
TENDONLAB_INLINE Lanes operator-(const Lanes& a) {
  return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return -a.word[i]; });
}
/// Does a condition hold in any lane?
inline bool any(const Mask& m) {
  bool found = false;
  for (const WordBits& w : m.word)
    for (int k = 0; k < word_size; ++k) found = found || w[k] != 0;
  return found;
}
TENDONLAB_INLINE Lanes select(const Mask& m, const Lanes& a, const Lanes& b) {
  return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return m.word[i] ? a.word[i] : b.word[i]; });
}
TENDONLAB_INLINE Lanes select(bool m, const Lanes& a, const Lanes& b) {
  return m ? a : b;
}
TENDONLAB_INLINE Lanes abs(const Lanes& a) {
  return select(a < 0.0, -a, a);
}
inline const Lanes& plain(const Lanes& a) {
  return a;
}
inline bool varies(const Lanes&) {
  return false;
}

TENDONLAB_INLINE Lanes exp(const Lanes& a) {
  return by_words<Lanes>([&](int i) TENDONLAB_ALWAYS { return exp_of<Word, WordBits>(a.word[i]); });
}
TENDONLAB_INLINE Lanes sin(const Lanes& a) {
  return turn_sine(a * inverse_turn);
}
TENDONLAB_INLINE Lanes cos(const Lanes& a) {
  return turn_sine(a * inverse_turn + 0.25);
}
TENDONLAB_INLINE Lanes sqrt(const Lanes& a) {
  return by_lane([&](int l) __attribute__((always_inline)) { return __builtin_sqrt(a[l]); });
}
inline Lanes log(const Lanes& a) {
  return by_lane([&](int l) { return log(a[l]); });
}
inline Lanes tanh(const Lanes& a) {
  return by_lane([&](int l) { return tanh(a[l]); });
}
inline Lanes atan(const Lanes& a) {
  return by_lane([&](int l) { return atan(a[l]); });
}
inline Lanes expm1(const Lanes& a) {
  return by_lane([&](int l) { return expm1(a[l]); });
}
}  // namespace tendonlab
