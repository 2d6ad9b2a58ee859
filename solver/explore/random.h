/* Reproducible pseudo-random numbers: the same on every machine, for ever. */
#ifndef PNEULAB_EXPLORE_RANDOM_H
#define PNEULAB_EXPLORE_RANDOM_H

#include <stdint.h>

/* A number that depends on all bits of its argument (finaliser of SplitMix64: Steele, Lea and
 * Flood 2014). */
uint64_t random_mix(uint64_t x);

/* The next number of a generator whose state is *state (SplitMix64). */
uint64_t random_next(uint64_t *state);

/* Uniform in [0, 1). */
double random_uniform(uint64_t *state);

/* Uniform in 0 .. count - 1; count > 0. */
uint64_t random_below(uint64_t *state, uint64_t count);

/* A random order of 0 .. count - 1 (Fisher and Yates 1938). */
void random_permutation(uint64_t *state, int count, int order[]);

#endif
