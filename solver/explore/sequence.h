/* Low-discrepancy sequences of points in [0, 1)^d: whoever asks for more points keeps the first
 * ones. */
#ifndef PNEULAB_EXPLORE_SEQUENCE_H
#define PNEULAB_EXPLORE_SEQUENCE_H

#include <stdbool.h>
#include <stdint.h>
#include "solver/base/error.h"

enum { SEQUENCE_DIMENSIONS_MAX = 40 };

enum sequence_kind {
  SEQUENCE_SOBOL, /* Sobol' (1967), direction numbers of Bratley and Fox (1988) */
  SEQUENCE_HALTON /* Halton (1960) in the first primes */
};

struct sequence;

/* Scrambled by nested uniform permutations of the digits (Owen 1995), which depend on the seed
 * alone: the points stay as evenly spread and each is uniformly distributed. Without it the first
 * point is 0. dimension: 1 to SEQUENCE_DIMENSIONS_MAX. The caller owns *sequence.
 * STATUS_TOO_LARGE for another dimension, STATUS_NO_MEMORY. */
enum status sequence_create(enum sequence_kind kind, int dimension, bool scrambled, uint64_t seed,
                            struct sequence **sequence, struct error *error);
void sequence_destroy(struct sequence *sequence);

/* The next point. */
void sequence_next(struct sequence *sequence, double x[]);

#endif
