/* How the multipliers of the contact settle around Newton's method. */
#include <math.h>
#include <stdio.h>
#include "solver/fe/equilibrium_internal.h"
#include "solver/fe/obstacle_internal.h"
#include "solver/fe/settling.h"

enum {
  AUGMENTATIONS = 30,
  PATIENCE = 6, /* updates before swinging tractions are put up with */
  SHORT_PATIENCE = 3
};

/* Overlap, in thicknesses of the thinnest wall, that is put up with when multipliers do not settle:
 * anyway, and while the body rests. */
static const double little_overlap = 0.002, most_overlap = 0.015;
/* Change of the forces of rigid objects that is put up with when they do not settle. */
static const double unsettled_forces = 0.02;
/* The same, in force tolerances, once the body is still. */
static const double still_forces = 5;
/* Movement of a body at rest, of one with which patience is short, and of one that is still, in
 * step tolerances. */
static const double still_moves = 30, calm_moves = 10, unmoved = 5;

/* Finds the partners of the contact at the state that has been reached, with their tractions. A
 * state in which a part of the body has passed into another is none. */
static enum status meet(struct equilibrium *s, struct fe_load *load, struct fe_state *state) {
  struct fe_model *m = s->model;
  enum status status = model_search_contact(m, state);
  if (status == STATUS_OK && contact_intrusion(&m->contact) > 0.25 * m->mesh->wall_thickness) {
    status = STATUS_CONTACT;
  }
  return status == STATUS_OK && m->pattern_stale ? model_evaluate(m, state, load, false) : status;
}

bool equilibrium_touches(const struct fe_model *m) {
  return m->use_contact || m->contact.plane_count > 0 || m->obstacle_count > 0;
}

/* Brings the state back into equilibrium after an update of the multipliers; roughly while there
 * are more updates to come. */
static enum status rebalance(struct equilibrium *s, struct fe_load *load, struct fe_state *state,
                             bool roughly, int *iterations) {
  enum status status = model_evaluate(s->model, state, load, false);
  if (status == STATUS_OK &&
      !equilibrium_polish(s, load, state, &(struct polishing){INFINITY, 1, roughly})) {
    status = equilibrium_newton(s, load, load->pressure, state, iterations);
  }
  return status;
}

/* Whether the contact has settled: the last update did not move the body, and it changed the
 * tractions little, or, where more points touch than the surfaces can keep apart at once, so that
 * single tractions go on changing, the overlap is small. */
static bool settled(const struct equilibrium *s, double change, int updates) {
  const struct equilibrium_options *o = &s->options;
  bool still = s->moved < still_moves * o->step_tolerance;
  bool calm = o->hasty && s->moved < calm_moves * o->step_tolerance;
  bool apart = updates >= (calm ? SHORT_PATIENCE : PATIENCE) &&
               contact_summarise(&s->model->contact).penetration < o->overlap_tolerance;
  return change < 0.1 * o->traction_tolerance ||
         (still && (change < o->traction_tolerance || apart));
}

/* The same for the forces of rigid objects. */
static bool forces_settled(const struct equilibrium *s, const struct settling_change *forces,
                           int updates) {
  const struct equilibrium_options *o = &s->options;
  return forces->left < o->force_tolerance ||
         (updates >= o->force_patience && s->moved < unmoved * o->step_tolerance &&
          forces->next < still_forces * o->force_tolerance);
}

enum status equilibrium_augment(struct equilibrium *s, struct fe_load *load, struct fe_state *state,
                                int *iterations) {
  struct fe_model *m = s->model;
  double relaxation = 0, change = INFINITY;
  struct settling_change forces = {0, 0};
  bool roughly = false;
  s->moved = INFINITY;
  if (s->settling) {
    settling_restart(s->settling);
  }
  for (int k = 0; k < AUGMENTATIONS; k++) {
    enum status status = meet(s, load, state);
    if (status != STATUS_OK) {
      return status;
    }
    if (s->options.passing && m->obstacle_count == 0) {
      return STATUS_OK;
    }
    if (s->settling) {
      forces = settling_measure(s->settling, m);
    }
    change = contact_update_multipliers(&m->contact, &relaxation);
    if (s->verbose) {
      struct contact_summary c = contact_summarise(&m->contact);
      fprintf(stderr,
              "    augmentation %d: change %.3e Pa, overlap %.3e m, moved %.3e m, objects %.3e\n",
              k, change, c.penetration, s->moved, forces.next);
    }
    bool enough = settled(s, change, k) && forces_settled(s, &forces, k);
    if (enough && !roughly) {
      return STATUS_OK;
    }
    /* Forces of rigid objects take many updates. */
    roughly = s->settling && !enough;
    if (s->settling) {
      settling_update(s->settling, m);
    }
    s->moved = 0;
    status = rebalance(s, load, state, roughly, iterations);
    if (status != STATUS_OK) {
      return status;
    }
  }
  /* A body at rest with a little more overlap is an answer, with a warning in the result. */
  double overlap = contact_summarise(&m->contact).penetration, wall = m->mesh->wall_thickness;
  bool still = s->moved < still_moves * s->options.step_tolerance;
  bool good = change < s->options.traction_tolerance || overlap < little_overlap * wall ||
              (still && overlap < most_overlap * wall);
  return good && forces.next < unsettled_forces ? STATUS_OK : STATUS_CONTACT;
}

void equilibrium_start_multipliers(struct equilibrium *s, const struct fe_state *state,
                                   double ratio) {
  struct contact *contact = &s->model->contact;
  for (int i = 0; i < contact->point_count; i++) {
    double change = state->lambda[i] > 0 ? ratio * s->lambda_step[i] : 0;
    contact->point[i].lambda = fmax(0, state->lambda[i] + change);
  }
  obstacles_use(s->model, state);
}

void equilibrium_keep_multipliers(struct equilibrium *s, struct fe_state *state) {
  const struct contact *contact = &s->model->contact;
  for (int i = 0; i < contact->point_count; i++) {
    s->lambda_step[i] = contact->point[i].lambda - state->lambda[i];
    state->lambda[i] = contact->point[i].lambda;
  }
  obstacles_keep(s->model, state);
}
