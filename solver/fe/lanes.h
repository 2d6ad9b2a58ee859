/* Several numbers at once, for kernels that are compiled for several instruction sets. Such a
 * kernel defines LANES before including this. Vectors are passed by pointer only, since how they
 * are passed by value depends on the set. */
#ifndef PNEULAB_FE_LANES_H
#define PNEULAB_FE_LANES_H

#include <stdbool.h>

/* The parts of a kernel get its instruction set by becoming one with it. Under a sanitizer that
 * would take the compiler minutes: there they are functions for any processor. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define LANES_INLINE static __attribute__((noinline, unused))
#else
#define LANES_INLINE static inline __attribute__((always_inline))
#endif

#ifdef LANES
/* Aligned like one double. */
typedef double lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(8)));
typedef unsigned long long lanes_bits
    __attribute__((vector_size(LANES * sizeof(double)), aligned(8)));
#endif

#ifdef __x86_64__

#define LANES_TARGET_512 __attribute__((target("avx512f,avx512vl,avx512dq,avx2,fma")))
#define LANES_TARGET_256 __attribute__((target("avx2,fma")))

/* Bits of the vectors that this processor has: 512, 256 or 128. */
LANES_INLINE int lanes_width(void) {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    return 512;
  }
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? 256 : 128;
}

#else

#define LANES_TARGET_512
#define LANES_TARGET_256

LANES_INLINE int lanes_width(void) {
  return 128;
}

#endif

#endif
