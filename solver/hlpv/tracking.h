/* How well an elongation follows what is wanted. */
#ifndef PNEULAB_HLPV_TRACKING_H
#define PNEULAB_HLPV_TRACKING_H

#include "solver/hlpv/controller.h"
#include "solver/hlpv/record.h"

/* One step of a held reference. */
struct tracking_step {
  double start, end, reference;
  double aim;   /* what the controller aimed at in its place, m; NAN: at nothing */
  bool reached; /* aim is the reference */
  bool changes; /* aim is another one than before: only then it has overshoot, rise and settling */
  int mode;     /* at the end */
  int switches;
  double first;          /* elongation at the start */
  double last;           /* at the end */
  double beyond;         /* largest part of the change by which h went beyond the aim, >= 0 */
  double time10, time90; /* when 10 and 90 % of the change were there first, s; NAN: not yet */
  double outside;        /* last time farther than 2 % of the change from the aim, s */
  double area, span;     /* integral of the missing elongation over the last tenth, and its time */
  double saturated;      /* s */
  double last_switch;    /* s */
};

struct tracking {
  const struct hlpv_control *control;
  size_t count, room;
  struct tracking_step *step; /* of a held reference, else none; owned */
  size_t begun;               /* values of it that hold or have held */
  double squares, most;       /* integral of the squared error; largest error, m */
  double saturated;           /* s */
};

/* Reserves room. STATUS_NO_MEMORY. */
enum status tracking_open(struct tracking *tracking, const struct hlpv_control *control,
                          struct error *error);
void tracking_release(struct tracking *tracking);

/* The controller has decided at `time` for `span` seconds: opens the steps that have begun by then.
 */
void tracking_sample(struct tracking *tracking, double time, double span, double h, double end,
                     const struct control_action *action);

/* Takes in the way between two states of one mode. */
void tracking_span(struct tracking *tracking, const struct hlpv_point *a,
                   const struct hlpv_point *b);

/* Takes in a switch. */
void tracking_switch(struct tracking *tracking, const struct hlpv_event *event, int mode);

/* Values of a step; NAN where it has none. */
double tracking_rise(const struct tracking_step *step);
double tracking_settling(const struct tracking_step *step);
double tracking_steady_error(const struct tracking_step *step);

/* Whether the modes still alternate at the end of the step: at least four switches, the last one in
 * its last quarter. */
bool tracking_cycles(const struct tracking_step *step);

#endif
