/* What the parts of the load path share. */
#ifndef PNEULAB_FE_PATH_INTERNAL_H
#define PNEULAB_FE_PATH_INTERNAL_H

#include "solver/fe/path.h"

/* The load parameter runs over [0, 1] for the dead load and then over the pressure. */
struct stage {
  bool dead;   /* this stage ramps the dead load */
  double end;  /* final value of the parameter */
  int records; /* recorded at k/records end, k = 1 .. records */
  double full; /* largest step */
};

struct walk {
  struct equilibrium *solver;
  const struct path_options *options;
  struct fe_state *state; /* last converged */
  struct fe_state trial;
  double value; /* converged parameter of the stage */
  double step;
  int iterations;      /* since the last recorded state */
  int arc_steps;       /* of the whole walk */
  int pushed;          /* changes of the branch */
  double limit;        /* load at the limit point; 0 without one */
  double beyond;       /* lowest load to which the path was followed after it */
  enum status failure; /* of the last attempt */
};

struct fe_load walk_load(const struct walk *walk, const struct stage *stage, double value);

/* Reports the last converged state, or with `state` not NULL that one, to the visitor. */
enum status walk_visit(struct walk *walk, const struct stage *stage, bool recorded,
                       const struct fe_state *state, double value);

/* Tries one step of the load to `target`. On failure the state stays. */
enum status walk_advance(struct walk *walk, const struct stage *stage, double target,
                         int *iterations);

/* Goes on by arc length from the last converged state until the load reaches `goal`: STATUS_OK, the
 * state is then in equilibrium with it. LIMIT_POINT when the load falls on the way and does not
 * come back within some steps; the state is then that before the limit point. Else the failure. */
enum status walk_arc(struct walk *walk, const struct stage *stage, double goal);

#endif
