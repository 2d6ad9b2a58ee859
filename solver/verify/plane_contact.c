#include "solver/verify/plane_contact.h"

#include <math.h>
#include <string.h>

enum { HALVINGS = 6 };

enum status plate_open(struct plate *p, struct verify_body *body, double height,
                       const struct verify_run *run, struct error *error) {
  *p = (struct plate){.body = body, .start = height, .at = height};
  enum status status =
      model_add_plane(body->model, (double[3]){0, height, 0}, (double[3]){0, -1, 0}, error);
  /* The state has to hold the multipliers of the plate too. */
  state_release(&body->state);
  if (status == STATUS_OK && state_create(body->model, &body->state) != STATUS_OK) {
    status = error_set(error, STATUS_NO_MEMORY, NULL, "no memory for a state");
  }
  if (status == STATUS_OK) {
    status = equilibrium_create(body->model, &p->solver, error);
  }
  if (status == STATUS_OK) {
    p->solver->options.deadline_s = run->control.deadline_s;
    p->solver->options.cancelled = run->control.cancelled;
  }
  return status;
}

void plate_close(struct plate *p) {
  equilibrium_destroy(p->solver);
}

/* One step; on failure everything is as before. */
static enum status step_to(struct plate *p, double height) {
  struct fe_model *m = p->body->model;
  struct contact_plane *plane = &m->contact.plane[m->contact.plane_count - 1];
  struct fe_load none = {0};
  struct fe_state before;
  int iterations;
  if (state_create(m, &before) != STATUS_OK) {
    return STATUS_NO_MEMORY;
  }
  state_copy(m, &before, &p->body->state);
  plane->point[1] = height;
  if (p->penalty) {
    p->solver->options.traction_tolerance = INFINITY;
    memset(p->body->state.lambda, 0,
           sizeof *p->body->state.lambda * (size_t)m->contact.point_count);
  }

  p->solver->factor_fits = false; /* the load is the plate's way, which the solver cannot see */
  enum status status = equilibrium_solve(p->solver, &none, 0, &p->body->state, &iterations);
  if (status == STATUS_OK) {
    p->at = height;
    struct contact_summary summary = contact_summarise(&m->contact);
    p->force = -summary.plane_force[m->contact.plane_count - 1][1];
  } else {
    state_copy(m, &p->body->state, &before);
    plane->point[1] = p->at;
  }
  state_release(&before);
  return status;
}

enum status plate_move(struct plate *p, double height, struct error *error) {
  double step = height - p->at, smallest = step / (1 << HALVINGS);
  while (p->at - height > 1e-12 * p->start) {
    double next = p->at + step < height ? height : p->at + step;
    enum status status = step_to(p, next);
    if (status == STATUS_DIVERGED || status == STATUS_INVERTED) {
      step *= 0.5;
      status = step > smallest ? status : STATUS_OK; /* both are negative */
    }
    if (status != STATUS_OK) {
      return verify_failed(status, "the plate's step", error);
    }
  }
  return STATUS_OK;
}

struct plate_share plate_face_share(const struct plate *p, int face) {
  const struct fe_model *m = p->body->model;
  const struct contact *c = &m->contact;
  struct plate_share share = {.left = INFINITY, .right = -INFINITY};
  int nodes[QUAD9_NODES];
  double now[QUAD9_NODES];
  mesh_face_nodes(m->mesh, &c->face[face].face, nodes);
  for (int a = 0; a < QUAD9_NODES; a++) {
    now[a] = m->mesh->x[3 * nodes[a]] + p->body->state.u[3 * nodes[a]];
    share.left = fmin(share.left, now[a]);
    share.right = fmax(share.right, now[a]);
  }
  size_t first = (size_t)QUAD9_POINTS * (size_t)(c->face_count * c->plane_count + face);
  for (int q = 0; q < QUAD9_POINTS; q++) {
    const struct contact_point *point = &c->point[first + (size_t)q];
    double x = 0, force = point->lambda * point->area;
    for (int a = 0; a < QUAD9_NODES; a++) {
      x += m->quad9.n[q][a] * now[a];
    }
    share.force += force;
    share.mean += force * x;
    share.square += force * x * x;
  }
  if (share.force > 0) {
    share.mean /= share.force;
    share.square /= share.force;
  }
  return share;
}
