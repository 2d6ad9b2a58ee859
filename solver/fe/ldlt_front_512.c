/* The elimination for AVX-512: 16 x 8 in 16 of 32 registers. */
#define LANES 8
#define VECTORS 2
#define SIDE 8
#include "solver/fe/ldlt_front_kernel.h"

LANES_TARGET_512 int ldlt_front_eliminate_512(const struct ldlt_dense *front) {
  return eliminate(front);
}
