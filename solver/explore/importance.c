#include "solver/explore/importance.h"

#include <gsl/gsl_sort.h>
#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "solver/explore/random.h"

enum { REPEATS = 400 }; /* of the bootstrap */

/* ---- Sobol' indices ----------------------------------------------------------------------- */

/* Which points one estimate uses: all in order, or as many drawn with repetition. */
static void estimate(const double *a, const double *b, const double *const mixed[], int count,
                     int parameters, const int *draw, double *first, double *total) {
  double mean = 0.0, variance = 0.0;
  for (int j = 0; j < count; j++) {
    mean += (a[draw[j]] + b[draw[j]]) / (2.0 * count);
  }
  for (int j = 0; j < count; j++) {
    variance += (pow(a[draw[j]] - mean, 2) + pow(b[draw[j]] - mean, 2)) / (2.0 * count);
  }
  for (int i = 0; i < parameters; i++) {
    double alone = 0.0, all = 0.0;
    for (int j = 0; j < count; j++) {
      int at = draw[j];
      alone += (b[at] - mean) * (mixed[i][at] - a[at]) / count;
      all += pow(a[at] - mixed[i][at], 2) / (2.0 * count);
    }
    first[i] = variance > 0.0 ? alone / variance : 0.0;
    total[i] = variance > 0.0 ? all / variance : 0.0;
  }
}

/* values[REPEATS] are sorted. */
static struct share share_of(double value, double *values) {
  gsl_sort(values, 1, REPEATS);
  return (struct share){value, gsl_stats_quantile_from_sorted_data(values, 1, REPEATS, 0.025),
                        gsl_stats_quantile_from_sorted_data(values, 1, REPEATS, 0.975)};
}

enum status importance_sobol(const double *a, const double *b, const double *const mixed[],
                             int count, int parameters, uint64_t seed,
                             struct importance importance[], struct error *error) {
  size_t width = (size_t)parameters;
  int *draw = malloc((size_t)count * sizeof *draw);
  /* Estimates of all repeats, parameter by parameter, then one more of each. */
  double *first = malloc((REPEATS + 1) * width * sizeof *first);
  double *total = malloc((REPEATS + 1) * width * sizeof *total);
  double *one = malloc(2 * width * sizeof *one);
  uint64_t random = random_mix(seed);
  enum status status = STATUS_OK;
  if (!draw || !first || !total || !one) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the indices");
    goto done;
  }
  for (int repeat = 0; repeat < REPEATS; repeat++) {
    for (int j = 0; j < count; j++) {
      draw[j] = (int)random_below(&random, (uint64_t)count);
    }
    estimate(a, b, mixed, count, parameters, draw, one, one + width);
    for (size_t i = 0; i < width; i++) {
      first[i * REPEATS + (size_t)repeat] = one[i];
      total[i * REPEATS + (size_t)repeat] = one[width + i];
    }
  }
  for (int j = 0; j < count; j++) {
    draw[j] = j;
  }
  estimate(a, b, mixed, count, parameters, draw, one, one + width);
  for (size_t i = 0; i < width; i++) {
    importance[i].first = share_of(one[i], first + i * REPEATS);
    importance[i].total = share_of(one[width + i], total + i * REPEATS);
  }
done:
  free(draw);
  free(first);
  free(total);
  free(one);
  return status;
}

/* ---- pairs -------------------------------------------------------------------------------- */

/* What each point adds to the variance and to the part of it that is of i and k together and of
 * neither alone. A point of the first set whose k comes from the second, and one of the second
 * whose i comes from the first, have i and k in common. */
static void pair_terms(const double *a, const double *b, const double *const mixed[],
                       const double *const back[], int count, int i, int k, double mean,
                       double *term) {
  for (int j = 0; j < count; j++) {
    double p = a[j] - mean, q = b[j] - mean;
    double both = 0.5 * ((mixed[k][j] - mean) * (back[i][j] - mean) +
                         (mixed[i][j] - mean) * (back[k][j] - mean)) -
                  p * q;
    double alone = 0.0;
    alone += 0.5 * (q * (mixed[i][j] - a[j]) + p * (back[i][j] - b[j]));
    alone += 0.5 * (q * (mixed[k][j] - a[j]) + p * (back[k][j] - b[j]));
    term[j] = both - alone;
  }
}

/* The ratio of two sums over all points, and its interval over the draws. */
static struct share ratio_share(const double *term, const double *square, int count,
                                const int *draws, double *values) {
  double above = 0.0, below = 0.0;
  for (int j = 0; j < count; j++) {
    above += term[j];
    below += square[j];
  }
  if (below <= 0.0) {
    return (struct share){0.0, 0.0, 0.0};
  }
  for (int repeat = 0; repeat < REPEATS; repeat++) {
    const int *draw = draws + (size_t)repeat * (size_t)count;
    double sum = 0.0, squares = 0.0;
    for (int j = 0; j < count; j++) {
      sum += term[draw[j]];
      squares += square[draw[j]];
    }
    values[repeat] = squares > 0.0 ? sum / squares : 0.0;
  }
  return share_of(above / below, values);
}

enum status importance_pairs(const double *a, const double *b, const double *const mixed[],
                             const double *const back[], int count, int parameters, uint64_t seed,
                             struct share pair[], struct error *error) {
  size_t n = (size_t)count;
  int *draws = malloc(REPEATS * n * sizeof *draws);
  double *term = malloc(2 * n * sizeof *term), *square = term ? term + n : NULL;
  double *values = malloc(REPEATS * sizeof *values), mean = 0.0;
  uint64_t random = random_mix(seed);
  enum status status = STATUS_OK;
  if (!draws || !term || !values) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the indices");
    goto done;
  }
  for (size_t j = 0; j < REPEATS * n; j++) {
    draws[j] = (int)random_below(&random, n);
  }
  for (int j = 0; j < count; j++) {
    mean += (a[j] + b[j]) / (2.0 * count);
  }
  for (int j = 0; j < count; j++) {
    square[j] = 0.5 * (pow(a[j] - mean, 2) + pow(b[j] - mean, 2));
  }
  for (int i = 0; i < parameters; i++) {
    pair[i * parameters + i] = (struct share){0.0, 0.0, 0.0};
    for (int k = 0; k < i; k++) {
      pair_terms(a, b, mixed, back, count, i, k, mean, term);
      pair[i * parameters + k] = pair[k * parameters + i] =
          ratio_share(term, square, count, draws, values);
    }
  }
done:
  free(draws);
  free(term);
  free(values);
  return status;
}

/* ---- correlation -------------------------------------------------------------------------- */

static double correlate(const double *x, const double *y, size_t count) {
  if (count < 2 || gsl_stats_variance(x, 1, count) <= 0.0 ||
      gsl_stats_variance(y, 1, count) <= 0.0) {
    return 0.0;
  }
  return gsl_stats_correlation(x, 1, y, 1, count);
}

/* rank[i]: place of x[i] among all, equal values sharing the mean of theirs. */
static void rank_values(const double *x, size_t count, size_t *order, double *rank) {
  gsl_sort_index(order, x, 1, count);
  for (size_t from = 0, to; from < count; from = to) {
    for (to = from + 1; to < count && x[order[to]] == x[order[from]]; to++) {
    }
    for (size_t i = from; i < to; i++) {
      rank[order[i]] = 0.5 * (double)(from + to - 1);
    }
  }
}

enum status importance_correlation(const double *x, const double *y, int count, double *linear,
                                   double *rank, struct error *error) {
  size_t n = (size_t)count;
  size_t *order = malloc(n * sizeof *order);
  double *ranks = malloc(2 * n * sizeof *ranks);
  enum status status = STATUS_OK;
  if (n > 0 && (!order || !ranks)) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the correlation");
  } else {
    rank_values(x, n, order, ranks);
    rank_values(y, n, order, ranks + n);
    *linear = correlate(x, y, n);
    *rank = correlate(ranks, ranks + n, n);
  }
  free(order);
  free(ranks);
  return status;
}
