/* Elimination in a front for the instruction sets it is compiled for. */
#ifndef PNEULAB_FE_LDLT_FRONT_INTERNAL_H
#define PNEULAB_FE_LDLT_FRONT_INTERNAL_H

#include "solver/fe/ldlt_front.h"

enum {
  PANEL = 32, /* columns */
  ROWS = 16   /* of a packed block and of a tile */
};

/* ldlt_front_eliminate with vectors of 512, 256 and 128 bits. */
int ldlt_front_eliminate_512(const struct ldlt_dense *front);
int ldlt_front_eliminate_256(const struct ldlt_dense *front);
int ldlt_front_eliminate_128(const struct ldlt_dense *front);

#endif
