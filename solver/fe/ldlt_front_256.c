/* The elimination for AVX2: 8 x 4 in 8 of 16 registers. */
#define LANES 4
#define VECTORS 2
#define SIDE 4
#include "solver/fe/ldlt_front_kernel.h"

LANES_TARGET_256 int ldlt_front_eliminate_256(const struct ldlt_dense *front) {
  return eliminate(front);
}
