/* Making and unmaking of the equilibrium solver. */
#include <math.h>
#include <stdlib.h>
#include "solver/base/clock.h"
#include "solver/fe/equilibrium.h"
#include "solver/fe/settling.h"

static double body_length(const struct mesh *mesh) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (int n = 0; n < mesh->node_count; n++) {
    for (int i = 0; i < 3; i++) {
      low[i] = fmin(low[i], mesh->x[3 * n + i]);
      high[i] = fmax(high[i], mesh->x[3 * n + i]);
    }
  }
  return fmax(fmax(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

enum status equilibrium_create(struct fe_model *model, struct equilibrium **out,
                               struct error *error) {
  struct equilibrium *s = calloc(1, sizeof *s);
  *out = NULL;
  if (!s) {
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the solver");
  }
  double length = body_length(model->mesh);
  s->model = model;
  s->length = length;
  s->options.longest_step = 0.25 * length;
  s->options.step_tolerance = 1e-6 * length;
  s->options.traction_tolerance = 1e-2 * material_shear_modulus(&model->material);
  s->options.force_tolerance = 1e-3;
  s->options.overlap_tolerance = 0.004 * model->mesh->wall_thickness;
  s->options.force_patience = 6;
  s->options.max_iterations = 30;
  s->retraction = retraction_create(model->mesh);
  s->step = calloc((size_t)model->dof_count + 1, sizeof *s->step);
  s->chord = calloc((size_t)model->dof_count + 1, sizeof *s->chord);
  s->lambda_step = calloc((size_t)model->contact.point_count + 1, sizeof *s->lambda_step);
  s->control.normal = calloc((size_t)model->dof_count + 1, sizeof *s->control.normal);
  s->control.force = calloc((size_t)model->dof_count + 1, sizeof *s->control.force);
  s->control.response = calloc((size_t)model->dof_count + 1, sizeof *s->control.response);
  s->settling = model->obstacle_count > 0 ? settling_create(model) : NULL;
  s->increment = calloc(3 * (size_t)model->mesh->node_count, sizeof *s->increment);
  if (!s->retraction || !s->step || !s->chord || !s->increment || !s->lambda_step ||
      (model->obstacle_count > 0 && !s->settling) || !s->control.normal || !s->control.force ||
      !s->control.response || state_create(model, &s->saved) != STATUS_OK) {
    equilibrium_destroy(s);
    return error_set(error, STATUS_NO_MEMORY, NULL, "no memory for the solver");
  }
  *out = s;
  return STATUS_OK;
}

void equilibrium_destroy(struct equilibrium *s) {
  if (!s) {
    return;
  }
  retraction_destroy(s->retraction);
  settling_destroy(s->settling);
  state_release(&s->saved);
  free(s->step);
  free(s->chord);
  free(s->increment);
  free(s->lambda_step);
  free(s->control.normal);
  free(s->control.force);
  free(s->control.response);
  free(s);
}

enum status equilibrium_check_limits(const struct equilibrium *s) {
  const struct equilibrium_options *o = &s->options;
  if (o->cancelled && o->cancelled(o->cancel_context)) {
    return STATUS_CANCELLED;
  }
  return o->deadline_s > 0 && clock_wall_s() > o->deadline_s ? STATUS_TIMEOUT : STATUS_OK;
}
