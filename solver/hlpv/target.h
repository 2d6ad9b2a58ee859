/* Elongations that a mode can hold: the map from set-points to states of rest, and back. */
#ifndef PNEULAB_HLPV_TARGET_H
#define PNEULAB_HLPV_TARGET_H

#include "solver/job/hlpv.h"

enum { TARGET_POINTS = 513 };

/* The states of rest of every mode between the limits of the set-point, TARGET_POINTS of them. */
struct target_map {
  const struct hlpv_spec *spec;
  double lowest, highest;                  /* of the set-point, Pa */
  double margin;                           /* of elongations to guards, m */
  double h[HLPV_MODES_MAX][TARGET_POINTS]; /* NAN where there is no rest before the guards */
};

/* What to aim at for an elongation that is wanted. */
struct target {
  int mode;
  double h, set_point; /* of the state of rest */
  bool reached;        /* h is what is wanted, not only the nearest to it */
  int through;         /* first transition on the way to that mode, or -1 in the present one */
};

/* Fills the map; `spec` must outlive it. */
void target_map_fill(struct target_map *map, const struct hlpv_spec *spec, double lowest,
                     double highest, double margin);

/* Looks for a state of rest at h: in the present mode, else in those that the fewest switches lead
 * to; else the nearest of all. False when no mode on the way has any state of rest. */
bool target_find(const struct target_map *map, int mode, double h, struct target *target);

#endif
