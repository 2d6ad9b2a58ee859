/* Motion of a body in time: implicit steps in the machinery of the equilibrium.
 *
 * The method is that of Wood, Bossak and Zienkiewicz (1980): Newmark's displacements and velocities
 *   u1 = u0 + h v0 + h^2 ((1/2 - beta) a0 + beta a1),   v1 = v0 + h ((1 - gamma) a0 + gamma a1)
 * with the balance of momentum at the end of the step, M ((1 - alpha) a1 + alpha a0) + r(u1) = 0,
 * alpha = (rho - 1) / (rho + 1), beta = (1 - alpha)^2 / 4, gamma = 1/2 - alpha. It is of second
 * order; oscillations much faster than the step lose the factor rho a step, those that the steps
 * resolve next to nothing. Of the generalised-alpha methods it is the one in which every force,
 * that of the contact and of friction too, acts at the end of the step: the residual is the static
 * one with an inertia term that has a potential, so the machinery of the equilibrium serves as it
 * is, a contact closes without ringing, and what is at rest is in static equilibrium. (Methods that
 * conserve energy to round-off have unsymmetric tangents.)
 *
 * Damping is viscous, S = viscosity dC/dt in the material (Kelvin-Voigt), the rate by backward
 * differences of second order. It depends on C alone, so a rigid motion is not damped at all, also
 * not by a finite step; Rayleigh's stiffness-proportional damping, built on a stale stiffness,
 * would damp it. For small strains it is that damping, of ratio viscosity/mu * omega/2. Besides,
 * `drag` times the momentum may damp the motion as a whole, which does act on rigid motions. */
#ifndef PNEULAB_FE_DYNAMICS_H
#define PNEULAB_FE_DYNAMICS_H

#include "solver/fe/energy.h"
#include "solver/fe/equilibrium.h"
#include "solver/fe/free_object.h"

struct dynamics_options {
  double fast;              /* rho: what is left of the fastest oscillations after a step, 0 to 1 */
  double viscosity;         /* Pa s, >= 0 */
  double drag;              /* 1/s, >= 0 */
  double tolerance;         /* of the error of a step, root mean square over the unknowns, m */
  double shortest, longest; /* steps that dynamics_advance takes, s */
};

/* What moves with a state (struct fe_state holds where it is). Vectors of node_count x 3. */
struct motion {
  double time;          /* s */
  double step;          /* length of the step to take next, s; the caller sets the first one */
  double last;          /* length of the last step, 0 at the start */
  double *velocity;     /* m/s */
  double *acceleration; /* of the method (at an earlier moment: see dynamics.c), m/s2 */
  double *balanced;     /* that of the balance of momentum at the state, m/s2 */
  double *before;       /* displacements at the start of the last step, m */
  double *viscous;      /* stresses of the viscosity, element_count x ENERGY_STRESS, Pa */
  double kinetic;       /* energy, J; that of a free object counts */
  struct object_motion object; /* of the free object */
};

enum status motion_create(const struct fe_model *model, struct motion *motion);
void motion_release(struct motion *motion);
/* At rest at time 0; the step stays. */
void motion_clear(const struct fe_model *model, struct motion *motion);
void motion_copy(const struct fe_model *model, struct motion *to, const struct motion *from);

struct dynamics_statistics {
  int steps, rejected; /* accepted; too inaccurate or without a solution */
  int iterations;      /* factorisations */
};

struct dynamics {
  struct fe_model *model;
  struct equilibrium *solver;
  struct inertia *inertia;
  struct free_object *object; /* that moves along, or NULL: set by the caller, borrowed */
  struct dynamics_options options;
  struct fe_state saved; /* before the step that is being tried */
  struct fe_state rest;  /* of dynamics_carry */
  double *work;          /* node_count x 3: accelerations after `solve` */
  double error;          /* of the last step, m */
  int last_iterations;   /* factorisations of the last step */
  double factor_step;    /* the factor left behind is that of a step of this length, else 0 */
  int factorizations;    /* of the model when it was left behind */
  struct dynamics_statistics statistics;
};

/* Prepares for the model of an equilibrium solver, which must outlive it. The options are filled
 * with defaults from the body's length L, density and shear modulus, open to the caller: fast 0.8,
 * viscosity L sqrt(density mu), whose relaxation time is that of a shear wave along the body (a
 * slender body's first bending is then damped by some tenths, everything faster more), no drag,
 * tolerance 2e-4 L, steps of 1e-6 to 20 times L sqrt(density / mu).
 * STATUS_INVALID for a material without density, NO_MEMORY. The caller owns *out. */
enum status dynamics_create(struct equilibrium *solver, struct dynamics **out, struct error *error);
void dynamics_destroy(struct dynamics *dynamics);

/* Time of a shear wave along the body, s: the scale of the defaults. */
double dynamics_scale(const struct dynamics *dynamics);

/* Gives the motion the accelerations that balance the residual of the state under the load, for
 * motion that begins out of equilibrium. Factorises the mass. STATUS_OK, INVERTED, NO_MEMORY. */
enum status dynamics_balance(struct dynamics *dynamics, const struct fe_load *load,
                             const struct fe_state *state, struct motion *motion);

/* Lowest angular frequency (1/s) of small vibrations about a state in equilibrium with the load,
 * without damping, and its mode (node_count x 3, largest entry 1), by inverse iteration. A free
 * object is taken to be held. Factorises. STATUS_OK, UNSTABLE_PATH for a state that is not stable,
 * DIVERGED when two modes are as low as each other, INVERTED, NO_MEMORY. */
enum status dynamics_frequency(struct dynamics *dynamics, const struct fe_load *load,
                               const struct fe_state *state, double *mode, double *frequency);

/* One step of length motion->step under the load at its end; pressure_before is that at its start.
 * Obstacles are committed with it, and *energy, unless NULL, records it. On failure (as
 * equilibrium_solve) state, motion and free object are as before; obstacles that the caller has
 * moved are its own to put back (model_reject_obstacles). */
enum status dynamics_step(struct dynamics *dynamics, const struct fe_load *load,
                          double pressure_before, struct fe_state *state, struct motion *motion,
                          struct energy *energy);

/* Commits the obstacles at the end of an accepted step, moving or not, and adds to `step` what they
 * have done: friction, the work of those that were moved, the weight of the free object. */
void dynamics_commit(struct dynamics *dynamics, struct fe_state *state, struct energy_step *step);

/* What happens to a body over time. */
struct dynamics_drive {
  /* Sets the load at `time`, and moves obstacles; NULL: the load stays. A status other than OK ends
   * the motion. */
  enum status (*drive)(void *context, double time, struct fe_load *load);
  /* Called after every accepted step; a status other than OK ends the motion. May be NULL. */
  enum status (*visit)(void *context, const struct motion *motion, const struct fe_state *state,
                       const struct fe_load *load);
  void *context;
};

/* One step whose length adapts: the error of the displacements, (alpha/2 + beta - 1/6) h^2 (a1 -
 * a0), is kept near the tolerance (Zienkiewicz, Xie 1991), never past `until` (s). *load is that of
 * the start, and becomes that of the end. STATUS_STEP_MINIMUM when no step works, with the reason
 * of the last attempt in *reason; else as dynamics_step. */
enum status dynamics_advance(struct dynamics *dynamics, const struct dynamics_drive *drive,
                             double until, struct fe_load *load, struct fe_state *state,
                             struct motion *motion, struct energy *energy, enum status *reason);

#endif
