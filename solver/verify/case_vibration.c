/* A cantilever that vibrates in its first mode, in time: period by the crossings of zero. */
#include <math.h>
#include <stdlib.h>
#include "solver/fe/dynamics.h"
#include "solver/verify/cases.h"
#include "solver/verify/strip.h"
#include "solver/verify/timoshenko.h"

enum { PERIODS = 2, POINTS_EVERY = 40 /* a period */ };

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e6}, .density_kg_m3 = 1000, .bulk_ratio = 1000};
static const double edge = 0.1;

static struct timoshenko beam_of(const struct material_spec *m) {
  double mu = m->c[0], kappa = m->bulk_ratio * mu;
  return (struct timoshenko){.young = 9 * kappa * mu / (3 * kappa + mu),
                             .shear = mu,
                             .poisson = (3 * kappa - 2 * mu) / (2 * (3 * kappa + mu)),
                             .density = m->density_kg_m3,
                             .edge = edge};
}

struct vibration {
  struct verify_body *body;
  struct dynamics *dynamics;
  struct motion motion;
  double reference; /* angular frequency, 1/s */
};

/* Velocities of the first mode, so small that the vibration is linear. */
static enum status strike(struct vibration *v) {
  const struct fe_load none = {0, 0, 0};
  double frequency;
  enum status status =
      dynamics_frequency(v->dynamics, &none, &v->body->state, v->motion.velocity, &frequency);
  int tip = 3 * body_node(&v->body->mesh, 1, 0, 0) + 2;
  double scale = 1e-3 / v->motion.velocity[tip];
  for (int i = 0; i < 3 * v->body->mesh.node_count; i++) {
    v->motion.velocity[i] *= scale;
  }
  return status == STATUS_OK ? dynamics_balance(v->dynamics, &none, &v->body->state, &v->motion)
                             : status;
}

/* Marches over PERIODS of the reference, and until the zero that ends them; *frequency receives the
 * angular one. */
static enum status march(struct verify_run *run, struct vibration *v, int steps, double *frequency,
                         double *drift) {
  const struct fe_load none = {0, 0, 0};
  const double *u = v->body->state.u + 3 * body_node(&v->body->mesh, 1, 0, 0) + 2;
  double h = 2 * M_PI / v->reference / steps, first = v->motion.kinetic, last = 0;
  struct energy energy;
  int crossings = 0;
  energy_start(&energy, v->body->model, &v->body->state, &none, first);
  v->motion.step = h;
  *drift = 0;
  for (int k = 1; crossings < 2 * PERIODS && k < 2 * PERIODS * steps; k++) {
    enum status status = newton_check_limits(&run->control);
    if (status == STATUS_OK) {
      status = dynamics_step(v->dynamics, &none, 0, &v->body->state, &v->motion, &energy);
    }
    if (status != STATUS_OK) {
      return status;
    }
    if (k > 1 && last * *u < 0) {
      *frequency = ++crossings * M_PI / (v->motion.time - h * *u / (*u - last));
    }
    last = *u;
    *drift = fmax(*drift, fabs(energy.remainder) / first);
    if (k % (steps / POINTS_EVERY) == 0 && k <= PERIODS * steps) {
      verify_point(run, (double)k / steps, v->reference * *u / 1e-3,
                   sin(2 * M_PI * (double)k / steps));
    }
  }
  return crossings == 2 * PERIODS ? STATUS_OK : STATUS_DIVERGED;
}

static enum status vibrate(struct verify_run *run, struct verify_body *b, int cells, int steps,
                           struct error *error) {
  struct timoshenko beam = beam_of(&rubber);
  struct vibration v = {.body = b, .reference = timoshenko_frequency(&beam)};
  struct equilibrium *solver = NULL;
  double frequency = 0, drift = 0;
  enum status status = equilibrium_create(b->model, &solver, error);
  if (status == STATUS_OK) {
    solver->options.step_tolerance = 1e-12;
    status = dynamics_create(solver, &v.dynamics, error);
  }
  if (status == STATUS_OK) {
    status = motion_create(b->model, &v.motion);
  }
  if (status == STATUS_OK) {
    v.dynamics->options.fast = 1;
    v.dynamics->options.viscosity = 0;
    verify_points_clear(run);
    status = strike(&v);
  }
  if (status == STATUS_OK) {
    status = march(run, &v, steps, &frequency, &drift);
  }
  if (status == STATUS_OK) {
    verify_result(run, frequency / (2 * M_PI), v.reference / (2 * M_PI), 0);
    verify_row(run, 1.0 / cells, run->report.computed, run->report.error, b->model,
               "%d elements, %d steps", cells, steps);
  } else {
    verify_failed(status, "the vibration", error);
  }
  motion_release(&v.motion);
  dynamics_destroy(v.dynamics);
  equilibrium_destroy(solver);
  if (cells == 4 << (run->refinement - 1)) {
    verify_metric(run, "energy_drift_percent", 100 * drift);
    verify_metric(run, "slender_beam_error_percent",
                  100 * (timoshenko_slender(&beam) / v.reference - 1));
  }
  return status;
}

enum status case_vibration(struct verify_run *run, struct error *error) {
  enum status status = STATUS_OK;
  for (int level = 0; status == STATUS_OK && level < run->refinement; level++) {
    struct verify_body b = {.model = NULL};
    int cells = 4 << level;
    status = strip_build(edge, cells, false, &b.mesh);
    if (status == STATUS_OK) {
      status = verify_body_open(&b, &rubber, false, error);
    }
    if (status == STATUS_OK) {
      status = vibrate(run, &b, cells, POINTS_EVERY << level, error);
    }
    verify_body_close(run, &b);
  }
  return status;
}
