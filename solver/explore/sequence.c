#include "solver/explore/sequence.h"

#include <gsl/gsl_qrng.h>
#include <stdlib.h>

#include "solver/explore/random.h"

enum { SOBOL_BITS = 30 }; /* of the generator of GSL */

struct sequence {
  enum sequence_kind kind;
  int dimension;
  bool scrambled;
  uint64_t seed, index; /* of the next point */
  gsl_qrng *sobol;      /* gives the points after the first, which is 0 */
};

static const int primes[SEQUENCE_DIMENSIONS_MAX] = {
    2,  3,  5,  7,  11, 13,  17,  19,  23,  29,  31,  37,  41,  43,  47,  53,  59,  61,  67,  71,
    73, 79, 83, 89, 97, 101, 103, 107, 109, 113, 127, 131, 137, 139, 149, 151, 157, 163, 167, 173};

enum status sequence_create(enum sequence_kind kind, int dimension, bool scrambled, uint64_t seed,
                            struct sequence **sequence, struct error *error) {
  *sequence = NULL;
  if (dimension < 1 || dimension > SEQUENCE_DIMENSIONS_MAX) {
    return error_set(error, STATUS_TOO_LARGE, NULL, "a sequence has 1 to %d dimensions, not %d",
                     SEQUENCE_DIMENSIONS_MAX, dimension);
  }
  struct sequence *made = calloc(1, sizeof *made);
  if (!made) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a sequence");
  }
  made->kind = kind;
  made->dimension = dimension;
  made->scrambled = scrambled;
  made->seed = seed;
  if (kind == SEQUENCE_SOBOL) {
    made->sobol = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)dimension);
    if (!made->sobol) {
      free(made);
      return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a sequence");
    }
  }
  *sequence = made;
  return STATUS_OK;
}

void sequence_destroy(struct sequence *sequence) {
  if (sequence) {
    if (sequence->sobol) {
      gsl_qrng_free(sequence->sobol);
    }
    free(sequence);
  }
}

/* The place of a digit in the tree of all digits: its dimension, level and what stands before it.
 */
static uint64_t place(const struct sequence *s, int dimension, int level, uint64_t before) {
  return random_mix(random_mix(s->seed + (uint64_t)dimension) + random_mix(before) +
                    (uint64_t)level);
}

/* Flips each bit or not as the bits before it decide; those behind the last one are random. */
static double scramble_bits(const struct sequence *s, int dimension, double x) {
  uint64_t bits = (uint64_t)(x * (double)(UINT64_C(1) << SOBOL_BITS)), out = 0;
  for (int level = 0; level < SOBOL_BITS; level++) {
    uint64_t bit = (bits >> (SOBOL_BITS - 1 - level)) & 1;
    uint64_t before = bits >> (SOBOL_BITS - level);
    out = (out << 1) | (bit ^ (place(s, dimension, level, before) >> 63));
  }
  uint64_t rest = place(s, dimension, SOBOL_BITS, bits) >> (64 - 22);
  return ((double)out + (double)rest * 0x1p-22) / (double)(UINT64_C(1) << SOBOL_BITS);
}

/* Sum of digit_k base^(-k-1); digits permuted as those before them decide, until what is left is
 * below the resolution of a double. */
static double radical_inverse(const struct sequence *s, int dimension, uint64_t index) {
  int base = primes[dimension], order[173];
  uint64_t before = 0;
  double value = 0.0, scale = 1.0 / base;
  for (int level = 0; (index > 0 || s->scrambled) && scale > 0x1p-54; level++, scale /= base) {
    int digit = (int)(index % (uint64_t)base);
    index /= (uint64_t)base;
    if (s->scrambled) {
      uint64_t state = place(s, dimension, level, before);
      random_permutation(&state, base, order);
      before = random_mix(before + (uint64_t)digit + 1);
      digit = order[digit];
    }
    value += digit * scale;
  }
  return value < 1.0 ? value : 0x1.fffffffffffffp-1;
}

void sequence_next(struct sequence *s, double x[]) {
  if (s->kind == SEQUENCE_SOBOL && s->index > 0) {
    gsl_qrng_get(s->sobol, x);
  }
  for (int i = 0; i < s->dimension; i++) {
    if (s->kind == SEQUENCE_HALTON) {
      x[i] = radical_inverse(s, i, s->index);
    } else {
      x[i] = s->index > 0 ? x[i] : 0.0;
      x[i] = s->scrambled ? scramble_bits(s, i, x[i]) : x[i];
    }
  }
  s->index++;
}
