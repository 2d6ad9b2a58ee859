/* Snap-through of a clamped shallow arch under a load at its crown, in plane strain: half of it,
 * clamped at one end and guided at the crown. Both limit points are passed: in one case the crown's
 * way is prescribed and the load found, in the other the path is followed by arc length. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/equilibrium.h"
#include "solver/verify/cases.h"

/* ---- the closed form ----
 * Shallow arch z = e (1 - (2 x / L)^2), w downwards, thrust H constant along the arch:
 *   EI w'''' + H w'' = -H k, k = 8 e / L^2, between the clamps at x = +-l, l = L/2,
 *   w = A + C cos(bx) + D (sin(bx) - bx) - k x^2 / 2 for x > 0, b^2 = H / EI, D = -P / (2 EI b^3),
 *   2 H l / EA = integral over 0 .. l of 2 z' w' - w'^2 with z' = -k x.
 * For a given way w(0) the clamp gives C and D, the last equation fixes b, and with it the load
 * P. Under tension, H < 0, cosh and sinh take the places of cos and sin; b is then counted
 * negative. */

struct arch {
  double rise, thickness, half_span;
  double modulus; /* of plane strain */
};

static double bending(const struct arch *a) {
  return a->modulus * pow(a->thickness, 3) / 12;
}

/* cos and sin of bx, or cosh and sinh of it for b < 0. */
static void waves(double b, double x, double *even, double *odd) {
  *even = b > 0 ? cos(b * x) : cosh(b * x);
  *odd = b > 0 ? sin(b * x) : sinh(-b * x);
}

/* For the way and b: load P, and what the equation of the thrust lacks. */
static double thrust_equation(const struct arch *a, double way, double b, double *load) {
  double l = a->half_span, k = 2 * a->rise / (l * l), even, odd, sum = 0;
  double m = fabs(b), sign = b > 0 ? -1 : 1; /* even' = sign m odd, odd' = m even */
  waves(b, l, &even, &odd);
  /* w'(l) = 0 and w(0) - w(l) = way for C and D. */
  double c1 = sign * m * odd, d1 = m * (even - 1), r1 = k * l;
  double c2 = 1 - even, d2 = m * l - odd, r2 = way - k * l * l / 2;
  double det = c1 * d2 - c2 * d1, c = (r1 * d2 - r2 * d1) / det, d = (c1 * r2 - c2 * r1) / det;
  const int intervals = 100;
  for (int i = 0; i <= intervals; i++) {
    double x = l * i / intervals;
    waves(b, x, &even, &odd);
    double slope = c * sign * m * odd + d * m * (even - 1) - k * x;
    sum += (i == 0 || i == intervals ? 1 : i % 2 ? 4 : 2) * (-2 * k * x - slope) * slope;
  }
  sum *= l / intervals / 3;
  *load = 2 * bending(a) * sign * m * m * m * d;
  return 2 * bending(a) * b * m * l / (a->modulus * a->thickness) - sum;
}

/* Load at the crown's way: the root b that lies nearest to the one before, *at. */
static double arch_load(const struct arch *a, double way, double *at) {
  const int scan = 1000;
  double most = 2 * M_PI / a->half_span, best = INFINITY, found = *at, load = 0, last = 0;
  for (int i = 0; i <= scan; i++) {
    double high = most * (2.0 * i / scan - 1) + 1e-6 * most, low = high - 2 * most / scan;
    double value = thrust_equation(a, way, high, &load), sign = last;
    last = value;
    if (i == 0 || value * sign >= 0 || fabs(0.5 * (low + high) - *at) > best + most / scan) {
      continue;
    }
    for (int k = 0; k < 60; k++) {
      double middle = 0.5 * (low + high);
      if (thrust_equation(a, way, middle, &load) * sign > 0) {
        low = middle;
      } else {
        high = middle;
      }
    }
    if (fabs(low - *at) < best) {
      best = fabs(low - *at);
      found = low;
    }
  }
  *at = found;
  thrust_equation(a, way, found, &load);
  return load;
}

/* ---- the body ---- */

static void arch_map(const void *context, int block, const double s[3], double x[3]) {
  const struct arch *a = context;
  (void)block;
  double t = s[0], slope = -2 * a->rise * t / a->half_span;
  double scale = a->thickness * (s[2] - 0.5) / sqrt(1 + slope * slope);
  x[0] = t * a->half_span - (t < 1 ? slope * scale : 0);
  x[1] = 0.01 * a->half_span * s[1];
  x[2] = a->rise * (1 - t * t) + scale;
}

enum { ARCH_STEPS = 48 };

static const double farthest = 1.9; /* way of the crown over the rise */

/* A way along the path; the points are those of the path. */
typedef enum status arch_path(struct verify_run *run, const struct arch *a, struct verify_body *b,
                              struct error *error);

static enum status by_way(struct verify_run *run, const struct arch *a, struct verify_body *b,
                          struct error *error) {
  int crown = 3 * body_node(&b->mesh, 0, 0, a->rise) + 2;
  double load = 0, root = 0.01 / a->half_span;
  run->control.tolerance = 1e-11;
  for (int k = 1; k <= ARCH_STEPS; k++) {
    double way = farthest * a->rise * k / ARCH_STEPS;
    enum status status =
        newton_reach(b->model, b->model->equation[crown], -way, &b->state, &load, &run->control);
    if (status != STATUS_OK) {
      return verify_failed(status, "the snap-through", error);
    }
    verify_point(run, way / a->rise, load, arch_load(a, way, &root));
  }
  return STATUS_OK;
}

static double product(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++) {
    sum += a[i] * b[i];
  }
  return sum;
}

/* One step of arc length `length`, onwards from the step `last` (dof_count; all zero at first),
 * which becomes this step. */
static enum status arc_step(struct equilibrium *solver, struct verify_body *b, double length,
                            struct fe_load *load, double *direction, double *last) {
  struct fe_model *m = b->model;
  int n = m->dof_count, iterations;
  enum status status = equilibrium_tangent(solver, load, true, &b->state, direction);
  if (status != STATUS_OK) {
    return status;
  }
  bool back = product(n, direction, last) < 0;
  double change = (back ? -length : length) / sqrt(product(n, direction, direction));
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    if (m->equation[d] >= 0) {
      last[m->equation[d]] = -b->state.u[d];
    }
  }
  status = equilibrium_follow(solver, load, true, direction, change, &b->state, &iterations);
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    if (m->equation[d] >= 0) {
      last[m->equation[d]] += b->state.u[d];
    }
  }
  return status;
}

static enum status by_arc(struct verify_run *run, const struct arch *a, struct verify_body *b,
                          struct error *error) {
  struct equilibrium *solver = NULL;
  struct fe_load load = {0, 0, 0};
  int crown = 3 * body_node(&b->mesh, 0, 0, a->rise) + 2, n = b->model->dof_count;
  double *vectors = calloc(2 * (size_t)n + 1, sizeof *vectors), root = 0.01 / a->half_span, way = 0;
  enum status status = vectors ? equilibrium_create(b->model, &solver, error)
                               : verify_failed(STATUS_NO_MEMORY, "", error);
  /* The crown moves most: a step of all unknowns moves it by about twice its share. */
  double length = 0.5 * farthest * a->rise / ARCH_STEPS * sqrt(n / 3.0);
  for (int k = 0; status == STATUS_OK && way < farthest && k < 2 * ARCH_STEPS; k++) {
    solver->options.step_tolerance = 1e-10;
    solver->options.deadline_s = run->control.deadline_s;
    solver->options.cancelled = run->control.cancelled;
    status = arc_step(solver, b, length, &load, vectors, vectors + n);
    if (status != STATUS_OK) {
      verify_failed(status, "the step of arc length", error);
      break;
    }
    way = -b->state.u[crown] / a->rise;
    verify_point(run, way, load.dead, arch_load(a, way * a->rise, &root));
  }
  equilibrium_destroy(solver);
  free(vectors);
  return status;
}

/* Largest value and the smallest one behind it, by parabolas through the neighbours. */
static void limits(const struct verify_run *run, bool reference, double limit[2]) {
  const struct verify_point *p = run->report.point;
  bool passed = false;
  limit[0] = limit[1] = NAN;
  for (int k = 1; k + 1 < run->report.point_count; k++) {
    double a = reference ? p[k - 1].reference : p[k - 1].computed;
    double b = reference ? p[k].reference : p[k].computed;
    double c = reference ? p[k + 1].reference : p[k + 1].computed;
    double slope = 0.5 * (c - a), bend = a + c - 2 * b, vertex = b - slope * slope / (2 * bend);
    if (!passed && b > a && b >= c) {
      limit[0] = vertex;
      passed = true;
    } else if (passed && b < a && b <= c) {
      limit[1] = vertex;
      return;
    }
  }
}

static enum status arch_mesh(struct verify_run *run, const struct arch *a, arch_path *path,
                             const struct material_spec *material, int cells, struct error *error) {
  struct body body = {.blocks = 1, .cells = {cells, 1, 1}, .map = arch_map, .context = a};
  struct verify_body b = {.model = NULL};
  enum status status = body_build(&body, &b.mesh);
  if (status == STATUS_OK) {
    body_hold(&b.mesh, 0, 0, HOLD_X);
    body_hold(&b.mesh, 0, a->half_span, HOLD_ALL);
    body_hold(&b.mesh, -1, 0, HOLD_Y);
    status = verify_body_open(&b, material, false, error);
  }
  if (status == STATUS_OK) {
    /* Half of a unit load per width, spread over the crown's section. */
    body_add_traction(b.model, 0, 0, (double[3]){0, 0, -0.5 / a->thickness});
    verify_points_clear(run);
    status = path(run, a, &b, error);
  }
  if (status == STATUS_OK) {
    double computed[2], reference[2];
    limits(run, false, computed);
    limits(run, true, reference);
    verify_result(run, computed[0], reference[0], 0);
    verify_row(run, 1.0 / cells, computed[0], run->report.error, b.model, "%d elements", cells);
    verify_row_other(run, fabs(computed[1] / reference[1] - 1));
  }
  verify_body_close(run, &b);
  return status;
}

static enum status arch_case(struct verify_run *run, arch_path *path, struct error *error) {
  const struct material_spec material = {
      .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1e6}, .bulk_ratio = 1000};
  double mu = material.c[0], kappa = mu * material.bulk_ratio;
  /* Plane-strain modulus E / (1 - nu^2). */
  struct arch arch = {.rise = 0.01,
                      .thickness = 0.003,
                      .half_span = 0.5,
                      .modulus = 4 * mu * (3 * kappa + mu) / (3 * kappa + 4 * mu)};
  enum status status = STATUS_OK;
  for (int level = 0; status == STATUS_OK && level < run->refinement; level++) {
    status = arch_mesh(run, &arch, path, &material, 12 << level, error);
  }
  return status;
}

enum status case_arch(struct verify_run *run, struct error *error) {
  return arch_case(run, by_way, error);
}

enum status case_arch_by_arc_length(struct verify_run *run, struct error *error) {
  return arch_case(run, by_arc, error);
}
