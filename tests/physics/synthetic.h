/* Step trials of a hybrid model, made by the matrix exponential, with noise of GSL's generators. */
#ifndef PNEULAB_TESTS_PHYSICS_SYNTHETIC_H
#define PNEULAB_TESTS_PHYSICS_SYNTHETIC_H

#include <stdio.h>
#include "solver/job/hlpv.h"

/* One trial: at rest in a mode at set-point 0 for `before` seconds, then up, then down. */
struct synthetic_run {
  int mode;
  double up, down; /* set-points, Pa */
};

/* When samples are taken: `fast` Hz before the first step of the set-point and for `fast_time`
 * after each (all the time where fast_time is 0), `slow` Hz otherwise. */
struct synthetic_plan {
  double before, hold; /* s at 0, and at each of the two set-points */
  double fast, fast_time, slow;
};

/* Rows of one trial without noise; owned by the caller, to be released. */
struct synthetic_trial {
  size_t count, room;
  double *time, *set_point, *h, *pressure;
};

/* Switches are made as the model says. Aborts without memory. */
void synthetic_make(const struct hlpv_spec *model, const struct synthetic_run *run,
                    const struct synthetic_plan *plan, struct synthetic_trial *trial);
void synthetic_release(struct synthetic_trial *trial);

/* The published protocol: each mode at its set-points in steps of 1 psi, the compressed one to 4
 * psi, the stretched one to 8 psi, `repeats` of each, then back to 0; as runs of the model's modes
 * 0 and 1. Returns their number. */
enum { SYNTHETIC_RUNS_MAX = 64 };
size_t synthetic_protocol(int repeats, struct synthetic_run run[SYNTHETIC_RUNS_MAX]);

/* Range of a column. */
double synthetic_range(const double *value, size_t count);

#endif
