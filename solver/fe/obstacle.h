/* Frictional contact of the body's outer surface with rigid objects.
 *
 * Normal traction p at every Gauss point of the faces of contact.h: the augmented Lagrangian law of
 * that header with the object's signed distance as the gap; its tangent is the exact Hessian, with
 * the curvature of the object. Tangential traction t: with the stick point y, a point of the object
 * that moves with it, and the normal n of the last update of the multipliers,
 *   trial = tau + eps_t (1 - n n^T) (x - y),  t = -trial, cut back to |t| <= r = mu lambda,
 * where tau and lambda are the multipliers. r is that of the last update too (Tresca), so that the
 * tangent is symmetric; updates go on until r, tau and lambda have settled: then Coulomb's law
 * holds whatever eps and eps_t (Simo, Laursen 1992). A point that comes into contact has slipped
 * since it touched only: of its way in the step the part d / (d + g), where g was its distance at
 * the last commit and d is by how much it would have passed into the object since. That settles its
 * stick point at the first update of the multipliers.
 *
 * Multipliers and stick points are part of a state (struct fe_state), in the object's frame: a step
 * that failed leaves no trace when its state is dropped. How a driver takes a step:
 *   model_place_obstacle(...); state_copy(model, &trial, &state);
 *   if (equilibrium_solve(solver, &load, pressure, &trial, &iterations) == STATUS_OK) {
 *     model_commit_obstacles(model, &trial); state_copy(model, &state, &trial);
 *   } else {
 *     model_reject_obstacles(model);
 *   }
 * path_follow commits by itself. With a half model all forces are those of the modelled half. */
#ifndef PNEULAB_FE_OBSTACLE_H
#define PNEULAB_FE_OBSTACLE_H

#include "solver/fe/model.h"
#include "solver/rigid/shape.h"

/* What a state knows of one surface point and one object; vectors in the object's frame. */
struct obstacle_memory {
  double pressure;    /* multiplier lambda, Pa, >= 0 */
  double traction[3]; /* multiplier tau, Pa: against the friction on the body */
  double normal[3];   /* to which tau is tangential; unit, out of the object */
  double anchor[3];   /* stick point, m */
  double place[3];    /* of the point at the last commit, m */
  double drag[3];     /* minus the friction on the body at the last commit, Pa */
  bool held;          /* has a stick point */
  bool seen;          /* there has been a commit */
};

/* One surface point as last evaluated; vectors in the frame of the model. */
struct obstacle_point {
  double area;    /* reference area, m2; tractions are per reference area */
  double current; /* current area, m2; only of points that carry traction */
  struct obstacle_memory memory;
  double x[3];        /* place, m */
  double gap;         /* m, +infinity beyond reach */
  double normal[3];   /* out of the object; only with a finite gap */
  double pressure;    /* Pa */
  double friction[3]; /* tangential traction on the body, Pa */
  double slip[3];     /* of the body on the object from the stick point, m */
  double wanted;      /* pressure that lambda is to become: see obstacle_smooth, Pa */
  bool slips;
};

/* One object. */
struct obstacle {
  const struct rigid_shape *shape;
  struct rigid_pose pose, committed;   /* now, and at the last commit */
  bool placed;                         /* model_place_obstacle has been called */
  double coefficient;                  /* of friction */
  double stiffness, tangential;        /* eps, eps_t, Pa/m */
  double smoothing;                    /* delta of the normal law, m */
  double low[3], high[3];              /* box around the object at its pose, m */
  double margin;                       /* gap below which a point may carry traction, m */
  struct obstacle_point *point;        /* 9 a face of model->contact */
  unsigned char *near;                 /* per face: its points are evaluated */
  double force[3], moment[3];          /* on the object at the last commit, N, N m */
  double friction_work, motion_work;   /* in the last committed step, J */
  double friction_total, motion_total; /* since the object was added, J */
};

/* Sums over one object. Forces are on the object, N. */
struct obstacle_state {
  double force[3];       /* = normal + friction */
  double moment[3];      /* about the place of its pose, N m */
  double normal[3];      /* sum of the normal tractions */
  double friction[3];    /* sum of the tangential tractions */
  double normal_force;   /* sum of |normal traction| times area, N */
  double friction_force; /* sum of |tangential traction| times area, N */
  double area;           /* current area of the points that carry traction, m2 */
  double max_pressure;   /* largest mean of a face, per current area, Pa */
  double mean_pressure;  /* normal_force / area, Pa */
  double slip_share;     /* of the normal force: carried by points that slip; 0 without contact */
  double min_gap;        /* m, +infinity beyond reach */
  int touching;          /* points with traction */
  double friction_work;  /* dissipated in the last committed step, J */
  double motion_work;    /* done by the object's motion on the body in that step, J */
  double friction_total, motion_total; /* since the object was added, J */
};

/* Adds an object at the identity pose, before any state or solver is made; the shape must outlive
 * the model. *index receives its number. STATUS_INVALID for a negative or infinite coefficient of
 * friction, STATUS_TOO_LARGE beyond MODEL_OBSTACLES, STATUS_NO_MEMORY. */
enum status model_add_obstacle(struct fe_model *model, const struct rigid_shape *shape,
                               double friction, int *index, struct error *error);

/* Moves an object; what sticks to it goes with it. */
void model_place_obstacle(struct fe_model *model, int index, const struct rigid_pose *pose);

/* Ends a step at `state`, which is in equilibrium: renews stick points and the ledger, and makes
 * the poses those to which model_reject_obstacles returns. The state's memory is renewed with it.
 */
void model_commit_obstacles(struct fe_model *model, struct fe_state *state);

/* What a commit at `state` would record of object `index`: the work dissipated by friction in the
 * step, and that of the object's motion on the body, J. */
struct obstacle_work {
  double friction, motion;
};
struct obstacle_work model_obstacle_work(struct fe_model *model, const struct fe_state *state,
                                         int index);

/* Puts every object back to where it was at the last commit, before the first one to where it was
 * placed first. The state has to be put back by the caller. */
void model_reject_obstacles(struct fe_model *model);

/* Sums over object `index` as last evaluated. */
struct obstacle_state model_obstacle_state(const struct fe_model *model, int index);

/* Smallest distance of the surface's points and nodes from object `index` at displacements u
 * (node_count x 3), however far, m; negative where they overlap. */
double model_obstacle_clearance(const struct fe_model *model, int index, const double *u);

/* Fields of the last evaluation at the nodes, over all objects, at its displacements u: the
 * pressure on the body per current area (Pa, node_count) and, unless NULL, the friction on it (Pa,
 * node_count x 3), averages over the faces around a node; 0 off the surface. STATUS_NO_MEMORY. */
enum status model_obstacle_fields(const struct fe_model *model, const double *u, double *pressure,
                                  double *friction);

/* Derivatives for an object that is free to move, at the last evaluation, with the multipliers
 * held. Small motions are (a, w): x -> x + a + w x (x - place); resultants are (force, moment about
 * place) on the object. */
struct obstacle_coupling {
  double *by_motion;   /* 6 x dof_count: d residual / d motion, by rows of motions */
  double *by_u;        /* 6 x dof_count: d resultant / d u */
  double own[36];      /* d resultant / d motion, row: resultant */
  double resultant[6]; /* N, N m */
};
void model_obstacle_coupling(const struct fe_model *model, int index,
                             struct obstacle_coupling *coupling);

#endif
