/* What a simulation of a hybrid model leaves: samples, switches, held steps, warnings. */
#ifndef PNEULAB_HLPV_TRAJECTORY_H
#define PNEULAB_HLPV_TRAJECTORY_H

#include <stdbool.h>
#include <stddef.h>
#include "solver/base/error.h"
#include "solver/job/hlpv.h"

enum { HLPV_EVENTS_MAX = 10000, HLPV_WARNINGS_MAX = 40, HLPV_WARNING_TEXT = 300 };

struct hlpv_sample {
  double time, set_point;
  double x[HLPV_STATES];
  int mode;
};

struct hlpv_event {
  double time;
  int transition; /* of the model */
  double before[HLPV_STATES], after[HLPV_STATES];
  bool grazing; /* its guard is hardly passed: whether it is hangs on the last digits */
};

/* An interval in which the set-point is held. */
struct hlpv_hold {
  double start, end, set_point;
  int mode;     /* at its end */
  int switches; /* in it */
  double first[HLPV_STATES], last[HLPV_STATES];
  /* Elongation and pressure at rest in that mode; NAN where no rest is reached: the coefficients
   * give none, or it lies beyond a guard. */
  double steady_h, steady_pressure;
  double settling; /* from its start until h stays within 2 % of its change about steady_h; NAN */
  double peak_speed;
};

/* Counts of the integration. */
struct hlpv_counts {
  long steps, evaluations, restarts;
};

struct tracking;
struct design;

struct hlpv_trajectory {
  size_t sample_count, event_count, hold_count;
  struct hlpv_sample *sample;
  struct hlpv_event *event;
  struct hlpv_hold *hold;    /* of a held set-point, else none */
  struct tracking *tracking; /* of a position that is controlled, else NULL */
  struct design *design;     /* of its controller */
  double time;               /* reached */
  int mode;
  double x[HLPV_STATES];
  double peak_speed; /* largest |v| */
  double lowest[HLPV_STATES], highest[HLPV_STATES];
  int warning_count;
  char warning[HLPV_WARNINGS_MAX][HLPV_WARNING_TEXT];
  struct hlpv_counts counts;
};

void hlpv_trajectory_release(struct hlpv_trajectory *trajectory);

#endif
