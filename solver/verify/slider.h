/* A body that is held somewhere, and a rigid object that is moved against it, with friction. */
#ifndef PNEULAB_VERIFY_SLIDER_H
#define PNEULAB_VERIFY_SLIDER_H

#include "solver/fe/equilibrium.h"
#include "solver/fe/obstacle.h"
#include "solver/verify/report.h"

struct slider {
  struct verify_body *body;
  struct equilibrium *solver;
  struct fe_state trial;
  struct fe_load load;       /* acts in every step */
  struct rigid_pose pose;    /* of the object in the last equilibrium */
  int object;                /* its number in the model */
  struct obstacle_state now; /* resultants in the last equilibrium */
  int steps;                 /* taken so far */
};

/* Adds `shape` (which must outlive the body) at `pose` to the body and makes its solver. Call
 * slider_close after it, also after a failure. */
enum status slider_open(struct slider *slider, struct verify_body *body,
                        const struct rigid_shape *shape, const struct rigid_pose *pose,
                        double friction, const struct verify_run *run, struct error *error);
void slider_close(struct slider *slider);

/* One step to `pose`: committed, or, when it fails, undone. */
enum status slider_step(struct slider *slider, const struct rigid_pose *pose);

/* Shifts (m) and turns (rad, about its place) the object by that much in all, in `steps` equal
 * steps, in smaller ones where they are too long. *error is filled. */
enum status slider_move(struct slider *slider, const double shift[3], const double turn[3],
                        int steps, struct error *error);

#endif
