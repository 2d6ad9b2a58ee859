/* What an identification comes to: the model, its switches, and how well it tells the trials. */
#ifndef PNEULAB_IDENTIFY_OUTCOME_H
#define PNEULAB_IDENTIFY_OUTCOME_H

#include "solver/identify/polynomial.h"

/* A guard and its reset as the trials show them. */
struct jump {
  int from, to, direction, count; /* of switches */
  double level, low, high;        /* elongation, and between which it lies */
  double reset[HLPV_STATES], reset_stderror[HLPV_STATES];
};

/* Measured against simulated by the model with its polynomials, of the trials that were used or of
 * those held out; of h and of the pressure. */
struct quality {
  double rmse[2]; /* normalised by the range of each trial */
  double r_squared[2];
  double samples;
};

struct outcome {
  struct polynomial_fit polynomial[HLPV_MODES_MAX][IDENTIFY_COEFFICIENTS];
  bool complete; /* every polynomial exists, so that there is a model */
  struct hlpv_mode mode[HLPV_MODES_MAX];
  int jump_count;
  struct jump jump[HLPV_TRANSITIONS_MAX];
  double *simulated;         /* for each row of each trial h and pressure; NAN where no step is */
  size_t *first;             /* of each trial, its first row in `simulated` */
  struct point_start *start; /* of each step, with covariances */
  bool *has_start;
  struct quality quality[2];  /* trained, held out */
  double correlation[2];      /* of neighbouring residuals of h and pressure at the points */
  double correlation_samples; /* pairs behind it */
};

/* Fills *outcome from an identification that has been estimated; the caller releases it in any
 * case. STATUS_NO_MEMORY. */
enum status outcome_fill(const struct identification *id, struct outcome *outcome,
                         struct error *error);
void outcome_release(struct outcome *outcome);

/* Root mean square of measured less simulated (0: h, 1: pressure) over a trial, and the range of
 * the measured; NAN where nothing is simulated. */
double outcome_trial_rmse(const struct identification *id, const struct outcome *outcome,
                          size_t trial, int quantity, double *range);

#endif
