/* Gaussian-process surrogate of one quantity over the design parameters: what a design would give,
 * with an error bar, from designs that were solved (Rasmussen and Williams 2006; equations below
 * are theirs).
 *
 * y(x) = mean + f(x) + noise, with the covariance of f of Matern's class with nu = 5/2 and a length
 * for each parameter; scale, lengths and noise maximise the likelihood of what is known. */
#ifndef PNEULAB_EXPLORE_SURROGATE_H
#define PNEULAB_EXPLORE_SURROGATE_H

#include <stdint.h>
#include "solver/base/error.h"

enum {
  SURROGATE_PARAMETERS_MAX = 32,
  SURROGATE_POINTS_MAX = 4000, /* its matrix takes 128 MB then */
  SURROGATE_FIT_MAX = 400,     /* of which so many, chosen at random, determine the lengths */
  SURROGATE_START_MAX = 200    /* and so many where to search for them */
};

struct surrogate;

/* What it was found to be and how well it predicts. */
struct surrogate_fit {
  double mean;                             /* unit of y */
  double deviation;                        /* of f, unit of y */
  double length[SURROGATE_PARAMETERS_MAX]; /* as parts of the range of the parameter */
  double noise;                            /* standard deviation, unit of y */
  double log_likelihood;                   /* eq. 2.30, of y divided by its standard deviation */
  double left_out_r2;     /* 1 - sum (y - predicted)^2 / sum (y - mean)^2, each point predicted
                             without itself (eq. 5.12) */
  double left_out_within; /* part of the points within 1.96 of their predicted deviation */
};

/* Fits x[count][parameters] in any units and y[count]. `seed` starts the search for the lengths.
 * The caller owns *surrogate. STATUS_INVALID with fewer than 4 points, or a value that is not
 * finite; STATUS_TOO_LARGE; STATUS_DIVERGED where no lengths give a covariance that can be
 * factored; STATUS_NO_MEMORY. */
enum status surrogate_create(const double *x, const double *y, int count, int parameters,
                             uint64_t seed, struct surrogate **surrogate, struct error *error);
void surrogate_destroy(struct surrogate *surrogate);

const struct surrogate_fit *surrogate_fit(const struct surrogate *surrogate);

/* The value expected at x[parameters] and, unless NULL, its standard deviation, of f alone, without
 * the noise (eq. 2.25 and 2.26). Time count^2, without the deviation count. */
void surrogate_predict(const struct surrogate *surrogate, const double x[], double *value,
                       double *deviation);

/* Each known point predicted without itself: value[count] and deviation[count], the latter with the
 * noise (eq. 5.12). */
void surrogate_leave_one_out(const struct surrogate *surrogate, double value[], double deviation[]);

#endif
