/* Paths: a spring that snaps, in closed form; snapping cones; the cylinder that buckles. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/clock.h"
#include "solver/verify/revolution.h"
#include "tests/unit/suite.h"

static void ok(enum status status, const struct error *error) {
  ck_assert_msg(status == STATUS_OK, "%s: %s", status_word(status), error->message);
}

/* ---- two springs in series --------------------------------------------------------------- */

/* A bistable spring with the force g(w) = w (w - 1) (w - 2), and a linear one of stiffness 1/2
 * behind it. Pulled by the force lambda, unknowns w and the end v:
 *   g(w) - (v - w)/2 = 0,   (v - w)/2 - lambda = 0,
 * with limit points at w = 1 -+ 1/sqrt 3. Pulled by the end v = lambda, unknown w: the path v = w +
 * 2 g(w) snaps back between w = 1 -+ sqrt(1/6). Stable branches have no negative pivots. */
struct springs {
  bool by_end;
  double k[3]; /* of the last tangent */
};

static double bistable(double w) {
  return w * (w - 1) * (w - 2);
}

static double bistable_slope(double w) {
  return 3 * w * w - 6 * w + 2;
}

static enum status springs_evaluate(void *context, const double *x, double lambda, bool tangent,
                                    double *residual, double *load, struct error *error) {
  struct springs *s = context;
  double end = s->by_end ? lambda : x[1];
  (void)error;
  residual[0] = bistable(x[0]) - 0.5 * (end - x[0]);
  if (!s->by_end) {
    residual[1] = 0.5 * (end - x[0]) - lambda;
  }
  if (load) {
    load[0] = s->by_end ? -0.5 : 0;
    load[s->by_end ? 0 : 1] = s->by_end ? -0.5 : -1;
  }
  if (tangent) {
    s->k[0] = bistable_slope(x[0]) + 0.5;
    s->k[1] = -0.5;
    s->k[2] = 0.5;
  }
  return STATUS_OK;
}

static enum status springs_factor(void *context, int *negative, struct error *error) {
  const struct springs *s = context;
  (void)error;
  double schur = s->k[2] - s->k[1] * s->k[1] / s->k[0];
  *negative = (s->k[0] < 0) + (!s->by_end && schur < 0);
  return STATUS_OK;
}

static void springs_solve(void *context, const double *b, double *x) {
  const struct springs *s = context;
  if (s->by_end) {
    x[0] = b[0] / s->k[0];
    return;
  }
  double det = s->k[0] * s->k[2] - s->k[1] * s->k[1], first = b[0];
  x[0] = (s->k[2] * first - s->k[1] * b[1]) / det;
  x[1] = (s->k[0] * b[1] - s->k[1] * first) / det;
}

struct trace {
  const struct springs *springs;
  double worst; /* distance from the closed form */
  int limits, targets, watches, bifurcations, visits;
  double limit[4], target[16], watch_at[4];
  double last;
};

static bool trace_visit(void *context, const struct continuation_point *p) {
  struct trace *t = context;
  double w = p->x[0], force = bistable(w), end = w + 2 * force;
  t->worst = fmax(t->worst, fabs(p->lambda - (t->springs->by_end ? end : force)));
  double slope = bistable_slope(w), critical = t->springs->by_end ? -0.5 : 0;
  if (fabs(slope - critical) > 1e-2) {
    ck_assert_int_eq(p->negative, slope < critical);
  }
  if (p->events & CONTINUATION_LIMIT) {
    ck_assert_int_lt(t->limits, 4);
    t->limit[t->limits++] = w;
  }
  if (p->events & CONTINUATION_TARGET) {
    ck_assert_int_lt(t->targets, 16);
    t->target[t->targets++] = w;
  }
  if (p->events & CONTINUATION_WATCH) {
    ck_assert_int_lt(t->watches, 4);
    t->watch_at[t->watches++] = w;
  }
  t->bifurcations += (p->events & CONTINUATION_BIFURCATION) != 0;
  t->visits++;
  t->last = w;
  return w < 2.5 && w > -0.5;
}

static void watch_spring(void *context, const struct continuation_point *p, double *values) {
  (void)context;
  values[0] = p->x[0] - 1.7;
}

static struct trace follow_springs(struct springs *s, double start, int direction,
                                   const double *targets, int count) {
  static const double weight[2] = {0.5, 0.5};
  struct error error = {.status = STATUS_OK};
  struct trace t = {.springs = s};
  struct continuation_system system = {.size = s->by_end ? 1 : 2,
                                       .context = s,
                                       .weight = weight,
                                       .evaluate = springs_evaluate,
                                       .factor = springs_factor,
                                       .solve = springs_solve};
  struct continuation_options options = continuation_defaults(2);
  options.target = targets;
  options.target_count = count;
  options.watch = watch_spring;
  options.watch_count = 1;
  options.event_tolerance = 1e-6;
  double x[2] = {start, start + 2 * bistable(start)}, lambda = s->by_end ? x[1] : bistable(start);
  ok(continuation_follow(&system, &options, direction, NULL, trace_visit, &t, x, &lambda, &error),
     &error);
  ck_assert_double_eq(x[0], t.last);
  return t;
}

START_TEST(springs_follow_their_closed_form) {
  struct springs s = {.by_end = _i % 2};
  int direction = _i < 2 ? 1 : -1;
  const double force_targets[3] = {0.2, 0.01, -0.2}, end_targets[3] = {0.9, 1, 1.3};
  struct trace t = follow_springs(&s, direction > 0 ? -0.2 : 2.2, direction,
                                  s.by_end ? end_targets : force_targets, 3);
  double limit = s.by_end ? sqrt(1.0 / 6) : 1 / sqrt(3);
  ck_assert_double_lt(t.worst, 1e-7);
  ck_assert_int_eq(t.limits, 2);
  ck_assert_double_lt(fabs(t.limit[0] - (1 - direction * limit)), 1e-4);
  ck_assert_double_lt(fabs(t.limit[1] - (1 + direction * limit)), 1e-4);
  ck_assert_int_eq(t.bifurcations, 0);
  ck_assert_int_eq(t.watches, 1);
  ck_assert_double_lt(fabs(t.watch_at[0] - 1.7), 1e-4);
  /* Every value is met as often as the closed form has it. */
  int wanted = 0;
  for (int k = 0; k < 3; k++) {
    const double *target = s.by_end ? end_targets : force_targets;
    for (int i = 0; i < 60000; i++) {
      double a = -0.5 + 5e-5 * i, b = a + 5e-5;
      double fa = s.by_end ? a + 2 * bistable(a) : bistable(a);
      double fb = s.by_end ? b + 2 * bistable(b) : bistable(b);
      wanted += a >= -0.2 && b <= 2.5 && (fa - target[k]) * (fb - target[k]) < 0;
    }
  }
  ck_assert_int_ge(wanted, 5);
  ck_assert_int_eq(t.targets, wanted);
}
END_TEST

START_TEST(a_path_ends_in_time) {
  struct springs s = {.by_end = false};
  static const double weight[2] = {0.5, 0.5};
  struct error error = {.status = STATUS_OK};
  struct trace t = {.springs = &s};
  struct continuation_system system = {.size = 2,
                                       .context = &s,
                                       .weight = weight,
                                       .evaluate = springs_evaluate,
                                       .factor = springs_factor,
                                       .solve = springs_solve};
  struct continuation_options options = continuation_defaults(2);
  double x[2] = {0, 0}, lambda = 0;
  options.deadline_s = clock_wall_s() - 1;
  ck_assert_int_eq(
      continuation_follow(&system, &options, 1, NULL, trace_visit, &t, x, &lambda, &error),
      STATUS_TIMEOUT);
  options.deadline_s = 0;
  options.steps_max = 3;
  ok(continuation_follow(&system, &options, 1, NULL, trace_visit, &t, x, &lambda, &error), &error);
  ck_assert_int_eq(t.visits, 4);
}
END_TEST

/* ---- a cone that snaps ------------------------------------------------------------------- */

/* A truncated cone whose ends are held radially and hinged, t along it and s through it. */
struct cone {
  double inner, outer, rise, wall;
};

static void cone_map(const void *context, double s, double t, double x[2]) {
  const struct cone *c = context;
  double width = c->outer - c->inner, angle = atan2(c->rise, width), across = (s - 0.5) * c->wall;
  x[0] = c->outer - t * width + across * sin(angle);
  x[1] = t * c->rise + across * cos(angle);
}

struct solid {
  struct axi_mesh mesh;
  struct axi_model *model;
  struct axi_state state;
};

static struct material_spec elastic(double young, double nu) {
  return (struct material_spec){.model = MATERIAL_NEO_HOOKE,
                                .terms = 1,
                                .c = {young / 2 / (1 + nu)},
                                .bulk_ratio = 2 * (1 + nu) / 3 / (1 - 2 * nu)};
}

static void solid_close(struct solid *s) {
  axi_state_destroy(&s->state);
  axi_model_destroy(s->model);
  axi_mesh_release(&s->mesh);
}

static void cone_open(const struct cone *cone, struct solid *s) {
  struct error error = {.status = STATUS_OK};
  struct revolution body = {
      .cells = {2, 16}, .map = cone_map, .context = cone, .material = elastic(1e6, 0.4)};
  ok(revolution_mesh(&body, &s->mesh, &error), &error);
  int below = revolution_node(&body, 2, 0), above = revolution_node(&body, 2, 32);
  s->mesh.hold[2 * below] = s->mesh.hold[2 * below + 1] = AXI_FIXED;
  s->mesh.hold[2 * above] = AXI_FIXED;
  s->mesh.hold[2 * above + 1] = AXI_PLATE;
  ok(axi_model_create(&s->mesh, NULL, &s->model, &error), &error);
  ok(axi_state_create(s->model, &s->state, &error), &error);
}

static const struct cone shallow = {10e-3, 20e-3, 1.6e-3, 0.6e-3};

struct record {
  double end; /* elongation at which the path ends */
  bool below;
  double work, worst; /* of F dh + p dV; largest difference to W */
  double force, elongation, pressure, volume, energy;
  double most, least; /* force */
  int limits, visits, bifurcations;
  double limit_force[4], limit_stiffness[4];
  double first_bifurcation;
  int targets;
  double target_force[16];
};

static bool record_visit(void *context, const struct axi_state *s,
                         const struct continuation_point *p) {
  struct record *r = context;
  if (p->events & CONTINUATION_START) {
    r->work = s->energy;
  } else {
    r->work += 0.5 * (s->force + r->force) * (s->elongation - r->elongation) +
               0.5 * (s->pressure + r->pressure) * (s->volume - r->volume);
  }
  r->force = s->force;
  r->elongation = s->elongation;
  r->pressure = s->pressure;
  r->volume = s->volume;
  r->energy = s->energy;
  r->worst = fmax(r->worst, fabs(r->work - s->energy));
  r->most = fmax(r->most, s->force);
  r->least = fmin(r->least, s->force);
  if (p->events & CONTINUATION_LIMIT) {
    ck_assert_int_lt(r->limits, 4);
    r->limit_force[r->limits] = s->force;
    r->limit_stiffness[r->limits++] = s->stiffness;
  } else {
    /* One more negative pivot under a force than at a held length where the force falls. */
    ck_assert_int_eq(s->negative_free - s->negative_held, s->stiffness < 0);
  }
  if (p->events & CONTINUATION_TARGET) {
    ck_assert_int_lt(r->targets, 16);
    r->target_force[r->targets++] = s->force;
  }
  if (p->events & CONTINUATION_BIFURCATION && r->bifurcations++ == 0) {
    r->first_bifurcation = s->force;
  }
  r->visits++;
  return r->below ? s->elongation > r->end : s->elongation < r->end;
}

/* Through both limit points and back to the beginning; the work done is the energy gained. */
START_TEST(cone_snaps_through_and_back) {
  struct error error = {.status = STATUS_OK};
  struct solid s;
  struct record r = {.end = -4e-3, .below = true};
  cone_open(&shallow, &s);
  struct continuation_options options = axi_defaults(s.model);
  options.step_max = 0.02e-3;
  struct axi_ramp ramp = {.to = {.pressure = 20, .force = -1}};
  ok(axi_follow(s.model, &ramp, &options, 1, NULL, record_visit, &r, &s.state, &error), &error);
  ck_assert_int_eq(r.limits, 2);
  ck_assert_double_lt(r.limit_force[0], r.limit_force[1]);
  ck_assert_double_gt(r.limit_force[1], 0); /* it has to be pulled back */
  ck_assert_double_lt(fabs(r.limit_stiffness[0]), 1e-2 * fabs(r.limit_force[0]) / 1e-3);
  ck_assert_int_eq(r.bifurcations, 0);
  ck_assert_int_eq(s.state.negative_free, 0);
  ck_assert_msg(r.worst < 2e-3 * r.energy, "work and energy differ by %g of %g", r.worst, r.energy);
  struct record back = {.end = 0};
  int direction = -1;
  ok(axi_follow(s.model, &ramp, &options, direction, NULL, record_visit, &back, &s.state, &error),
     &error);
  ck_assert_int_eq(back.limits, 2);
  for (int k = 0; k < 2; k++) {
    ck_assert_double_lt(fabs(back.limit_force[k] / r.limit_force[1 - k] - 1), 1e-4);
  }
  solid_close(&s);
}
END_TEST

/* With the length prescribed the same states as with the force. */
START_TEST(length_and_force_control_agree) {
  struct error error = {.status = STATUS_OK};
  static const double places[4] = {0.2, 0.4, 0.6, 0.8};
  struct solid s;
  cone_open(&shallow, &s);
  struct record r = {.end = -3.1e-3, .below = true};
  struct continuation_options options = axi_defaults(s.model);
  options.target = places;
  options.target_count = 4;
  struct axi_ramp held = {.to = {.elongation = -3.2e-3}, .held = true};
  ok(axi_follow(s.model, &held, &options, 1, NULL, record_visit, &r, &s.state, &error), &error);
  ck_assert_int_eq(r.targets, 4);
  memset(s.state.x, 0, sizeof *s.state.x * (size_t)axi_model_size(s.model));
  for (int k = 0; k < 4; k++) {
    /* From the state that is held to one that is free under the force found. */
    ok(axi_equilibrium(s.model, &(struct axi_load){.elongation = -3.2e-3 * places[k]}, true,
                       &options, &s.state, NULL, &error),
       &error);
    ck_assert_double_lt(fabs(s.state.force / r.target_force[k] - 1), 1e-6);
    double h = s.state.elongation, force = s.state.force;
    ok(axi_equilibrium(s.model, &(struct axi_load){.force = force}, false, &options, &s.state, NULL,
                       &error),
       &error);
    ck_assert_double_lt(fabs(s.state.elongation / h - 1), 1e-5);
  }
  solid_close(&s);
}
END_TEST

/* ---- a cylinder that buckles ------------------------------------------------------------- */

/* R = 100, wall 1, four half waves long: at m half waves the axial stress is E ((m pi/L)^2
 * t^2/(12 (1 - nu^2)) + 1/(R m pi/L)^2), least E t/(R sqrt(3 (1 - nu^2))) (Lorenz 1908, Timoshenko
 * 1910). Its ends slide: before, it only widens. */
static const double radius = 100;

static void cylinder_map(const void *context, double s, double t, double x[2]) {
  x[0] = radius - 0.5 + s;
  x[1] = *(const double *)context * t;
}

START_TEST(cylinder_buckles_into_rings) {
  const double nu = 0.3, young = 1e6;
  double root = sqrt(12 * (1 - nu * nu)), length = 4 * M_PI * sqrt(radius / root);
  struct error error = {.status = STATUS_OK};
  struct revolution body = {
      .cells = {1, 48}, .map = cylinder_map, .context = &length, .material = elastic(young, nu)};
  struct solid s;
  ok(revolution_mesh(&body, &s.mesh, &error), &error);
  revolution_hold(&body, &s.mesh, 1, 0, 1, AXI_FIXED);
  revolution_hold(&body, &s.mesh, 1, 1, 1, AXI_PLATE);
  ok(axi_model_create(&s.mesh, NULL, &s.model, &error), &error);
  ok(axi_state_create(s.model, &s.state, &error), &error);
  double critical = 2 * M_PI * young / sqrt(3 * (1 - nu * nu)); /* 2 pi R t E t/(R ...) */
  struct record r = {.end = -0.012 * length, .below = true};
  struct continuation_options options = axi_defaults(s.model);
  options.step_max = 0.0005 * length;
  options.lambda_step_max = 0.01;
  struct axi_ramp ramp = {.to = {.force = -critical}};
  ok(axi_follow(s.model, &ramp, &options, 1, NULL, record_visit, &r, &s.state, &error), &error);
  ck_assert_int_ge(r.bifurcations, 1);
  ck_assert_msg(fabs(r.first_bifurcation / -critical - 1) < 0.03, "buckles at %g of %g",
                r.first_bifurcation, -critical);
  ck_assert_int_eq(r.limits, 0);
  solid_close(&s);
}
END_TEST

/* ---- what is refused --------------------------------------------------------------------- */

static bool never(void *context, const struct axi_state *s, const struct continuation_point *p) {
  (void)context;
  (void)s;
  (void)p;
  return false;
}

START_TEST(wrong_models_are_refused) {
  struct error error = {.status = STATUS_OK};
  struct solid s;
  cone_open(&shallow, &s);
  struct continuation_options options = axi_defaults(s.model);
  struct axi_ramp still = {.from = {.force = 1}, .to = {.force = 1}};
  ck_assert_int_eq(axi_follow(s.model, &still, &options, 1, NULL, never, NULL, &s.state, &error),
                   STATUS_INVALID);
  struct axi_model *model = NULL;
  s.mesh.hold[0] = AXI_TIED; /* to nothing */
  ck_assert_int_eq(axi_model_create(&s.mesh, NULL, &model, &error), STATUS_INVALID);
  s.mesh.hold[0] = AXI_FREE;
  s.mesh.position[2 * s.mesh.element[0].node[8]] += 1; /* out of its element */
  ck_assert_int_eq(axi_model_create(&s.mesh, NULL, &model, &error), STATUS_GEOMETRY);
  ck_assert_ptr_null(model);
  solid_close(&s);
}
END_TEST

static Suite *path_suite(void) {
  Suite *suite = suite_create("paths of bodies of revolution");
  TCase *closed = tcase_create("closed form"), *bodies = tcase_create("bodies");
  tcase_add_loop_test(closed, springs_follow_their_closed_form, 0, 4);
  tcase_add_test(closed, a_path_ends_in_time);
  tcase_add_test(bodies, cone_snaps_through_and_back);
  tcase_add_test(bodies, length_and_force_control_agree);
  tcase_add_test(bodies, cylinder_buckles_into_rings);
  tcase_add_test(bodies, wrong_models_are_refused);
  tcase_set_timeout(bodies, 120);
  suite_add_tcase(suite, closed);
  suite_add_tcase(suite, bodies);
  return suite;
}

int main(void) {
  return suite_run(path_suite());
}
