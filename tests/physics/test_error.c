/* The error estimates of the metrics: on small bodies most of them have to cover the difference to
 * a much finer mesh, and all to be of its order. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "tests/bench/error_case.h"
#include "tests/unit/suite.h"

static const char *const jobs[] = {
    /* two chambers with a gap, no contact */
    "{ \"kind\": \"response\", \"actuator\": { \"family\": \"pneunet\", \"chamber_length\": \"8 "
    "mm\","
    " \"width\": \"24 mm\", \"height\": \"18 mm\", \"chambers\": [{ \"config\": \"B\", \"count\": "
    "2 }],"
    " \"side_wall\": \"2 mm\", \"gap_wall\": \"1.5 mm\", \"top_wall\": \"1.5 mm\","
    " \"bottom_layer\": \"4 mm\" }, \"material\": { \"model\": \"neo-hooke\", \"mu\": \"0.3 MPa\" "
    "},"
    " \"contact\": false, \"load\": { \"pressure\": { \"to\": \"20 kPa\", \"steps\": 2 } } }",
    /* two chambers that touch */
    "{ \"kind\": \"response\", \"actuator\": { \"family\": \"pneunet\", \"chamber_length\": \"8 "
    "mm\","
    " \"width\": \"24 mm\", \"height\": \"18 mm\", \"chambers\": [{ \"config\": \"B\", \"count\": "
    "2 }],"
    " \"chamber_gap\": \"1 mm\", \"side_wall\": \"2 mm\", \"gap_wall\": \"1.5 mm\","
    " \"top_wall\": \"1.5 mm\", \"bottom_layer\": \"4 mm\" },"
    " \"material\": { \"model\": \"neo-hooke\", \"mu\": \"0.3 MPa\" },"
    " \"load\": { \"pressure\": { \"to\": \"30 kPa\", \"steps\": 3 } } }",
    /* the coarsest tier */
    "{ \"kind\": \"response\", \"actuator\": { \"family\": \"pneunet\", \"chamber_length\": \"7 "
    "mm\","
    " \"width\": \"20 mm\", \"height\": \"15 mm\", \"chambers\": [{ \"config\": \"B\", \"count\": "
    "2 }],"
    " \"side_wall\": \"1.5 mm\", \"gap_wall\": \"1.2 mm\", \"top_wall\": \"1.5 mm\","
    " \"bottom_layer\": \"3 mm\" }, \"material\": { \"model\": \"neo-hooke\", \"mu\": \"0.3 MPa\" "
    "},"
    " \"contact\": false, \"accuracy\": \"fast\","
    " \"load\": { \"pressure\": { \"to\": \"15 kPa\", \"steps\": 2 } } }",
};
enum { JOBS = sizeof jobs / sizeof *jobs };

/* Largest true error of the angles and the tip that a tier may have, as part of the value. */
static double promise(const struct job_spec *spec) {
  return spec->accuracy == ACCURACY_FAST ? 0.03 : 0.02;
}

START_TEST(estimates_cover_the_true_errors) {
  struct job_spec spec;
  struct error error = {0};
  struct error_case c;
  int covered = 0, near = 0;
  ck_assert_int_eq(job_spec_read(jobs[_i], strlen(jobs[_i]), &spec, &error), STATUS_OK);
  ck_assert_msg(error_case_run(&spec, &c, &error) == STATUS_OK, "%s", error.message);
  ck_assert_int_gt(c.reference_unknowns, 6 * c.unknowns);
  for (int k = 0; k < ERROR_METRICS; k++) {
    const struct error_metric *m = &c.metric[k];
    printf("job %d, %s: %.6g, true error %.2g, estimate %.2g\n", _i, m->name, m->value,
           m->value - m->reference, m->estimate);
    ck_assert_double_gt(m->estimate, 0);
    ck_assert_double_gt(3 * m->estimate, error_case_truth(m));
    covered += error_case_covers(m);
    near += error_case_is_near(m);
    if (k < 4) { /* the others are not what a tier promises */
      ck_assert_double_lt(fabs(m->value / m->reference - 1), promise(&spec));
    }
  }
  ck_assert_int_ge(covered, ERROR_METRICS - 2);
  ck_assert_int_ge(near, ERROR_METRICS / 2);
}
END_TEST

/* Without the estimate there is none, and the values are the same. */
START_TEST(estimate_can_be_switched_off) {
  struct job_spec spec;
  struct error error = {0};
  struct error_case with, without;
  ck_assert_int_eq(job_spec_read(jobs[0], strlen(jobs[0]), &spec, &error), STATUS_OK);
  ck_assert_int_eq(error_case_metrics(&spec, &with, &error), STATUS_OK);
  spec.error_estimate = false;
  ck_assert_int_eq(error_case_metrics(&spec, &without, &error), STATUS_OK);
  for (int k = 0; k < ERROR_METRICS; k++) {
    ck_assert(!isnan(with.metric[k].estimate) && isnan(without.metric[k].estimate));
    ck_assert(with.metric[k].value == without.metric[k].value);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("error");
  TCase *test = tcase_create("estimates");
  tcase_set_timeout(test, 300);
  tcase_add_loop_test(test, estimates_cover_the_true_errors, 0, JOBS);
  tcase_add_test(test, estimate_can_be_switched_off);
  suite_add_tcase(suite, test);
  return suite_run(suite);
}
