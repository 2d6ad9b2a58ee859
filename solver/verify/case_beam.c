/* Slender strips in large rotations: the elastica under a dead tip load, and the strip that an end
 * moment rolls up to a closed circle. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/equilibrium.h"
#include "solver/fe/retraction.h"
#include "solver/verify/cases.h"
#include "solver/verify/strip.h"

static const struct material_spec rubber = {
    .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1e4};

static double young(const struct material_spec *m) {
  double mu = m->c[0], kappa = mu * m->bulk_ratio;
  return 9 * kappa * mu / (3 * kappa + mu);
}

static double poisson(const struct material_spec *m) {
  return 0.5 * (3 * m->bulk_ratio - 2) / (3 * m->bulk_ratio + 1);
}

/* ---- elastica ---- */

/* Tip of the inextensible elastica of length 1 with EI = 1 under the load p across it:
 * theta'' = -p cos(theta), theta(0) = 0, theta'(1) = 0, by Runge-Kutta and shooting. */
static double shoot(double p, double curvature, double tip[2]) {
  static const double at[4] = {0, 0.5, 0.5, 1};
  const int steps = 2000;
  double h = 1.0 / steps, y[4] = {0, curvature, 0, 0}; /* theta, theta', x, z */
  for (int k = 0; k < steps; k++) {
    double d[4][4], z[4];
    for (int stage = 0; stage < 4; stage++) {
      for (int i = 0; i < 4; i++) {
        z[i] = y[i] + (stage > 0 ? at[stage] * h * d[stage - 1][i] : 0);
      }
      d[stage][0] = z[1];
      d[stage][1] = -p * cos(z[0]);
      d[stage][2] = cos(z[0]);
      d[stage][3] = sin(z[0]);
    }
    for (int i = 0; i < 4; i++) {
      y[i] += h / 6 * (d[0][i] + 2 * d[1][i] + 2 * d[2][i] + d[3][i]);
    }
  }
  tip[0] = y[2];
  tip[1] = y[3];
  return y[1];
}

static void elastica(double p, double tip[2]) {
  double low = 0, high = p; /* the straight beam's curvature is the largest */
  for (int k = 0; k < 60; k++) {
    double middle = 0.5 * (low + high);
    if (shoot(p, middle, tip) > 0) {
      high = middle;
    } else {
      low = middle;
    }
  }
}

static const double elastica_loads[] = {1, 4, 10};

/* Every load in one step from rest: the tip turns by up to 82 degrees. */
static enum status bend(struct verify_run *run, struct verify_body *b, double height,
                        struct error *error) {
  struct equilibrium *solver = NULL;
  double area = height * height, inertia = area * area / 12;
  int node = body_node(&b->mesh, 1, 0, 0);
  body_add_traction(b->model, 0, 1, (double[3]){0, 0, young(&rubber) * inertia / area});
  enum status status = equilibrium_create(b->model, &solver, error);
  verify_points_clear(run);
  for (int k = 0; status == STATUS_OK && k < 3; k++) {
    struct fe_load load = {0, 0, elastica_loads[k]};
    double tip[2];
    int iterations;
    memset(b->state.u, 0, sizeof *b->state.u * 3 * (size_t)b->mesh.node_count);
    memset(b->state.p, 0, sizeof *b->state.p * ELEMENT_PRESSURES * (size_t)b->mesh.element_count);
    solver->options.step_tolerance = 1e-9;
    solver->options.deadline_s = run->control.deadline_s;
    solver->options.cancelled = run->control.cancelled;
    solver->factor_fits = false;
    status = equilibrium_solve(solver, &load, 0, &b->state, &iterations);
    if (status == STATUS_OK) {
      elastica(elastica_loads[k], tip);
      verify_point(run, elastica_loads[k], b->state.u[3 * node + 2], tip[1]);
      verify_result(run, b->state.u[3 * node + 2], tip[1], 0);
    } else {
      verify_failed(status, "the bending", error);
    }
  }
  equilibrium_destroy(solver);
  return status;
}

enum status case_elastica(struct verify_run *run, struct error *error) {
  static const int cells[] = {16, 32, 64, 128};
  const double height = 0.01;
  enum status status = STATUS_OK;
  for (int k = 0; status == STATUS_OK && k < run->refinement && k < 4; k++) {
    struct verify_body b = {.model = NULL};
    status = strip_build(height, cells[k], false, &b.mesh);
    if (status == STATUS_OK) {
      status = verify_body_open(&b, &rubber, false, error);
    }
    if (status == STATUS_OK) {
      status = bend(run, &b, height, error);
    }
    if (status == STATUS_OK) {
      verify_row(run, 1.0 / cells[k], run->report.computed, run->report.error, b.model,
                 "%d elements", cells[k]);
    }
    verify_body_close(run, &b);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}

/* ---- pure bending ---- */

/* Moment per width that bends a strip of thickness h to the turn w per length (Rivlin 1949),
 * incompressible neo-Hooke with mu = 1: hoop stretch w r between the radii r1 and r2, with
 * r1 r2 = 1/w^2 for free surfaces and r2^2 - r1^2 = 2 h / w; radial stress W(r) - W(r1). */
static double rivlin_moment(double h, double w) {
  double a = h / w, inner = sqrt(sqrt(a * a + pow(w, -4)) - a), outer = 1 / (w * w * inner);
  const int intervals = 400;
  double sum = 0, step = (outer - inner) / intervals;
  for (int k = 0; k <= intervals; k++) {
    double r = inner + k * step, l = w * r, l1 = w * inner;
    double radial = 0.5 * (l * l + 1 / (l * l) - l1 * l1 - 1 / (l1 * l1));
    double hoop = radial + l * l - 1 / (l * l);
    sum += (k == 0 || k == intervals ? 1 : k % 2 ? 4 : 2) * hoop * r;
  }
  return sum * step / 3;
}

/* The turn per length that belongs to a moment. */
static double rivlin_turn(double h, double moment) {
  double low = 1e-6 / h, high = 1 / h;
  for (int k = 0; k < 100; k++) {
    double middle = 0.5 * (low + high);
    if (rivlin_moment(h, middle) < moment) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

/* The moment is a couple of end tractions normal to the end section's chord, which turn with it:
 * force q[m] n(angle) on node m. It has no resultant, so that the moment is the same everywhere.
 * The load's tangent is of rank one and is added by the formula of Sherman and Morrison. */
struct couple {
  struct verify_body *body;
  int bottom, top; /* ends of the chord, on y = 0 */
  double *q;       /* node_count, N at unit moment per width */
  double *vector;  /* 3 x dof_count */
};

/* Force along the section's normal from a stress linear over the height: -12 m z / h^3. */
static void fill_couple(struct couple *c, double h) {
  struct fe_model *m = c->body->model;
  const struct mesh *mesh = m->mesh;
  for (int f = 0; f < mesh->face_count; f++) {
    int nodes[QUAD9_NODES];
    mesh_face_nodes(mesh, &mesh->faces[f], nodes);
    bool at_end = true;
    for (int a = 0; a < QUAD9_NODES; a++) {
      at_end = at_end && mesh->x[3 * nodes[a]] > 1 - 1e-9;
    }
    for (int p = 0; at_end && p < QUAD9_POINTS; p++) {
      double z = 0;
      for (int a = 0; a < QUAD9_NODES; a++) {
        z += m->quad9.n[p][a] * mesh->x[3 * nodes[a] + 2];
      }
      for (int a = 0; a < QUAD9_NODES; a++) {
        c->q[nodes[a]] += -12 * z / (h * h * h) * m->quad9.n[p][a] * m->quad9.weight[p] * h * h / 4;
      }
    }
  }
}

/* Chord of the end section in the x-z plane; returns its length. */
static double chord_of(const struct couple *c, double chord[2]) {
  const double *x = c->body->mesh.x, *u = c->body->state.u;
  for (int i = 0; i < 2; i++) {
    int t = 3 * c->top + 2 * i, b = 3 * c->bottom + 2 * i;
    chord[i] = x[t] + u[t] - x[b] - u[b];
  }
  double length = hypot(chord[0], chord[1]);
  chord[0] /= length;
  chord[1] /= length;
  return length;
}

/* One Newton step at the moment; returns the largest correction, or a negative number when an
 * element is inverted. The increment goes through the retraction. */
static double roll_step(struct couple *c, struct retraction *retraction, double moment,
                        double *increment) {
  struct fe_model *m = c->body->model;
  struct fe_load none = {0};
  size_t n = (size_t)m->dof_count;
  double chord[2], length = chord_of(c, chord), *du = c->vector, *rate = du + n, *turn = rate + n;
  double normal[2] = {chord[1], -chord[0]}; /* along the strip */
  if (model_evaluate(m, &c->body->state, &none, true) != STATUS_OK) {
    return -1;
  }
  memset(rate, 0, n * sizeof *rate);
  memset(turn, 0, n * sizeof *turn);
  for (int k = 0; k < m->mesh->node_count; k++) {
    for (int i = 0; i < 2; i++) {
      int equation = m->equation[3 * k + 2 * i];
      if (equation >= 0) {
        m->residual[equation] -= moment * c->q[k] * normal[i];
        rate[equation] = moment * c->q[k] * chord[i]; /* d force / d angle */
        turn[equation] = ((k == c->top) - (k == c->bottom)) * -normal[i] / length;
      }
    }
  }
  model_factor(m);
  model_solve(m, m->residual, du);
  model_solve(m, rate, rate);
  double along = 0, gain = 0, most = 0;
  for (size_t i = 0; i < n; i++) {
    along += turn[i] * du[i];
    gain += turn[i] * rate[i];
  }
  for (size_t i = 0; i < n; i++) {
    du[i] = -du[i] - rate[i] * along / (1 - gain);
    most = fmax(most, fabs(du[i]));
  }
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    increment[d] = m->equation[d] >= 0 ? du[m->equation[d]] : 0;
  }
  model_recover(m, &c->body->state, du, 1);
  retraction_apply(retraction, c->body->state.u, increment);
  return most;
}

/* Turn of the end section from upright, nearest to `near`; upwards is positive. */
static double end_turn(const struct couple *c, double near) {
  double chord[2];
  chord_of(c, chord);
  double angle = atan2(-chord[0], chord[1]);
  return angle + 2 * M_PI * round((near - angle) / (2 * M_PI));
}

enum { ROLL_STEPS = 12 };

/* Raises the moment to `moment` in steps; *angle receives the turn of the end. */
static enum status roll(struct verify_run *run, struct couple *c, double moment, double *angle,
                        struct error *error) {
  struct retraction *retraction = retraction_create(&c->body->mesh);
  double *increment = calloc(3 * (size_t)c->body->mesh.node_count, sizeof *increment);
  enum status status = retraction && increment ? STATUS_OK : STATUS_NO_MEMORY;
  verify_points_clear(run);
  for (int k = 1; status == STATUS_OK && k <= ROLL_STEPS; k++) {
    double correction = 1, share = (double)k / ROLL_STEPS;
    for (int it = 0; it < 30 && correction > 1e-10; it++) {
      correction = roll_step(c, retraction, moment * share, increment);
      if (correction < 0) {
        break;
      }
    }
    status = correction >= 0 && correction <= 1e-10 ? STATUS_OK : STATUS_DIVERGED;
    if (status == STATUS_OK) {
      status = newton_check_limits(&run->control);
    }
    *angle = end_turn(c, *angle + 2 * M_PI / ROLL_STEPS);
    verify_point(run, share, *angle * 180 / M_PI, 360 * share);
  }
  retraction_destroy(retraction);
  free(increment);
  return status == STATUS_OK ? STATUS_OK : verify_failed(status, "the rolling", error);
}

/* The moment per width that arrives: the couple's arm changes a little with the section. */
static double applied_moment(const struct couple *c, double moment, double width) {
  double chord[2], sum = 0;
  chord_of(c, chord);
  for (int k = 0; k < c->body->mesh.node_count; k++) {
    const double *x = c->body->mesh.x + 3 * k, *u = c->body->state.u + 3 * k;
    sum -= c->q[k] * ((x[0] + u[0]) * chord[0] + (x[2] + u[2]) * chord[1]);
  }
  return moment * sum / width;
}

static enum status roll_strip(struct verify_run *run, struct verify_body *b, double h, int cells,
                              struct error *error) {
  struct couple c = {.body = b};
  double half = 0.5 * h, angle = 0;
  c.bottom = body_node(&b->mesh, 1, 0, -half);
  c.top = body_node(&b->mesh, 1, 0, half);
  c.q = calloc((size_t)b->mesh.node_count, sizeof *c.q);
  c.vector = calloc(3 * (size_t)b->model->dof_count, sizeof *c.vector);
  enum status status = c.q && c.vector ? STATUS_OK : STATUS_NO_MEMORY;
  double nu = poisson(&rubber), stiffness = young(&rubber) / (1 - nu * nu);
  double moment = 2 * M_PI * stiffness * h * h * h / 12;
  if (status == STATUS_OK) {
    fill_couple(&c, h);
    status = roll(run, &c, moment, &angle, error);
  }
  if (status == STATUS_OK) {
    /* The closed form is for mu = 1 and no change of volume; the plane-strain modulus of that is
     * 4 mu. */
    double turn = rivlin_turn(h, applied_moment(&c, moment, h) * 4 / stiffness);
    const double *tip = b->state.u + 3 * body_node(&b->mesh, 1, 0, 0);
    verify_result(run, angle * 180 / M_PI, turn * 180 / M_PI, 0);
    verify_row(run, 1.0 / cells, run->report.computed, run->report.error, b->model, "%d elements",
               cells);
    if (cells == 8 << run->refinement) {
      verify_metric(run, "textbook_angle_error_percent", 100 * fabs(angle / (2 * M_PI) - 1));
      verify_metric(run, "gap_of_the_circle_percent", 100 * hypot(1 + tip[0], tip[2]));
    }
  }
  free(c.q);
  free(c.vector);
  return status;
}

enum status case_roll_up(struct verify_run *run, struct error *error) {
  const double h = 0.02;
  enum status status = STATUS_OK;
  for (int level = 1; status == STATUS_OK && level <= run->refinement; level++) {
    struct verify_body b = {.model = NULL};
    int cells = 8 << level;
    status = strip_build(h, cells, true, &b.mesh);
    if (status == STATUS_OK) {
      status = verify_body_open(&b, &rubber, false, error);
    }
    if (status == STATUS_OK) {
      status = roll_strip(run, &b, h, cells, error);
    }
    verify_body_close(run, &b);
  }
  return status;
}
