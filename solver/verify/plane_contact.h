/* Bodies pressed by a rigid plate y = const from above, frictionless. */
#ifndef PNEULAB_VERIFY_PLANE_CONTACT_H
#define PNEULAB_VERIFY_PLANE_CONTACT_H

#include "solver/fe/equilibrium.h"
#include "solver/verify/report.h"

struct plate {
  struct verify_body *body;
  struct equilibrium *solver;
  double start, at; /* heights of the plate: at first, and now */
  double force;     /* on the body at the last equilibrium, N, pushing down is positive */
  bool penalty;     /* the multipliers stay zero: the plate gives by pressure / stiffness */
};

/* Puts the plate on the body, whose highest point is at `height`. Call plate_close after it, also
 * after a failure. */
enum status plate_open(struct plate *plate, struct verify_body *body, double height,
                       const struct verify_run *run, struct error *error);
void plate_close(struct plate *plate);

/* Moves the plate to `height` and finds the equilibrium, in smaller steps where one is too long. */
enum status plate_move(struct plate *plate, double height, struct error *error);

/* Force of the plate on face f of the contact, N, and where it lies along x now: the mean of the
 * points' x and of x^2, weighted by force, and its ends. The multipliers of single points swing
 * about the pressure, since a face has more of them than nodes; their sums do not. */
struct plate_share {
  double force, mean, square, left, right;
};
struct plate_share plate_face_share(const struct plate *plate, int face);

#endif
