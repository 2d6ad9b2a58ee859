/* The hybrid model derived from a law against the closed form of the law, and as it is simulated.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "solver/bistable/hybrid.h"
#include "solver/bistable/simulate.h"
#include "solver/hlpv/simulate.h"
#include "tests/physics/fold_law.h"
#include "tests/unit/suite.h"

enum { PAIRS = 3 };

#define LARGEST 60e3

/* Three pairs of the folding law under a ramp. */
struct fixture {
  struct bistable_spec spec;
  struct bistable_system system;
  struct bistable_trajectory t;
  struct hybrid hybrid;
};

static double ramp_time[] = {0.0, 12.0}, ramp_value[] = {0.0, LARGEST};

static void set_up(struct fixture *f) {
  static const double levels[] = {-40e3, -20e3, 0.0, 20e3, 40e3, 60e3};
  struct error error = {.status = STATUS_OK};
  struct bistable_options options = {0};
  struct bistable_spec *spec = &f->spec;
  *spec = (struct bistable_spec){.law_count = 1, .cell_count = PAIRS, .actuator_count = 1};
  spec->law[0].is_table = true;
  fold_table(&fold_pair, 6, levels, 120, -2.5e-3, 13e-3, &spec->law[0].table);
  for (int i = 0; i < PAIRS; i++) {
    spec->cell[i] = (struct cell_spec){.stiffness = 1.0 + 0.03 * (i - 1),
                                       .size = 1.0,
                                       .mass = 0.012,
                                       .damping = 6.0,
                                       .elongation = NAN,
                                       .stop_from = -INFINITY,
                                       .stop_to = INFINITY};
  }
  spec->actuator[0].cell_count = PAIRS;
  spec->actuator[0].supply = (struct supply_spec){.model = SUPPLY_CHAMBER,
                                                  .dead_volume = 20e-6,
                                                  .conductance = 5e-9,
                                                  .exponent = 1.4,
                                                  .atmosphere = 101325.0};
  spec->actuator[0].input = (struct hlpv_input){
      .profile = HLPV_LINEAR, .count = 2, .time = ramp_time, .value = ramp_value};
  spec->plate_mass = 0.03;
  spec->initial_pressure = NAN;
  spec->end = 12.0;
  spec->sample_rate = 10.0;
  spec->tolerance = 1e-9;
  ck_assert_msg(system_open(spec, &f->system, &error) == STATUS_OK, "%s", error.message);
  ck_assert_msg(bistable_simulate(&f->system, &options, &f->t, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_msg(hybrid_derive(&f->system, LARGEST, &f->t, &f->hybrid, &error) == STATUS_OK, "%s",
                error.message);
}

static void tear_down(struct fixture *f) {
  bistable_trajectory_release(&f->t);
  system_close(&f->system);
  law_table_release(&f->spec.law[0].table);
}

/* The inner elongations at which U' = a x (x - x1) (x - x2) is extreme. */
static double extreme(int side) {
  const struct fold *f = &fold_pair;
  double root = sqrt(f->x1 * f->x1 + f->x2 * f->x2 - f->x1 * f->x2);
  return (f->x1 + f->x2 + (side ? root : -root)) / 3.0;
}

/* Elongation of one pair at rest under p, by bisection in x outside the extremum. */
static double rest(int side, double p) {
  double low = side ? extreme(1) : -5e-3, high = side ? 20e-3 : extreme(0), state[4];
  for (int i = 0; i < 200; i++) {
    double middle = 0.5 * (low + high);
    fold_state(&fold_pair, middle, p, state);
    if (state[1] < 0.0) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return state[0];
}

static double limit_pressure(int side) {
  double state[4];
  fold_state(&fold_pair, extreme(side), 0.0, state);
  return state[1] / (fold_pair.A + fold_pair.B);
}

START_TEST(numbers_follow_from_the_law) {
  struct fixture f;
  set_up(&f);
  const struct hybrid *h = &f.hybrid;
  double state[4], natural = rest(1, 0.0);
  ck_assert_double_eq_tol(h->trigger, limit_pressure(0), 0.002 * limit_pressure(0));
  ck_assert_double_eq_tol(h->release, limit_pressure(1), -0.002 * limit_pressure(1));
  ck_assert_double_eq_tol(h->natural, PAIRS * natural, 1e-6);
  fold_state(&fold_pair, fold_inner(&fold_pair, 1, natural, LARGEST), LARGEST, state);
  ck_assert_double_eq_tol(h->gamma, -state[1] / LARGEST, 1e-4 * h->gamma);
  /* 1/2 of a pair and the plate, and the junctions at 1/3 and 2/3 of its speed */
  ck_assert_double_eq_tol(h->mass, 0.036 + 0.012 * (1.0 / 9.0 + 4.0 / 9.0), 1e-12);
  ck_assert_double_eq_tol(h->damping, 2.0, 1e-12);
  double differences[2] = {0.0, 0.0};
  for (int side = 0; side < 2; side++) {
    double from = h->release, to = side ? LARGEST : h->trigger, margin = 0.03 * (to - from);
    for (double u = from + margin; u < to - margin; u += 997.0) {
      double k = 0.0;
      for (int j = h->count[side] - 1; j >= 0; j--) {
        k = k * u / 1e3 + h->k[side][j];
      }
      double model = (side ? h->natural : 0.0) + h->gamma * u / k;
      differences[side] = fmax(differences[side], fabs(model - PAIRS * rest(side, u)));
    }
    ck_assert_double_lt(differences[side], 1.1 * h->error[side] + 1e-6);
    ck_assert_double_lt(h->error[side], HYBRID_FIT * h->natural);
  }
  tear_down(&f);
}
END_TEST

/* The job that is derived is valid; simulated, it rests where the law does, to HYBRID_FIT of the
 * travel, snaps between the steps around its trigger and stays stretched; another one goes back
 * through vacuum, and under a slow ramp the snap comes at the trigger. */
START_TEST(the_derived_job_rests_where_the_law_does) {
  struct fixture f;
  set_up(&f);
  json_t *job = hybrid_job(&f.hybrid, "three pairs", 0.082, LARGEST);
  ck_assert_ptr_nonnull(job);
  if (_i == 1) {
    json_object_set_new(job, "input",
                        json_pack("{s:[[s, s], [s, s], [s, s]]}", "hold", "0 s", "0 kPa", "5 s",
                                  "50 kPa", "10 s", "-35 kPa"));
    json_object_set_new(job, "end", json_string("15 s"));
  }
  if (_i == 2) {
    json_object_set_new(
        job, "input",
        json_pack("{s:[[s, s], [s, s]]}", "linear", "0 s", "0 kPa", "100 s", "50 kPa"));
    json_object_set_new(job, "end", json_string("100 s"));
  }
  char *text = json_dumps(job, 0);
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  struct hlpv_trajectory t;
  struct hlpv_options options = {0};
  ck_assert_msg(job_spec_read(text, strlen(text), &spec, &error) == STATUS_OK, "%s: %s",
                error.pointer, error.message);
  ck_assert_msg(hlpv_simulate(spec.hlpv, &options, &t, &error) == STATUS_OK, "%s", error.message);
  double travel = PAIRS * rest(1, 0.0);
  if (_i == 0) {
    ck_assert_uint_eq(t.event_count, 1);
    for (size_t i = 0; i < t.hold_count; i++) {
      const struct hlpv_hold *hold = &t.hold[i];
      int side = i > 4; /* 37.5 kPa, the fifth step, is beyond the trigger */
      ck_assert_int_eq(hold->mode, side);
      ck_assert_double_eq_tol(hold->last[HLPV_H], PAIRS * rest(side, hold->set_point),
                              HYBRID_FIT * travel);
    }
  } else if (_i == 1) {
    ck_assert_uint_eq(t.event_count, 2);
    ck_assert_int_eq(t.mode, 0);
  } else {
    ck_assert_uint_eq(t.event_count, 1);
    ck_assert_double_eq_tol(t.event[0].before[HLPV_PRESSURE], limit_pressure(0),
                            0.02 * limit_pressure(0));
  }
  hlpv_trajectory_release(&t);
  job_spec_release(&spec);
  free(text);
  json_decref(job);
  tear_down(&f);
}
END_TEST

/* The reset is a state of the simulated motion just after the last snap. */
START_TEST(the_reset_is_from_the_motion) {
  struct fixture f;
  set_up(&f);
  ck_assert_uint_ge(f.t.event_count, PAIRS);
  const struct bistable_event *last = &f.t.event[f.t.event_count - 1];
  ck_assert_int_eq(last->type, EVENT_SNAP);
  ck_assert_double_eq_tol(f.hybrid.reset_h, last->trigger_h + last->travel, 1e-9);
  ck_assert_double_gt(f.hybrid.reset_h, f.hybrid.natural);
  ck_assert_double_lt(fabs(f.hybrid.reset_velocity), 0.02 * last->peak_speed);
  ck_assert_double_lt(f.hybrid.reset_pressure, last->trigger_pressure);
  tear_down(&f);
}
END_TEST

/* A law without a fall has no hybrid model. */
START_TEST(without_a_trigger_there_is_none) {
  struct bistable_spec spec = {.law_count = 1, .cell_count = 1, .actuator_count = 1};
  struct bistable_system system;
  struct hybrid hybrid;
  struct error error = {.status = STATUS_OK};
  spec.law[0] = (struct law_spec){
      .count = 2, .per = 1e-3, .c = {0.0, 2.0}, .area = 8e-4, .from = -1e-3, .to = 1e-2};
  spec.cell[0] = (struct cell_spec){.stiffness = 1.0, .size = 1.0, .mass = 0.01};
  spec.actuator[0].cell_count = 1;
  ck_assert_int_eq(system_open(&spec, &system, &error), STATUS_OK);
  ck_assert_int_eq(hybrid_derive(&system, LARGEST, NULL, &hybrid, &error), STATUS_INVALID);
  system_close(&system);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("bistable: hybrid models");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 60);
  tcase_add_test(tcase, numbers_follow_from_the_law);
  tcase_add_loop_test(tcase, the_derived_job_rests_where_the_law_does, 0, 3);
  tcase_add_test(tcase, the_reset_is_from_the_motion);
  tcase_add_test(tcase, without_a_trigger_there_is_none);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
