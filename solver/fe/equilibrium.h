/* Newton's method for one load: from a converged state to the state in equilibrium with the
 * next load. */
#ifndef PNEULAB_FE_EQUILIBRIUM_H
#define PNEULAB_FE_EQUILIBRIUM_H

#include "solver/fe/model.h"
#include "solver/fe/retraction.h"

/* Length scales and limits, filled by equilibrium_create from the mesh; open to the caller. */
struct equilibrium_options {
  double longest_step;       /* largest nodal increment of one iteration, m */
  double step_tolerance;     /* root mean square of the last correction, m */
  double traction_tolerance; /* largest change of a contact multiplier at the end, Pa */
  double force_tolerance; /* change of the forces of rigid objects at the end, as a part of them */
  double overlap_tolerance; /* put up with where single tractions do not settle, m; 0: none */
  int force_patience;       /* updates before forces of rigid objects that swing are put up with */
  int max_iterations;
  int rough_steps;   /* given up after so many steps that had to be cut short by far; 0: never */
  bool passing;      /* the state is only passed: its contact need not have settled */
  bool hasty;        /* for paths: what lies between recorded states is only passed */
  double deadline_s; /* on clock_wall_s; 0: none */
  bool (*cancelled)(void *context); /* may be NULL */
  void *cancel_context;
};

/* What stays fixed while a state is corrected: the load, or, when active, the place along the
 * normal; the load parameter is then an unknown of its own (Riks 1979). */
struct equilibrium_control {
  bool active;
  bool dead;        /* the load parameter is the dead load's factor, else the pressure */
  double *normal;   /* dof_count: corrections of the displacements stay normal to it */
  double *force;    /* dof_count: d residual / d load parameter */
  double *response; /* dof_count: K^-1 force with the last factor */
};

/* Unknowns besides the displacements that are eliminated from every linear system: a rigid object
 * that is free to move (solver/fe/free_object.h). They take no part in steps of arc length. */
struct equilibrium_guest {
  void *context;
  /* The tangent has been evaluated and factorised. */
  void (*factored)(void *context);
  /* From step = K^-1 r (dof_count) of the body alone to that of both; the guest remembers its own
   * part. Returns the size of that, m; INFINITY when there is no solution. */
  double (*correct)(void *context, double *step);
  /* Moves by -share of the part that it remembers. */
  void (*move)(void *context, double share);
  /* Before a trial, and when it is taken back. */
  void (*keep)(void *context);
  void (*restore)(void *context);
};

struct equilibrium {
  struct fe_model *model;
  struct retraction *retraction;
  struct equilibrium_options options;
  double length;         /* largest extent of the body, m */
  struct fe_state saved; /* before the increment that is being tried */
  double *step;          /* dof_count */
  double *chord;         /* dof_count */
  double *increment;     /* node_count x 3 */
  struct equilibrium_control control;
  const struct equilibrium_guest *guest; /* or NULL; borrowed */
  double guest_step;                     /* size of the guest's last correction, m; else 0 */
  struct settling *settling; /* of the multipliers of rigid objects; NULL without them */
  double *lambda_step;       /* change of every contact multiplier in the last solve, Pa */
  double pressure_step;      /* change of the pressure in the last solve, Pa */
  bool factor_fits;          /* the factor is that of the last equilibrium, or next to it */
  int negative_pivots;       /* of the last factorisation */
  int fewest_negative, most_negative; /* over the factorisations of the last solve */
  double moved; /* sum of the rms of corrections since it was last set to 0, m */
  double share; /* part of the last step that was taken */
  int verbose;  /* 1: a line an iteration on standard error */
};

enum status equilibrium_create(struct fe_model *model, struct equilibrium **out,
                               struct error *error);
void equilibrium_destroy(struct equilibrium *solver);

/* STATUS_OK, or CANCELLED or TIMEOUT when it is time to stop. */
enum status equilibrium_check_limits(const struct equilibrium *solver);

/* Brings `state` into equilibrium with `load`; the multipliers of the state and of the contact
 * are renewed. previous_pressure is that of the state's own equilibrium: the first iteration
 * uses its load stiffness, which makes it the tangent predictor. Convergence is judged by the
 * last correction, never by the residual alone, which hardly sees bending.
 * *iterations receives the number of factorisations. Returns STATUS_OK, DIVERGED, INVERTED,
 * CONTACT, TIMEOUT, CANCELLED or NO_MEMORY; after a failure the state is that of the last iterate:
 * copy before. */
enum status equilibrium_solve(struct equilibrium *solver, const struct fe_load *load,
                              double previous_pressure, struct fe_state *state, int *iterations);

/* Tangent of the equilibrium path at a state in equilibrium with `load`: d u / d load parameter
 * into direction[dof_count], m per Pa, or m for the whole dead load when `dead`. Factorises.
 * Returns STATUS_OK, DIVERGED when the tangent is singular, INVERTED or NO_MEMORY. */
enum status equilibrium_tangent(struct equilibrium *solver, const struct fe_load *load, bool dead,
                                const struct fe_state *state, double *direction);

/* The same with the factor that the last equilibrium left behind (factor_fits), without another. */
void equilibrium_direction(struct equilibrium *solver, const struct fe_state *state,
                           double *direction);

/* One step of arc length: from a state in equilibrium with *load along the tangent `direction` of
 * equilibrium_tangent by `change` of the load parameter (its sign is that of the step); then the
 * state is corrected normal to the direction, and *load with it. Passes limit points of the load.
 * Returns as equilibrium_solve. */
enum status equilibrium_follow(struct equilibrium *solver, struct fe_load *load, bool dead,
                               const double *direction, double change, struct fe_state *state,
                               int *iterations);

/* Shape in which the last factorised tangent is softest, by inverse iteration: mode[dof_count],
 * of largest entry 1. */
void equilibrium_softest_mode(struct equilibrium *solver, double *mode);

#endif
