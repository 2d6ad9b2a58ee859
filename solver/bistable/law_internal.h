/* Inside of a law. */
#ifndef PNEULAB_BISTABLE_LAW_INTERNAL_H
#define PNEULAB_BISTABLE_LAW_INTERNAL_H

#include "solver/bistable/cubic.h"
#include "solver/bistable/law.h"
#include "solver/bistable/law_path.h"

/* One side of a table: h = end(p) + (far - end(p)) q^(power + 1). */
struct branch {
  int power;
  double far;
  double constant; /* potential at the far end and the lowest pressure */
  double end[BISTABLE_LEVELS_MAX];
  struct cubic force[BISTABLE_LEVELS_MAX]; /* over q from 0 to 1 */
  double far_volume[BISTABLE_LEVELS_MAX];
  double end_slope[BISTABLE_LEVELS_MAX], far_slope[BISTABLE_LEVELS_MAX]; /* dF/dh beyond */
};

struct law {
  const struct law_spec *spec;
  bool branches; /* two of them */
  bool falls;
  double range[2];
  double limit[2][BISTABLE_LEVELS_MAX];
  struct law_path path[BISTABLE_LEVELS_MAX];
  struct cubic share[BISTABLE_LEVELS_MAX]; /* of every pressure of the table, over the pressure */
  struct branch branch[2];                 /* the first one only without two branches */
};

/* The shares of the table's pressures at one pressure, with slope and integral from the lowest. */
struct shares {
  double value[BISTABLE_LEVELS_MAX], slope[BISTABLE_LEVELS_MAX], integral[BISTABLE_LEVELS_MAX];
};

void law_find_shares(const struct law *law, double p, struct shares *shares);

#endif
