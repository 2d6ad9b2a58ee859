/* The assembled system of a pneu-net: its tangent, and the speed of Newton's method. */
#include <check.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "solver/fe/retraction.h"
#include "solver/verify/report.h"
#include "tests/physics/pneunet_case.h"
#include "tests/physics/report.h"
#include "tests/unit/suite.h"

/* ---- tangent of the whole system ---- */

struct system_case {
  struct pneunet_case body;
  struct fe_load load;
  struct fe_state trial;
  double *v, *exact, *a, *b;
};

/* Condensed residual at the state moved by h v, the pressures following linearly. The condensed
 * operator stays that of the last tangent, so that the derivative is the condensed tangent. */
static void residual_at(struct system_case *c, double h, double *r) {
  struct fe_model *m = c->body.model;
  double *step = malloc(sizeof *step * (size_t)m->dof_count);
  ck_assert_ptr_nonnull(step);
  state_copy(m, &c->trial, &c->body.state);
  for (int i = 0; i < m->dof_count; i++) {
    step[i] = h * c->v[i];
  }
  model_recover(m, &c->trial, step, 0);
  free(step);
  for (int d = 0; d < 3 * m->mesh->node_count; d++) {
    c->trial.u[d] += m->equation[d] >= 0 ? h * c->v[m->equation[d]] : 0;
  }
  ck_assert_int_eq(model_evaluate(m, &c->trial, &c->load, false), STATUS_OK);
  memcpy(r, m->residual, sizeof *r * (size_t)m->dof_count);
}

static double system_error(void *context, double h) {
  struct system_case *c = context;
  double error = 0, size = 0;
  residual_at(c, -h, c->a);
  residual_at(c, h, c->b);
  for (int i = 0; i < c->body.model->dof_count; i++) {
    double e = (c->b[i] - c->a[i]) / (2 * h) - c->exact[i];
    error += e * e;
    size += c->exact[i] * c->exact[i];
  }
  return sqrt(error / size);
}

static void open_system(struct system_case *c, const struct job_spec *spec, double pressure) {
  case_open(&c->body, spec);
  struct fe_model *m = c->body.model;
  size_t n = (size_t)m->dof_count;
  c->load = (struct fe_load){pressure, pressure, 1};
  ck_assert_int_eq(state_create(m, &c->trial), STATUS_OK);
  c->v = malloc(4 * n * sizeof *c->v);
  ck_assert_ptr_nonnull(c->v);
  c->exact = c->v + n;
  c->a = c->exact + n;
  c->b = c->a + n;
  unsigned seed = 3;
  for (size_t i = 0; i < n; i++) {
    c->v[i] = 1e-3 * body_random(&seed);
  }
}

static void close_system(struct system_case *c) {
  free(c->v);
  state_release(&c->trial);
  case_close(&c->body);
}

static void small_spec(struct job_spec *spec, int chambers) {
  case_prototype(spec, chambers);
  case_refine(spec, 1);
  spec->mesh.gap_wall = 2;
}

START_TEST(tangent_of_the_system) {
  struct job_spec spec;
  struct system_case c;
  small_spec(&spec, 2);
  spec.contact = _i == 1;
  spec.load = (struct load_spec){.pressure_to = 40e3, .steps = 2, .gravity = {0, 0, -9.81}};
  open_system(&c, &spec, 40e3);
  if (_i == 1) { /* a state with closed chambers */
    case_follow(&c.body);
    ck_assert_int_gt(contact_summarise(&c.body.model->contact).active, 0);
  } else { /* any state */
    unsigned seed = 9;
    for (int d = 0; d < 3 * c.body.mesh.node_count; d++) {
      c.body.state.u[d] = c.body.mesh.fixed[d] ? 0 : 5e-5 * body_random(&seed);
    }
  }
  struct fe_model *m = c.body.model;
  ck_assert_int_eq(model_evaluate(m, &c.body.state, &c.load, true), STATUS_OK);
  model_multiply(m, c.v, c.exact);
  /* With contact the step has to be so short that no point changes its branch. */
  report_second_order(_i ? "system, closed chambers" : "system, random state", system_error, &c,
                      _i ? 2e-3 : 0.02, 3, 1e-6);
  close_system(&c);
}
END_TEST

/* The factor solves what model_multiply multiplies. */
START_TEST(factor_and_product_agree) {
  struct job_spec spec;
  struct system_case c;
  small_spec(&spec, 2);
  open_system(&c, &spec, 5e3);
  struct fe_model *m = c.body.model;
  ck_assert_int_eq(model_evaluate(m, &c.body.state, &c.load, true), STATUS_OK);
  model_multiply(m, c.v, c.exact);
  model_factor(m);
  model_solve(m, c.exact, c.a);
  double worst = 0;
  for (int i = 0; i < m->dof_count; i++) {
    worst = fmax(worst, fabs(c.a[i] - c.v[i]));
  }
  ck_assert_double_lt(worst, 1e-9 * 1e-3);
  close_system(&c);
}
END_TEST

/* ---- quadratic convergence ---- */

/* Newton steps taken through the retraction, as the solver takes them. */
static void newton_retracted(struct pneunet_case *c, const struct fe_load *load,
                             struct newton_log *log) {
  struct fe_model *m = c->model;
  double *du = malloc(sizeof *du * (size_t)m->dof_count);
  double *increment = calloc(3 * (size_t)m->mesh->node_count, sizeof *increment);
  struct retraction *retraction = retraction_create(m->mesh);
  ck_assert(du && increment && retraction);
  log->count = 0;
  do {
    ck_assert_int_lt(log->count, NEWTON_ITERATIONS);
    ck_assert_int_eq(model_evaluate(m, &c->state, load, true), STATUS_OK);
    model_factor(m);
    model_solve(m, m->residual, du);
    double most = 0;
    for (int i = 0; i < m->dof_count; i++) {
      du[i] = -du[i];
      most = fmax(most, fabs(du[i]));
    }
    for (int d = 0; d < 3 * m->mesh->node_count; d++) {
      increment[d] = m->equation[d] >= 0 ? du[m->equation[d]] : 0;
    }
    model_recover(m, &c->state, du, 1);
    retraction_apply(retraction, c->state.u, increment);
    log->correction[log->count++] = most;
  } while (log->correction[log->count - 1] > 1e-14);
  retraction_destroy(retraction);
  free(increment);
  free(du);
}

/* In units of the length of the body the corrections have to obey e' <= bound e^2, wherever e is
 * small enough for the bound to say something and e' is above round-off. */
static void check_quadratic(const char *what, const struct newton_log *log, double length,
                            double bound) {
  int checked = 0;
  printf("%s:", what);
  for (int k = 0; k < log->count; k++) {
    double e = log->correction[k] / length, next = log->correction[k + 1 < log->count ? k + 1 : k];
    printf(" %.1e", e);
    if (k + 1 < log->count && bound * e < 0.3 && e * e > 1e-13) {
      ck_assert_msg(next / length <= bound * e * e, "correction %.2e after %.2e", next / length, e);
      checked++;
    }
  }
  printf("\n");
  fflush(stdout);
  ck_assert_int_ge(checked, 2);
}

START_TEST(newton_is_quadratic) {
  struct job_spec spec;
  struct pneunet_case c;
  struct newton_log log;
  small_spec(&spec, 3);
  case_open(&c, &spec);
  struct fe_load load = {10e3, 10e3, 0};
  if (_i == 0) {
    struct newton_control control = {.tolerance = 1e-14, .log = &log};
    ck_assert_int_eq(newton_solve(c.model, &load, &c.state, &control), STATUS_OK);
  } else {
    newton_retracted(&c, &load, &log);
  }
  check_quadratic(_i ? "Newton with retraction" : "Newton, plain", &log, spec.pneunet.length,
                  _i ? 10 : 60);
  case_close(&c);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("newton");
  TCase *newton = tcase_create("newton");
  tcase_set_timeout(newton, 120);
  tcase_add_loop_test(newton, tangent_of_the_system, 0, 2);
  tcase_add_test(newton, factor_and_product_agree);
  tcase_add_loop_test(newton, newton_is_quadratic, 0, 2);
  suite_add_tcase(suite, newton);
  return suite_run(suite);
}
