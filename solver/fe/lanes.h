/* Several numbers at once, for kernels that are compiled for several instruction sets. Such a
 * kernel defines LANES before including this. Vectors are passed by pointer only, since how they
 * are passed by value depends on the set. */
#ifndef PNEULAB_FE_LANES_H
#define PNEULAB_FE_LANES_H

#include <stdbool.h>

#ifdef __x86_64__
#define LANES_TARGET_512 __attribute__((target("avx512f,avx512vl,avx512dq,avx2,fma")))
#define LANES_TARGET_256 __attribute__((target("avx2,fma")))
#else
#define LANES_TARGET_512
#define LANES_TARGET_256
#endif

/* The parts of a kernel get its instruction set by becoming one with it. Under a sanitizer that
 * would take the compiler minutes: there they are functions for the set, with the loops over their
 * few lanes unrolled, whatever the rest is compiled with. */
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define LANES_INLINE static inline __attribute__((always_inline))
#else
#define LANES_ALONE static __attribute__((noinline, unused, optimize("O3")))
#if defined(LANES) && LANES == 8
#define LANES_INLINE LANES_TARGET_512 LANES_ALONE
#elif defined(LANES) && LANES == 4
#define LANES_INLINE LANES_TARGET_256 LANES_ALONE
#else
#define LANES_INLINE LANES_ALONE
#endif
#endif

#ifdef LANES
/* Aligned like one double. */
typedef double lanes __attribute__((vector_size(LANES * sizeof(double)), aligned(8)));
typedef unsigned long long lanes_bits
    __attribute__((vector_size(LANES * sizeof(double)), aligned(8)));
#endif

#ifdef __x86_64__

/* Bits of the vectors that this processor has: 512, 256 or 128. */
LANES_INLINE int lanes_width(void) {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq")) {
    return 512;
  }
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? 256 : 128;
}

#else

LANES_INLINE int lanes_width(void) {
  return 128;
}

#endif

#endif
