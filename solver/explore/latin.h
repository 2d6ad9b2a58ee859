/* Latin hypercubes, and how evenly points are spread. */
#ifndef PNEULAB_EXPLORE_LATIN_H
#define PNEULAB_EXPLORE_LATIN_H

#include <stdint.h>
#include "solver/base/error.h"

/* Square of the centred L2 discrepancy of `count` points x[count][dimension] in [0, 1]^dimension
 * (Hickernell 1998, eq. 5.4): 0 would be perfectly even. Time count^2 dimension. */
double latin_discrepancy(const double *x, int count, int dimension);

/* A Latin hypercube of `count` points x[count][dimension]: in each dimension one point in each of
 * `count` equal cells, in its middle (McKay, Beckman and Conover 1979). Values of pairs of points
 * are then exchanged as long as that lowers the centred discrepancy, with threshold accepting
 * (Fang, Lu, Winker 2003); the effort is bounded by about 6e7 products, and where the discrepancy
 * alone takes more than half of them, nothing is exchanged. The same for the same seed.
 * STATUS_NO_MEMORY. */
enum status latin_hypercube(int count, int dimension, uint64_t seed, double *x,
                            struct error *error);

#endif
