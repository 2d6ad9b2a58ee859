/* What a motion leaves: samples, events, and what was greatest. */
#ifndef PNEULAB_BISTABLE_TRAJECTORY_H
#define PNEULAB_BISTABLE_TRAJECTORY_H

#include "solver/bistable/system.h"

enum { BISTABLE_EVENTS_MAX = 2000, BISTABLE_WARNINGS_MAX = 20, BISTABLE_WARNING_TEXT = 300 };

struct bistable_sample {
  double time;
  double set_point[BISTABLE_ACTUATORS_MAX];
  double x[SYSTEM_STATES_MAX];
  struct bistable_motion motion;
  int stretched; /* cells on that side */
};

enum bistable_event_type {
  EVENT_SNAP,   /* a cell goes over to its stretched side */
  EVENT_RETURN, /* and back */
  EVENT_STOP,   /* a cell meets a stop */
  EVENT_CONTACT,
  EVENT_SEPARATION /* of plate and load */
};

struct bistable_event {
  enum bistable_event_type type;
  double time;
  int cell;             /* -1: of the load */
  double h, velocity;   /* of the plate, after the event */
  double before, after; /* pressure of the actuator (of the first one for the load), Pa */
  double lost;          /* energy, J: by the jump within the cell, or by the impact */
  double impulse;       /* of an impact, N s */
  /* Of a snap or return: when the cell left the stable part of its side, and the state then. */
  double trigger_time, trigger_pressure, trigger_h;
  /* What the plate makes of it until it comes to rest or turns back; NAN when it does not move. */
  double peak_speed, peak_time;
  double travel;                            /* from the trigger on, m */
  double travel_end;                        /* time */
  double travel_time;                       /* from 10 % to 90 % of it, s */
  double least_pressure, greatest_pressure; /* from the trigger to then */
};

/* One step of the integration. */
struct bistable_moment {
  double time, h, velocity, tilt, pressure[BISTABLE_ACTUATORS_MAX];
};

struct bistable_trajectory {
  size_t sample_count, event_count, moment_count;
  struct bistable_sample *sample;
  struct bistable_event *event;
  struct bistable_moment *moment;
  double time;
  double start[SYSTEM_STATES_MAX], x[SYSTEM_STATES_MAX]; /* first and last state */
  enum law_side side[BISTABLE_CELLS_MAX];                /* at the end */
  bool in_contact;
  struct bistable_motion motion; /* at the end */
  double peak_speed, peak_tilt_rate;
  double lowest_h, highest_h, lowest_tilt, highest_tilt;
  double peak_load_speed /* away from the plate */, peak_contact_force, impact_impulse;
  double lost;  /* in jumps and impacts, J */
  double taken; /* by dashpots less given by supplies, J */
  double peak_kinetic;
  double balance_error; /* largest difference of the energies, J */
  double first_energy;
  int warning_count;
  char warning[BISTABLE_WARNINGS_MAX][BISTABLE_WARNING_TEXT];
  struct hlpv_counts counts;
};

void bistable_trajectory_release(struct bistable_trajectory *trajectory);

/* Adds a warning unless there are too many. */
void bistable_warn(struct bistable_trajectory *trajectory, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Fills in what the plate makes of the snaps and returns. */
void bistable_measure(struct bistable_trajectory *trajectory, const struct bistable_system *system);

#endif
