/* Trials parted into steps: stretches of one held set-point in one mode. */
#ifndef PNEULAB_JOB_STEPS_H
#define PNEULAB_JOB_STEPS_H

#include "solver/job/trials.h"

enum {
  STEP_ROWS_MIN = 5,   /* between two changes of the set-point */
  STEP_ROWS_USED = 12, /* with which a step counts for the coefficients */
  STEP_POINTS_MAX = 400
};

struct step {
  size_t trial, first, count; /* rows of the trial */
  int mode, point;            /* point: -1 where it does not count for coefficients */
  double set_point;           /* Pa, that of its point */
  bool settled;     /* at rest before it, with the mean state `before` of before_count rows */
  double before[2]; /* h, m, and pressure, Pa */
  size_t before_count;
  bool after_switch, before_switch; /* begins or ends with a switch of the mode */
  bool moves;                       /* h or pressure change in it */
};

/* A mode at a set-point, with all steps there. */
struct step_point {
  int mode;
  double set_point;
};

struct steps {
  size_t count, point_count;
  struct step *step;            /* in the order of the trials */
  struct step_point *point;     /* by mode, then set-point */
  double level[HLPV_MODES_MAX]; /* elongations that part the modes */
  double range[2];              /* of h, m, and of the pressure, Pa, over all trials */
};

/* Parts the trials; the caller releases *steps. A row's set-point holds from its time on.
 * Set-points that differ by less than a thousandth of the largest are one. STATUS_INVALID with the
 * pointer and the line: a set-point that is not held (fewer than STEP_ROWS_MIN rows between two
 * changes); a trial in which nothing moves; modes that no elongations part; a mode without a step.
 * STATUS_TOO_LARGE for more than STEP_POINTS_MAX points; STATUS_NO_MEMORY. */
enum status steps_part(const struct identify_spec *spec, const struct trials *trials,
                       struct steps *steps, struct error *error);
void steps_release(struct steps *steps);

#endif
