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
  int through;         /* transition from the present mode to that one, or -1 when it is the same */
};

/* Fills the map; `spec` must outlive it. */
void target_map_fill(struct target_map *map, const struct hlpv_spec *spec, double lowest,
                     double highest, double margin);

/* Looks for a state of rest at h: in the present mode, else in those that one transition leads to;
 * else the nearest of all these. False when none of them has any state of rest. */
bool target_find(const struct target_map *map, int mode, double h, struct target *target);

#endif
