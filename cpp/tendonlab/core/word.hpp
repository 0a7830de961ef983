#pragma once
// What one instruction of the processor works on.
#include <cstdint>

#include "tendonlab/core/real.hpp"

namespace tendonlab {
#if defined(__AVX512F__)
#define TENDONLAB_WORD_BYTES 64
#elif defined(__AVX__)
#define TENDONLAB_WORD_BYTES 32
#else
#define TENDONLAB_WORD_BYTES 16
#endif
using Word = double __attribute__((vector_size(TENDONLAB_WORD_BYTES)));
using WordBits = std::int64_t __attribute__((vector_size(TENDONLAB_WORD_BYTES)));
inline constexpr int word_size = TENDONLAB_WORD_BYTES / static_cast<int>(sizeof(double));
}  // namespace tendonlab
