/* Gathers the trajectory while a simulation goes on. */
#ifndef PNEULAB_HLPV_RECORD_H
#define PNEULAB_HLPV_RECORD_H

#include "solver/hlpv/trajectory.h"

/* A state with its derivative. */
struct hlpv_point {
  double time;
  double x[HLPV_STATES], rate[HLPV_STATES];
};

enum hlpv_remark { REMARK_RANGE, REMARK_STIFFNESS, REMARK_DAMPING, REMARK_PRESSURE, REMARK_COUNT };

struct tracking;

struct recorder {
  const struct hlpv_spec *spec;
  struct hlpv_trajectory *out;
  bool no_samples;
  struct tracking *tracking; /* of a position that is controlled, or NULL */
  size_t sample_room, event_room;
  double small[HLPV_STATES]; /* differences that decide nothing: see hlpv_event.grazing */
  bool holding;              /* the last hold goes on */
  bool told[HLPV_MODES_MAX][REMARK_COUNT];
  double outside; /* last time in it outside the band of its steady state */
};

/* Reserves room. STATUS_NO_MEMORY. */
enum status recorder_open(struct recorder *recorder, struct error *error);

/* Adds a warning unless there are too many. */
void recorder_warn(struct recorder *recorder, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* State i on the way between two states of one mode, at the part s of their time: the cubic through
 * values and derivatives at both ends. */
double recorder_between(const struct hlpv_point *a, const struct hlpv_point *b, int i, double s);

/* The time of the next sample, infinite behind the last. */
double recorder_next(const struct recorder *recorder);
/* Adds the sample due next, under that set-point. */
void recorder_sample(struct recorder *recorder, int mode, double set_point,
                     const double x[HLPV_STATES]);

/* Takes in the way between two states of one mode, for extremes and settling. */
void recorder_span(struct recorder *recorder, const struct hlpv_point *a,
                   const struct hlpv_point *b);

/* Adds a switch; the state after it counts for the extremes. STATUS_NO_MEMORY. */
enum status recorder_event(struct recorder *recorder, const struct hlpv_event *event,
                           struct error *error);

/* A held set-point begins, and ends with the state `x` in `mode`. */
void recorder_hold_open(struct recorder *recorder, double time, double set_point, int mode,
                        const double x[HLPV_STATES]);
void recorder_hold_close(struct recorder *recorder, double time, int mode,
                         const double x[HLPV_STATES]);

#endif
