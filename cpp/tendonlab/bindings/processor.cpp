#include "tendonlab/bindings/processor.hpp"

namespace tendonlab::bindings {
const char* lacking_instructions() {
#if defined(TENDONLAB_NEEDS_AVX512)
  const bool has_all = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                       __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                       __builtin_cpu_supports("avx512vl");
  if (!has_all) return "AVX-512; unset TENDONLAB_CORE";
#elif defined(TENDONLAB_NEEDS_AVX2)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma"))
    return "AVX2; build it with -C cmake.define.TENDONLAB_PROCESSOR=x86-64";
#endif
  return nullptr;
}
}  // namespace tendonlab::bindings
