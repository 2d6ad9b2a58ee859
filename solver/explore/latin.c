#include "solver/explore/latin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/random.h"

/* Products of factors that the exchanges may cost, how many rounds of lower and lower thresholds
 * they take, and the first threshold as a part of the discrepancy. */
enum { EFFORT = 30000000, ROUNDS = 10 };
#define FIRST_THRESHOLD 1e-2

/* ---- the discrepancy ---------------------------------------------------------------------- */

static double own_factor(double x) {
  double z = fabs(x - 0.5);
  return 1.0 + 0.5 * z - 0.5 * z * z;
}

static double pair_factor(double x, double y) {
  return 1.0 + 0.5 * (fabs(x - 0.5) + fabs(y - 0.5) - fabs(x - y));
}

/* What point i contributes together with the points from `first` on, each pair counted `twice`
 * over: -2/n prod own + 1/n^2 sum prod pair. */
static double own_term(const double *x, int dimension, int i) {
  double product = 1.0;
  for (int k = 0; k < dimension; k++) {
    product *= own_factor(x[i * dimension + k]);
  }
  return product;
}

static double pair_term(const double *x, int dimension, int i, int j) {
  double product = 1.0;
  for (int k = 0; k < dimension; k++) {
    product *= pair_factor(x[i * dimension + k], x[j * dimension + k]);
  }
  return product;
}

double latin_discrepancy(const double *x, int count, int dimension) {
  double own = 0.0, pairs = 0.0, n = count;
  for (int i = 0; i < count; i++) {
    own += own_term(x, dimension, i);
    pairs += pair_term(x, dimension, i, i);
    for (int j = 0; j < i; j++) {
      pairs += 2.0 * pair_term(x, dimension, i, j);
    }
  }
  return pow(13.0 / 12.0, dimension) - 2.0 / n * own + pairs / (n * n);
}

/* The part of the discrepancy that depends on points a and b. */
static double part_of(const double *x, int count, int dimension, int a, int b) {
  double n = count;
  double own = own_term(x, dimension, a) + own_term(x, dimension, b);
  double pairs = pair_term(x, dimension, a, a) + pair_term(x, dimension, b, b) +
                 2.0 * pair_term(x, dimension, a, b);
  for (int j = 0; j < count; j++) {
    if (j != a && j != b) {
      pairs += 2.0 * (pair_term(x, dimension, a, j) + pair_term(x, dimension, b, j));
    }
  }
  return -2.0 / n * own + pairs / (n * n);
}

/* ---- the hypercube ------------------------------------------------------------------------ */

static void swap_values(double *a, double *b) {
  double kept = *a;
  *a = *b;
  *b = kept;
}

/* Exchanges values of two random points in one dimension; keeps it when the discrepancy does not
 * rise by more than the threshold. Returns by how much it rose. */
static double try_exchange(double *x, int count, int dimension, double threshold,
                           uint64_t *random) {
  int k = (int)random_below(random, (uint64_t)dimension);
  int a = (int)random_below(random, (uint64_t)count);
  int b = (int)random_below(random, (uint64_t)count - 1);
  b += b >= a;
  double before = part_of(x, count, dimension, a, b);
  swap_values(&x[a * dimension + k], &x[b * dimension + k]);
  double rise = part_of(x, count, dimension, a, b) - before;
  if (rise > threshold) {
    swap_values(&x[a * dimension + k], &x[b * dimension + k]);
    return 0.0;
  }
  return rise;
}

/* The best of the designs that the exchanges pass through. */
static void exchange(double *x, double *best, int count, int dimension, uint64_t *random) {
  size_t bytes = (size_t)count * (size_t)dimension * sizeof *x;
  double now = latin_discrepancy(x, count, dimension), least = now, first = FIRST_THRESHOLD * now;
  int tries = (int)(EFFORT / ROUNDS / (4.0 * count * dimension));
  memcpy(best, x, bytes);
  for (int round = 0; round < ROUNDS; round++) {
    double threshold = first * (ROUNDS - 1 - round) / ROUNDS / count;
    for (int i = 0; i < tries; i++) {
      now += try_exchange(x, count, dimension, threshold, random);
      if (now < least * (1.0 - 1e-9)) {
        least = now;
        memcpy(best, x, bytes);
      }
    }
    memcpy(x, best, bytes);
    now = least;
  }
}

enum status latin_hypercube(int count, int dimension, uint64_t seed, double *x,
                            struct error *error) {
  uint64_t random = random_mix(seed);
  int *order = malloc((size_t)count * sizeof *order);
  double *best = malloc((size_t)count * (size_t)dimension * sizeof *best);
  if (!order || !best) {
    free(order);
    free(best);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a Latin hypercube");
  }
  for (int k = 0; k < dimension; k++) {
    random_permutation(&random, count, order);
    for (int i = 0; i < count; i++) {
      x[i * dimension + k] = (order[i] + 0.5) / count;
    }
  }
  if (count > 2 && dimension > 1 && (double)count * count * dimension < EFFORT) {
    exchange(x, best, count, dimension, &random);
  }
  free(order);
  free(best);
  return STATUS_OK;
}
