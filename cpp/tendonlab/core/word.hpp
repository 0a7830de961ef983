#pragma once
// What one instruction of the processor works on.
#include <cstdint>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "tendonlab/core/real.hpp"

namespace tendonlab {
#if defined(__AVX512DQ__)
inline constexpr int widest_word = 8;
#elif defined(__AVX__)
inline constexpr int widest_word = 4;
#else
inline constexpr int widest_word = 2;
#endif
/// A vector of `size` doubles in one register, and of integers of their size.
template <int size>
struct WordOf;
#define TENDONLAB_WORD(size)                                                       \
  template <>                                                                      \
  struct WordOf<size> {                                                            \
    using Reals = double __attribute__((vector_size(size * sizeof(double))));      \
    using Bits = std::int64_t __attribute__((vector_size(size * sizeof(double)))); \
  };
TENDONLAB_WORD(2)
TENDONLAB_WORD(4)
TENDONLAB_WORD(8)
#undef TENDONLAB_WORD
using Word = WordOf<widest_word>::Reals;

/// Is any bit set, and the sign bit of each number.
#if defined(__AVX512DQ__)
TENDONLAB_INLINE bool any_bit(const WordOf<8>::Bits& w) {
  return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(w), reinterpret_cast<__m512i>(w)) != 0;
}
TENDONLAB_INLINE unsigned sign_bits(const WordOf<8>::Bits& w) {
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(w));
}
#endif
#if defined(__AVX__)
TENDONLAB_INLINE bool any_bit(const WordOf<4>::Bits& w) {
  return _mm256_testz_si256(reinterpret_cast<__m256i>(w), reinterpret_cast<__m256i>(w)) == 0;
}
TENDONLAB_INLINE unsigned sign_bits(const WordOf<4>::Bits& w) {
  return static_cast<unsigned>(_mm256_movemask_pd(reinterpret_cast<__m256d>(w)));
}
#endif
TENDONLAB_INLINE bool any_bit(const WordOf<2>::Bits& w) {
  return (w[0] | w[1]) != 0;
}
TENDONLAB_INLINE unsigned sign_bits(const WordOf<2>::Bits& w) {
  return (w[0] < 0 ? 1u : 0u) | (w[1] < 0 ? 2u : 0u);
}
}  // namespace tendonlab
