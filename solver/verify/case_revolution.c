/* Bodies of revolution in their meridian, solver/axi: a sphere under inner pressure and a conical
 * washer, both followed by arc length. */
#include <math.h>
#include "solver/verify/cases.h"
#include "solver/verify/revolution.h"

enum { MARKS = CONTINUATION_WATCHES };

/* A path that is stopped at marks: values of one displacement, in order. */
struct marked {
  const struct revolution *body;
  struct axi_mesh mesh;
  struct axi_model *model;
  struct axi_state state;
  int node, component; /* whose displacement is watched; node -1: the elongation */
  int unknown;
  int count, reached;
  double mark[MARKS];
  double load[MARKS]; /* pressure or force there */
  int factorizations;
};

static void watch(void *context, const struct continuation_point *point, double *values) {
  const struct marked *m = context;
  double u = point->x[m->unknown];
  for (int k = 0; k < m->count; k++) {
    values[k] = u - m->mark[k];
  }
}

static bool visit(void *context, const struct axi_state *state,
                  const struct continuation_point *point) {
  struct marked *m = context;
  m->factorizations += point->iterations;
  if (point->events & CONTINUATION_WATCH) {
    m->load[point->index] = state->pressure != 0 ? state->pressure : state->force;
    m->reached++;
  }
  return m->reached < m->count;
}

static enum status follow(struct verify_run *run, struct marked *m, const struct axi_ramp *ramp,
                          struct error *error) {
  enum status status = axi_model_create(&m->mesh, NULL, &m->model, error);
  if (status == STATUS_OK) {
    status = axi_state_create(m->model, &m->state, error);
  }
  if (status != STATUS_OK) {
    return status;
  }
  m->unknown = m->node < 0 ? axi_model_size(m->model) - 1
                           : axi_model_equation(m->model, m->node, m->component);
  struct continuation_options options = axi_defaults(m->model);
  options.watch = watch;
  options.watch_context = m;
  options.watch_count = m->count;
  options.event_tolerance = 1e-9;
  options.deadline_s = run->control.deadline_s;
  options.cancelled = run->control.cancelled;
  options.cancel_context = run->control.cancel_context;
  status = axi_follow(m->model, ramp, &options, 1, NULL, visit, m, &m->state, error);
  if (status == STATUS_OK && m->reached < m->count) {
    status = error_set(error, STATUS_DIVERGED, NULL, "the path did not reach its end");
  }
  return status;
}

/* The row of a mesh, with its size. */
static void row(struct verify_run *run, const struct marked *m, const char *words) {
  struct verify_report *r = &run->report;
  const int *cells = m->body->cells;
  verify_row(run, 1.0 / cells[0], r->computed, r->error, NULL, "%d x %d %s", cells[0], cells[1],
             words);
  r->row[r->row_count - 1].unknowns = r->unknowns = axi_model_size(m->model);
  r->elements = m->mesh.element_count;
  r->factorizations += m->factorizations;
  r->newton_iterations += m->factorizations;
}

static void close_marked(struct marked *m) {
  axi_state_destroy(&m->state);
  axi_model_destroy(m->model);
  axi_mesh_release(&m->mesh);
}

/* ---- sphere ------------------------------------------------------------------------------ */

static void sphere_map(const void *context, double s, double t, double x[2]) {
  (void)context;
  double radius = 1 + s, angle = 0.5 * M_PI * t;
  x[0] = t < 1 ? radius * cos(angle) : 0;
  x[1] = radius * sin(angle);
}

/* Green, Zerna: p/mu of an incompressible sphere with radii 1 and 2 at the inner stretch a. */
static double sphere_pressure(double a) {
  double b = cbrt((a * a * a - 1) / 8 + 1);
  return 2 / b + 1 / (2 * pow(b, 4)) - 2 / a - 1 / (2 * pow(a, 4));
}

enum status case_sphere_of_revolution(struct verify_run *run, struct error *error) {
  static const double stretches[] = {1.1, 1.25, 1.5, 2};
  enum status status = STATUS_OK;
  for (int level = 0; status == STATUS_OK && level < run->refinement; level++) {
    struct revolution body = {
        .cells = {2 << level, 4 << level},
        .map = sphere_map,
        .material = {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1e6}};
    struct marked m = {.body = &body, .count = 4};
    for (int k = 0; k < m.count; k++) {
      m.mark[k] = stretches[k] - 1;
    }
    status = revolution_mesh(&body, &m.mesh, error);
    if (status == STATUS_OK) {
      revolution_hold(&body, &m.mesh, 1, 0, 1, AXI_FIXED);
      revolution_hold(&body, &m.mesh, 1, 1, 0, AXI_FIXED);
      m.node = revolution_node(&body, 0, 0);
      status = follow(run, &m, &(struct axi_ramp){.to = {.pressure = 1}}, error);
    }
    if (status == STATUS_OK) {
      verify_points_clear(run);
      for (int k = 0; k < m.count; k++) {
        verify_point(run, stretches[k], m.load[k], sphere_pressure(stretches[k]));
      }
      verify_result(run, m.load[3], sphere_pressure(stretches[3]), 0);
      row(run, &m, "over wall and quarter");
    }
    close_marked(&m);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}

/* ---- washer ------------------------------------------------------------------------------ */

/* A narrow ring: its section turns without bending, as the theory has it. Its height is half as
 * much again as its thickness, so that it snaps through under a force. */
struct washer {
  double inner, outer, thickness, height;
};

static const struct washer narrow = {96, 104, 0.4, 0.6};

static void washer_map(const void *context, double s, double t, double x[2]) {
  const struct washer *w = context;
  double angle = atan2(w->height, w->outer - w->inner), across = (t - 0.5) * w->thickness;
  x[0] = w->inner + s * (w->outer - w->inner) + across * sin(angle);
  x[1] = (1 - s) * w->height + across * cos(angle);
}

/* Almen, Laszlo (1936) at nu = 0: F = 4 E t^4/(K De^2) s/t ((h/t - s/t)(h/t - s/2t) + 1),
 * K = ((d - 1)/d)^2 / ((d + 1)/(d - 1) - 2/ln d) / pi, d = De/Di. */
static double washer_force(const struct washer *w, double young, double way) {
  double d = w->outer / w->inner, x = way / w->thickness, h = w->height / w->thickness;
  double k = pow((d - 1) / d, 2) / ((d + 1) / (d - 1) - 2 / log(d)) / M_PI;
  return young * pow(w->thickness, 4) / (k * w->outer * w->outer) * x *
         ((h - x) * (h - 0.5 * x) + 1);
}

enum status case_washer(struct verify_run *run, struct error *error) {
  static const double ways[MARKS] = {0.2, 0.4, 0.6, 0.8, 1, 1.3, 1.6, 2}; /* over the height */
  const double young = 1;
  enum status status = STATUS_OK;
  for (int level = 0; status == STATUS_OK && level < run->refinement; level++) {
    struct revolution body = {
        .cells = {8 << level, 1 << level},
        .map = washer_map,
        .context = &narrow,
        .material = {
            .model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {young / 2}, .bulk_ratio = 2.0 / 3}};
    struct marked m = {.body = &body, .count = MARKS};
    for (int k = 0; k < m.count; k++) {
      m.mark[k] = -ways[k] * narrow.height;
    }
    status = revolution_mesh(&body, &m.mesh, error);
    if (status == STATUS_OK) {
      int middle = body.cells[1], node = revolution_node(&body, 0, middle);
      m.mesh.hold[2 * revolution_node(&body, 2 * body.cells[0], middle) + 1] = AXI_FIXED;
      m.mesh.hold[2 * node + 1] = AXI_PLATE;
      m.node = -1;
      double scale = washer_force(&narrow, young, narrow.height);
      status = follow(run, &m, &(struct axi_ramp){.to = {.force = -scale}}, error);
    }
    if (status == STATUS_OK) {
      verify_points_clear(run);
      for (int k = 0; k < m.count; k++) {
        double way = ways[k] * narrow.height;
        verify_point(run, ways[k], -m.load[k], washer_force(&narrow, young, way));
      }
      verify_result(run, -m.load[4], washer_force(&narrow, young, narrow.height), 0);
      row(run, &m, "along and through");
    }
    close_marked(&m);
  }
  if (status == STATUS_OK) {
    verify_metric(run, "worst_error_percent", 100 * verify_points_worst(run));
  }
  return status;
}
