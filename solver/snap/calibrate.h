/* The one number of a job that is changed until a metric has its target. */
#ifndef PNEULAB_SNAP_CALIBRATE_H
#define PNEULAB_SNAP_CALIBRATE_H

#include <stdio.h>
#include "solver/job/snap.h"

enum { CALIBRATE_EVALUATIONS_MAX = 40 };

struct calibrate_result {
  int count;
  double number[CALIBRATE_EVALUATIONS_MAX], metric[CALIBRATE_EVALUATIONS_MAX]; /* SI, as tried */
};

struct calibrate_options {
  double deadline_s; /* on clock_wall_s; 0: none */
  bool (*cancelled)(void *context);
  FILE *progress; /* JSON lines, or NULL */
};

/* Finds the number by Brent's method (1973; GSL) to 1e-5 of the range and leaves the spec with it.
 * STATUS_OK; STATUS_DIVERGED when the metric does not pass its target within the range; or the
 * failure of an evaluation. */
enum status calibrate(struct snap_spec *spec, const struct calibrate_options *options,
                      struct calibrate_result *result, struct error *error);

#endif
