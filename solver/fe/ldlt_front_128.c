/* The elimination for any processor: 4 x 4 in 8 of 16 registers. */
#define LANES 2
#define VECTORS 2
#define SIDE 4
#include "solver/fe/ldlt_front_kernel.h"

int ldlt_front_eliminate_128(const struct ldlt_dense *front) {
  return eliminate(front);
}
