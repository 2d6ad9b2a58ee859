/* Gathers the trajectory while a motion goes on. */
#ifndef PNEULAB_BISTABLE_RECORD_H
#define PNEULAB_BISTABLE_RECORD_H

#include "solver/bistable/trajectory.h"

struct bistable_recorder {
  struct bistable_system *system;
  struct bistable_trajectory *out;
  size_t sample_room, event_room, moment_room;
  bool outside_h[BISTABLE_LAWS_MAX], outside_p[BISTABLE_LAWS_MAX]; /* has been told of */
};

/* The time of the next sample. */
double bistable_sample_time(const struct bistable_recorder *recorder);

/* Each adds one. STATUS_NO_MEMORY; STATUS_DIVERGED for too many moments, STATUS_EVENTS for too many
 * events. A moment counts for what is greatest and least, and for the balance of energies. */
enum status bistable_add_sample(struct bistable_recorder *recorder, double time, const double x[],
                                struct error *error);
enum status bistable_add_moment(struct bistable_recorder *recorder, double time, const double x[],
                                struct error *error);
enum status bistable_add_event(struct bistable_recorder *recorder,
                               const struct bistable_event *event, struct error *error);

#endif
