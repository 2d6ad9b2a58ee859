/* Where load paths end: limit points, passed by arc length, and other causes. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/base/clock.h"
#include "solver/job/material.h"
#include "solver/post/result.h"
#include "solver/verify/inflation.h"
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* ---- a soft body that balloons ---- */

enum { STATES_MAX = 60 };

/* Every state that a path has shown. */
struct trace {
  const struct fe_model *model;
  int count;
  bool arc[STATES_MAX], recorded[STATES_MAX];
  double pressure[STATES_MAX];
  struct fe_state state[STATES_MAX];
  int cancel_at; /* number of states after which the work is cancelled; 0: never */
};

static enum status keep(void *context, const struct path_point *point) {
  struct trace *t = context;
  ck_assert_int_lt(t->count, STATES_MAX);
  ck_assert_int_eq(state_create(t->model, &t->state[t->count]), STATUS_OK);
  state_copy(t->model, &t->state[t->count], point->state);
  t->pressure[t->count] = point->pressure;
  t->arc[t->count] = point->arc;
  t->recorded[t->count] = point->recorded;
  t->count++;
  return STATUS_OK;
}

static bool enough(void *context) {
  const struct trace *t = context;
  return t->cancel_at > 0 && t->count >= t->cancel_at;
}

static void trace_release(struct trace *t) {
  for (int k = 0; k < t->count; k++) {
    state_release(&t->state[k]);
  }
}

static void soft_spec(struct job_spec *spec, int chambers, double pressure, int steps) {
  case_prototype(spec, chambers);
  struct pneunet_spec *p = &spec->pneunet;
  p->side_wall = p->gap_wall = p->top_wall = 0.0015;
  p->cavity_length = 0.005;
  p->taper_left = p->taper_right = 0;
  spec->material = *material_find("ecoflex-00-30");
  spec->mesh = (struct mesh_spec){1, 1, 1, 1, 1, 1, 1, 1};
  spec->contact = true;
  spec->load = (struct load_spec){.pressure_to = pressure, .steps = steps};
}

static enum status follow(struct pneunet_case *c, struct trace *t, struct error *error) {
  struct path_options path = {.pressure_to = c->spec.load.pressure_to,
                              .steps = c->spec.load.steps,
                              .visit = keep,
                              .context = t};
  *error = (struct error){0};
  t->model = c->model;
  return path_follow(c->solver, &path, &c->state, error);
}

static double norm(const double *v, int count) {
  double sum = 0;
  for (int i = 0; i < count; i++) {
    sum += v[i] * v[i];
  }
  return sqrt(sum);
}

/* Residual of a state under a pressure, relative to the force of the pressure, in a model of its
 * own. */
static double imbalance(const struct pneunet_case *c, const struct fe_state *state,
                        double pressure) {
  struct fe_model *m;
  struct error error = {0};
  struct fe_load load = {.pressure = pressure};
  ck_assert_int_eq(model_create(&c->mesh, &c->spec.material, true, &m, &error), STATUS_OK);
  double *gradient = calloc((size_t)m->dof_count, sizeof *gradient);
  ck_assert_ptr_nonnull(gradient);
  model_use_multipliers(m, state);
  ck_assert_int_eq(model_search_contact(m, state), STATUS_OK);
  ck_assert_int_eq(model_evaluate(m, state, &load, false), STATUS_OK);
  model_volume(m, state, gradient);
  double result = norm(m->residual, m->dof_count) / (pressure * norm(gradient, m->dof_count));
  free(gradient);
  model_destroy(m);
  return result;
}

static int highest(const struct trace *t) {
  int top = 0;
  for (int k = 1; k < t->count; k++) {
    top = t->pressure[k] > t->pressure[top] ? k : top;
  }
  return top;
}

/* The states on both sides of the limit point are equilibria, the cavity grows along all of them,
 * and the message gives the largest pressure. */
START_TEST(ballooning_ends_at_a_limit_point) {
  struct job_spec spec;
  struct pneunet_case c;
  struct trace t = {.count = 0};
  struct error error;
  double limit, beyond, worst[2] = {0, 0}, volume = 0;
  soft_spec(&spec, 2, 20e3, 10);
  case_open(&c, &spec);
  c.solver->options.step_tolerance *= 1e-2;
  c.solver->options.traction_tolerance *= 1e-3;
  ck_assert_int_eq(follow(&c, &t, &error), STATUS_LIMIT_POINT);
  ck_assert_int_eq(error.status, STATUS_LIMIT_POINT);
  const char *number = strstr(error.message, "beyond ");
  ck_assert_ptr_nonnull(number);
  ck_assert_int_eq(sscanf(number, "beyond %lf kPa", &limit), 1);
  number = strstr(error.message, "down to ");
  ck_assert_ptr_nonnull(number);
  ck_assert_int_eq(sscanf(number, "down to %lf kPa", &beyond), 1);
  int top = highest(&t);
  ck_assert_double_eq_tol(1e3 * limit, t.pressure[top], 1e-4 * t.pressure[top]);
  ck_assert_int_ge(t.count - 1 - top, 3);
  ck_assert_double_lt(beyond, 0.99 * limit);
  for (int k = 1; k < t.count; k++) {
    worst[k > top] = fmax(worst[k > top], imbalance(&c, &t.state[k], t.pressure[k]));
    double now = model_volume(c.model, &t.state[k], NULL);
    ck_assert(k <= top || (t.arc[k] && !t.recorded[k]));
    ck_assert_double_ge(now, volume);
    ck_assert(k <= top + 1 || t.pressure[k] < t.pressure[k - 1]);
    volume = now;
  }
  ck_assert_double_eq_tol(1e3 * beyond, t.pressure[t.count - 1], 1e-4 * t.pressure[top]);
  report_value("2 soft chambers, imbalance before the limit point", "coarse", 0, worst[0]);
  report_value("2 soft chambers, imbalance beyond it", "coarse", 0, worst[1]);
  ck_assert_double_lt(fmax(worst[0], worst[1]), 1e-3);
  /* What path_follow leaves behind is the state before the limit point. */
  ck_assert_double_lt(imbalance(&c, &c.state, t.pressure[top]), 1e-3);
  trace_release(&t);
  case_close(&c);
}
END_TEST

static double limit_of(int chambers, double pressure, int steps) {
  struct job_spec spec;
  struct pneunet_case c;
  struct trace t = {.count = 0};
  struct error error;
  soft_spec(&spec, chambers, pressure, steps);
  case_open(&c, &spec);
  ck_assert_int_eq(follow(&c, &t, &error), STATUS_LIMIT_POINT);
  double limit = t.pressure[highest(&t)];
  trace_release(&t);
  case_close(&c);
  return limit;
}

START_TEST(limit_does_not_depend_on_steps) {
  static const struct {
    double pressure;
    int steps;
  } paths[] = {{20e3, 10}, {20e3, 1}, {8e3, 10}, {50e3, 20}, {6e3, 3}};
  double first = 0;
  for (int k = 0; k < (SANITIZED ? 3 : 5); k++) {
    char name[60];
    double limit = limit_of(1, paths[k].pressure, paths[k].steps);
    first = k == 0 ? limit : first;
    snprintf(name, sizeof name, "%g kPa in %d steps", 1e-3 * paths[k].pressure, paths[k].steps);
    report_check("soft chamber, limit pressure, Pa", name, first, limit, 5e-3);
  }
  /* Just below it there is an equilibrium, and the path gets there. */
  struct job_spec spec;
  soft_spec(&spec, 1, 0.99 * first, 2);
  ck_assert_double_gt(case_angle_of(&spec), 0);
}
END_TEST

/* The same job gives the same numbers, to the last bit, on its way through contact and arc. */
START_TEST(paths_repeat_to_the_last_bit) {
  struct trace t[2] = {{.cancel_at = 12}, {.cancel_at = 12}};
  struct pneunet_case c[2];
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    struct error error;
    soft_spec(&spec, 2, 8e3, 4);
    case_open(&c[k], &spec);
    c[k].solver->options.cancelled = enough;
    c[k].solver->options.cancel_context = &t[k];
    ck_assert_int_eq(follow(&c[k], &t[k], &error), STATUS_CANCELLED);
    ck_assert(t[k].arc[t[k].count - 1]);
    ck_assert_int_gt(contact_summarise(&c[k].model->contact).active, 0);
  }
  const struct mesh *mesh = &c[0].mesh;
  ck_assert_int_eq(t[0].count, t[1].count);
  for (int s = 0; s < t[0].count; s++) {
    const struct fe_state *a = &t[0].state[s], *b = &t[1].state[s];
    ck_assert_mem_eq(&t[0].pressure[s], &t[1].pressure[s], sizeof t[0].pressure[s]);
    ck_assert_mem_eq(a->u, b->u, sizeof *a->u * 3 * (size_t)mesh->node_count);
    ck_assert_mem_eq(a->p, b->p, sizeof *a->p * ELEMENT_PRESSURES * (size_t)mesh->element_count);
    ck_assert_mem_eq(a->lambda, b->lambda,
                     sizeof *a->lambda * (size_t)c[0].model->contact.point_count);
  }
  for (int k = 0; k < 2; k++) {
    trace_release(&t[k]);
    case_close(&c[k]);
  }
}
END_TEST

/* ---- a thick sphere, whose limit pressure is known ---- */

/* Pressure that widens the inner radius of a sphere of radii 1 and 2 to a: the integral of
 * W'(l) / (l^3 - 1) over the stretches of the wall; without volume change. */
static double sphere_pressure(const struct material_spec *m, double a) {
  enum { PARTS = 200 };
  double b = cbrt(1 + (a * a * a - 1) / 8), h = (a - b) / PARTS, sum = 0;
  for (int k = 0; k <= PARTS; k++) {
    double l = b + k * h, i1 = 2 * l * l + 1 / (l * l * l * l) - 3;
    double slope = m->model == MATERIAL_NEO_HOOKE
                       ? 0.5 * m->c[0]
                       : m->c[0] + 2 * m->c[1] * i1 + 3 * m->c[2] * i1 * i1;
    double weight = k == 0 || k == PARTS ? 1 : k % 2 ? 4 : 2;
    sum += weight * slope * 4 * (1 / (l * l) + 1 / (l * l * l * l * l));
  }
  return sum * h / 3;
}

static double sphere_limit(const struct material_spec *m) {
  double limit = 0, a = 1.01;
  while (sphere_pressure(m, a) > limit) {
    limit = sphere_pressure(m, a);
    a += 1e-3;
  }
  return limit;
}

static enum status keep_highest(void *context, const struct path_point *point) {
  double *top = context;
  *top = fmax(*top, point->pressure);
  return STATUS_OK;
}

START_TEST(sphere_reaches_its_limit_pressure) {
  static const struct {
    const char *name;
    struct material_spec material;
  } spheres[2] = {{"thick sphere, neo-Hooke, limit pressure over mu",
                   {.model = MATERIAL_NEO_HOOKE, .terms = 1, .c = {1}, .bulk_ratio = 1e4}},
                  {"thick sphere, softening Yeoh, limit pressure over c1",
                   {.model = MATERIAL_YEOH, .terms = 3, .c = {1, -0.2, 0.01}, .bulk_ratio = 1e4}}};
  struct inflation sphere;
  struct equilibrium *solver;
  struct error error = {0};
  struct verify_run run = {.refinement = 1};
  double top = 0, exact = sphere_limit(&spheres[_i].material);
  ck_assert_int_eq(inflation_open(&sphere, &inflation_sphere, &spheres[_i].material, 2, 2, &error),
                   STATUS_OK);
  ck_assert_int_eq(equilibrium_create(sphere.body.model, &solver, &error), STATUS_OK);
  struct path_options path = {
      .pressure_to = 3 * exact, .steps = 10, .visit = keep_highest, .context = &top};
  enum status status = path_follow(solver, &path, &sphere.body.state, &error);
  printf("%s: %s\n", spheres[_i].name, error.message);
  ck_assert_int_eq(status, STATUS_LIMIT_POINT);
  report_check(spheres[_i].name, "2 through the wall, 3 x 2 x 2 around", exact, top, 5e-3);
  equilibrium_destroy(solver);
  verify_body_close(&run, &sphere.body);
}
END_TEST

/* ---- other causes ---- */

/* Out of time before the first step: nothing has moved. */
START_TEST(past_deadline_stops_at_once) {
  struct job_spec spec;
  struct pneunet_case c;
  struct trace t = {.count = 0};
  struct error error;
  soft_spec(&spec, 1, 1e3, 2);
  case_open(&c, &spec);
  c.solver->options.deadline_s = clock_wall_s() - 1;
  ck_assert_int_eq(follow(&c, &t, &error), STATUS_TIMEOUT);
  ck_assert_int_eq(error.status, STATUS_TIMEOUT);
  ck_assert_ptr_nonnull(strstr(error.message, "0 kPa"));
  ck_assert_int_eq(t.count, 1);
  ck_assert_double_eq(norm(c.state.u, 3 * c.mesh.node_count), 0);
  trace_release(&t);
  case_close(&c);
}
END_TEST

/* Cancelled on the way up, or on the arc: the state that is left is an equilibrium. */
START_TEST(cancelled_path_keeps_its_last_state) {
  static const int at[2] = {2, 20};
  for (int k = 0; k < 2; k++) {
    struct job_spec spec;
    struct pneunet_case c;
    struct error error;
    struct trace t = {.cancel_at = at[k]};
    soft_spec(&spec, 1, 8e3, 10);
    case_open(&c, &spec);
    c.solver->options.cancelled = enough;
    c.solver->options.cancel_context = &t;
    ck_assert_int_eq(follow(&c, &t, &error), STATUS_CANCELLED);
    ck_assert_int_eq(error.status, STATUS_CANCELLED);
    ck_assert_int_eq(t.count, at[k]);
    ck_assert(k == 0 || t.arc[t.count - 1]);
    int top = highest(&t);
    ck_assert_double_lt(imbalance(&c, &c.state, t.pressure[top]), 1e-3);
    trace_release(&t);
    case_close(&c);
  }
}
END_TEST

static enum status add_sample(void *context, const struct path_point *point) {
  return result_add(context, point);
}

/* A law that has lost its stability where the path ends is named as the cause. */
START_TEST(unstable_material_is_the_cause) {
  struct job_spec spec;
  struct pneunet_case c;
  struct error error = {0};
  case_prototype(&spec, 2);
  spec.mesh = (struct mesh_spec){1, 1, 1, 1, 1, 1, 1, 1};
  spec.contact = true;
  spec.load.pressure_to = 200e3;
  spec.material = (struct material_spec){.model = MATERIAL_YEOH,
                                         .terms = 2,
                                         .c = {0.1e6, -0.3e6},
                                         .bulk_ratio = 1000,
                                         .density_kg_m3 = 1000};
  case_open(&c, &spec);
  struct result *result = result_create(&spec, c.model);
  ck_assert_ptr_nonnull(result);
  struct path_options path = {
      .pressure_to = 200e3, .steps = 10, .visit = add_sample, .context = result};
  enum status status = path_follow(c.solver, &path, &c.state, &error);
  printf("unstable law: %s\n", error.message);
  ck_assert_int_ne(status, STATUS_OK);
  status = result_cause(result, status, &error);
  printf("unstable law: %s\n", error.message);
  ck_assert_int_eq(status, STATUS_UNSTABLE);
  ck_assert_int_eq(error.status, STATUS_UNSTABLE);
  ck_assert_str_eq(status_word(status), "material_instability");
  ck_assert_ptr_nonnull(strstr(error.message, "stretch"));
  result_destroy(result);
  case_close(&c);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("path_limits");
  TCase *limits = tcase_create("path_limits");
  tcase_set_timeout(limits, 100);
  tcase_add_test(limits, ballooning_ends_at_a_limit_point);
  tcase_add_test(limits, limit_does_not_depend_on_steps);
  tcase_add_test(limits, paths_repeat_to_the_last_bit);
  tcase_add_loop_test(limits, sphere_reaches_its_limit_pressure, 0, 2);
  tcase_add_test(limits, past_deadline_stops_at_once);
  tcase_add_test(limits, cancelled_path_keeps_its_last_state);
  tcase_add_test(limits, unstable_material_is_the_cause);
  suite_add_tcase(suite, limits);
  return suite_run(suite);
}
