/* A rigid object that is free to move: its place and rotation are six unknowns more.
 *
 * Small motions (a, w) of the object, x -> x + a + w x (x - place), are eliminated from every
 * linear system of the body: with the body's K du + B dm = -r and the object's G dm - C du = -g,
 * where C = d (force and moment on the object) / d u, the factor of K gives X = K^-1 B in six more
 * solves, and
 *   (G + C X) dm = -g - C K^-1 r,   du = -K^-1 r - X dm.
 * At rest g says that the contact carries the weight; in a step in time the momentum and the moment
 * of momentum of the object change besides, by the method of dynamics.h, for the rotation in the
 * object's own frame with the rotation vector of the step (Simo, Vu-Quoc 1988).
 *
 * An equilibrium is found from a pose in which the object overlaps the body a little, so that the
 * contact bears it; an object in the air has none, and falls: dynamics_carry follows it to rest. */
#ifndef PNEULAB_FE_FREE_OBJECT_H
#define PNEULAB_FE_FREE_OBJECT_H

#include "solver/fe/equilibrium.h"
#include "solver/fe/obstacle.h"

/* How an object moves; spin and turning in its own frame. */
struct object_motion {
  double velocity[3];     /* of the centroid, m/s */
  double spin[3];         /* rad/s */
  double acceleration[3]; /* of the method, m/s2 */
  double turning[3];      /* of the method, rad/s2 */
  double balanced[3];     /* accelerations of the balance of momentum */
  double balanced_turning[3];
};

/* A step in time of the object; all zero at rest. */
struct object_step {
  double h;                           /* s; 0: at rest */
  double alpha, beta, gamma, drag;    /* of the method */
  double velocity[3], spin[3];        /* at its start */
  double acceleration[3], turning[3]; /* at its start, of the method */
};

struct free_object {
  struct fe_model *model;
  int index;          /* of the obstacle */
  double mass;        /* kg */
  double inertia[9];  /* about the centroid in the object's frame, kg m2 */
  double centroid[3]; /* in the object's frame, m */
  double gravity[3];  /* m/s2; the caller may change it */
  double applied[6];  /* force and moment about the centroid besides, N, N m; the caller's */
  double size;        /* from the centroid to its far end, m */
  bool half;          /* half of it: it moves in the plane of symmetry only */
  bool guided;        /* it only moves along `axis` (of length 1) and does not turn */
  double axis[3];
  struct rigid_pose start; /* at the start of the step */
  double applied_before[6];
  struct object_step step;
  /* Of the last linear system. */
  double *response; /* X, 6 x dof_count */
  struct obstacle_coupling coupling;
  double tangent[36];   /* G + C X */
  double correction[6]; /* -dm */
  struct rigid_pose kept;
  struct equilibrium_guest guest;
};

/* Sets the obstacle `index` of the solver's model free, with a mass (kg, > 0) spread evenly over
 * its volume. Until free_object_destroy every equilibrium that the solver finds is that of the
 * object, too: its pose in the model moves along. With a half model mass and inertia are halved, as
 * are the forces, and the object moves in the plane y = 0 only. STATUS_INVALID for a plane or a
 * mass that is not above 0, CONFLICT when the solver has a free object already, NO_MEMORY. The
 * caller owns *out; the solver must outlive it. */
enum status free_object_create(struct equilibrium *solver, int index, double mass,
                               struct free_object **out, struct error *error);
void free_object_destroy(struct equilibrium *solver, struct free_object *object);

/* From now on the object only moves along this axis (of length 1) and does not turn; forces and
 * moments that ask for more are borne by something else. */
void free_object_guide(struct free_object *object, const double axis[3]);

/* Place of the centroid, m. */
void free_object_centroid(const struct free_object *object, double centroid[3]);

/* Remembers the pose before an equilibrium is sought, and goes back to it when none was found. */
void free_object_begin(struct free_object *object);
void free_object_return(struct free_object *object);

/* Work of its weight and of what is applied to it since then, J: of that the mean of before and now
 * times the motion. */
double free_object_weight_work(const struct free_object *object);

/* Force of contact (as last evaluated), weight and what is applied on the object, N, and their
 * moment about its centroid, N m; of them what can move it. */
void free_object_resultant(const struct free_object *object, double resultant[6]);

/* Force that is missing for the balance at the last evaluation, N. */
double free_object_unbalanced(const struct free_object *object);

/* Whether the object would come back after a small push, by the tangent of the last factorisation:
 * none of its motions gains force. Motions that nothing resists or drives count as stable. */
bool free_object_stable(const struct free_object *object);

/* The object's inertia in the system: residual g and tangent G of a step in time at the pose it has
 * now (free_motion.c). Added to both; nothing at rest. */
void free_motion_add(const struct free_object *object, double residual[6], double tangent[36]);

/* Acceleration and turning of the method that belong to the pose now. */
void free_motion_end(const struct free_object *object, double acceleration[3], double turning[3]);

/* Takes over what the step ended with; `motion` was that of its start. */
void free_motion_accept(const struct free_object *object, struct object_motion *motion);

/* Accelerations that balance the forces at the last evaluation, for motion that begins. */
void free_motion_balance(const struct free_object *object, double drag,
                         struct object_motion *motion);

/* Kinetic energy, J. */
double free_motion_kinetic(const struct free_object *object, const struct object_motion *motion);

/* Momentum (kg m/s) and moment of momentum about the centroid (kg m2/s). */
void free_motion_momentum(const struct free_object *object, const struct object_motion *motion,
                          double linear[3], double angular[3]);

#endif
