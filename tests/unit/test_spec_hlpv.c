/* From the text of an hlpv job to its model: units, polynomials, tables, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/job/hlpv.h"
#include "tests/unit/suite.h"

/* %s: modes; transitions; initial; input and all after it. */
static const char form[] = "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"60 g\", \"gamma\": "
                           "\"5.577 N/psi\", \"modes\": %s, "
                           "\"transitions\": %s}, \"initial\": %s, %s}";
static const char modes[] =
    "{\"low\": {\"stiffness\": {\"per\": \"psi\", \"coefficients\": [\"3600 N/m\", \"-316 N/m\", "
    "\"2 N/m\"]}, \"damping\": \"6 N s/m\", \"alpha\": \"-9 1/s\", \"beta\": \"9 1/s\"}, \"high\": "
    "{\"rest\": \"28 mm\", \"stiffness\": \"2 kN/m\", \"damping\": {\"per\": \"kPa\", "
    "\"coefficients\": [\"1 N s/m\", \"0.5 N s/m\"]}, \"alpha\": \"-540 1/min\", \"beta\": \"9 "
    "Hz\", "
    "\"range\": [\"0 psi\", \"8 psi\"]}}";
static const char transitions[] =
    "[{\"from\": \"low\", \"to\": \"high\", \"when\": {\"h\": \"14.06 mm\", \"direction\": "
    "\"rising\"}, \"reset\": {\"h\": \"44.7 mm\", \"velocity\": {\"times\": -0.5}}}]";
static const char initial[] = "{\"mode\": \"low\", \"h\": \"1 cm\", \"pressure\": \"1 psi\"}";
static const char input[] =
    "\"input\": {\"hold\": [[\"0 s\", \"3 psi\"], [\"0.5 min\", \"-10 kPa\"]]}, \"end\": \"1 min\"";

#define PSI 6894.757293168361

static enum status read_parts(const char *m, const char *t, const char *i, const char *rest,
                              struct job_spec *spec, struct error *error) {
  static char text[4000];
  *error = (struct error){.status = STATUS_OK};
  snprintf(text, sizeof text, form, m ? m : modes, t ? t : transitions, i ? i : initial,
           rest ? rest : input);
  return job_spec_read(text, strlen(text), spec, error);
}

START_TEST(a_model_arrives_in_si_units) {
  struct job_spec spec;
  struct error error;
  ck_assert_msg(read_parts(NULL, NULL, NULL, NULL, &spec, &error) == STATUS_OK, "%s",
                error.message);
  ck_assert_int_eq(spec.kind, JOB_HLPV);
  const struct hlpv_spec *m = spec.hlpv;
  suite_check_near(m->mass, 0.06);
  suite_check_near(m->gamma, 5.577 / PSI);
  ck_assert_int_eq(m->mode_count, 2);
  ck_assert_str_eq(m->mode[1].name, "high");
  suite_check_near(hlpv_polynomial_value(&m->mode[0].stiffness, 4.0 * PSI),
                   3600.0 - 4.0 * 316.0 + 16.0 * 2.0);
  suite_check_near(hlpv_polynomial_value(&m->mode[1].damping, 3e3), 2.5);
  suite_check_near(m->mode[1].alpha.c[0], -9.0);
  suite_check_near(m->mode[1].rest, 0.028);
  ck_assert(isinf(m->mode[0].from) && isinf(m->mode[0].to));
  suite_check_near(m->mode[1].to, 8.0 * PSI);
  const struct hlpv_transition *t = &m->transition[0];
  ck_assert(t->from == 0 && t->to == 1 && t->direction == 1 && t->quantity == HLPV_H);
  suite_check_near(t->level, 0.01406);
  ck_assert_double_eq(t->reset[HLPV_H].factor, 0.0);
  suite_check_near(t->reset[HLPV_H].value, 0.0447);
  ck_assert_double_eq(t->reset[HLPV_VELOCITY].factor, -0.5);
  ck_assert_double_eq(t->reset[HLPV_PRESSURE].factor, 1.0);
  suite_check_near(m->initial[HLPV_H], 0.01);
  suite_check_near(m->initial[HLPV_PRESSURE], PSI);
  suite_check_near(m->end, 60.0);
  suite_check_near(m->sample_rate, 120.0);
  ck_assert_double_eq(m->rest_length, 0.0);
  job_spec_release(&spec);
  ck_assert_ptr_null(spec.hlpv);
}
END_TEST

START_TEST(the_derivative_is_that_of_the_model) {
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(read_parts(NULL, NULL, NULL, NULL, &spec, &error), STATUS_OK);
  const double x[HLPV_STATES] = {0.03, 0.2, 2.0 * PSI};
  double rate[HLPV_STATES];
  hlpv_derivative(spec.hlpv, 1, 1e4, x, rate);
  suite_check_near(rate[HLPV_H], 0.2);
  suite_check_near(rate[HLPV_VELOCITY], (2.0 * 5.577 - 2000.0 * 0.002 - 6.0 * 0.2) / 0.06);
  suite_check_near(rate[HLPV_PRESSURE], 9.0 * (1e4 - 2.0 * PSI));
  job_spec_release(&spec);
}
END_TEST

/* Stiffness and rest from states of rest, which the derivative then leaves at rest. */
START_TEST(states_of_rest_give_the_stiffness) {
  struct job_spec spec;
  struct error error;
  static const char steady_modes[] =
      "{\"low\": {\"rest\": \"1 mm\", \"stiffness\": {\"per\": \"kPa\", \"states\": [[\"10 kPa\", "
      "\"3 mm\"], [\"-20 kPa\", \"-5 mm\"], [\"40 kPa\", \"20 mm\"]]}, \"damping\": \"6 N s/m\", "
      "\"alpha\": \"-9 1/s\", \"beta\": \"9 1/s\"}, \"high\": {\"stiffness\": {\"slope\": [\"10 "
      "kPa\", \"4 mm\"], \"states\": [[\"30 kPa\", \"50 mm\"]], \"times\": 2}, \"damping\": \"6 N "
      "s/m\", \"alpha\": \"-9 1/s\", \"beta\": \"9 1/s\"}}";
  static const char steady_transitions[] =
      "[{\"from\": \"low\", \"to\": \"high\", \"when\": {\"h\": {\"steady\": \"40 kPa\"}, "
      "\"direction\": \"rising\"}, \"reset\": {\"h\": {\"steady\": \"20 kPa\"}}}]";
  ck_assert_msg(read_parts(steady_modes, steady_transitions, NULL, NULL, &spec, &error) ==
                    STATUS_OK,
                "%s", error.message);
  static const double states[][2] = {{1e4, 3e-3}, {-2e4, -5e-3}, {4e4, 20e-3}};
  for (int i = 0; i < 3; i++) {
    const double x[HLPV_STATES] = {states[i][1], 0.0, states[i][0]};
    double rate[HLPV_STATES];
    hlpv_derivative(spec.hlpv, 0, states[i][0], x, rate);
    ck_assert_double_eq_tol(rate[HLPV_VELOCITY], 0.0, 1e-9);
    ck_assert_double_eq_tol(rate[HLPV_PRESSURE], 0.0, 1e-9);
  }
  /* k = gamma 10 kPa / 4 mm, twice; at rest 50 mm - 30 kPa 4 mm / 10 kPa */
  suite_check_near(spec.hlpv->mode[1].stiffness.c[0], 2.0 * spec.hlpv->gamma * 1e4 / 4e-3);
  suite_check_near(spec.hlpv->mode[1].rest, 38e-3);
  suite_check_near(spec.hlpv->transition[0].level, 20e-3);
  suite_check_near(spec.hlpv->transition[0].reset[HLPV_H].value, 38e-3 + 20.0 / 10.0 * 4e-3 / 2.0);
  job_spec_release(&spec);
}
END_TEST

/* Set-points at 0, 1, 1.5 and 9 s. */
static const struct {
  const char *input;
  double value[4]; /* kPa */
} profiles[] = {
    {"\"input\": {\"hold\": [[\"0 s\", \"1 kPa\"], [\"1 s\", \"3 kPa\"], [\"2 s\", \"0 kPa\"]]}",
     {1, 3, 3, 0}},
    {"\"input\": {\"linear\": [[\"0 s\", \"1 kPa\"], [\"2 s\", \"3 kPa\"]]}", {1, 2, 2.5, 3}},
    {"\"input\": {\"sine\": {\"mean\": \"2 kPa\", \"amplitude\": \"1 kPa\", \"frequency\": \"0.5 "
     "Hz\", \"phase\": \"90 deg\"}}",
     {3, 1, 2, 1}},
    {"\"input\": {\"data\": {\"csv\": \"run 1\\nt (ms);u (psi)\\n0;0\\n1000;1\\n2000;3\\n\"}, "
     "\"columns\": {\"time\": {\"name\": \"t (ms)\", \"unit\": \"ms\"}, \"set_point\": {\"name\": "
     "\"u (psi)\", \"unit\": \"psi\"}}}",
     {0, 1e-3 * PSI, 1e-3 * PSI, 3e-3 * PSI}},
    {"\"input\": {\"data\": {\"csv\": \"t,u\\n0,1\\n1,2\\n2,4\\n\"}, \"between\": \"linear\", "
     "\"columns\": {\"time\": {\"name\": \"t\", \"unit\": \"s\"}, \"set_point\": {\"name\": \"u\", "
     "\"unit\": \"kPa\"}}}",
     {1, 2, 3, 4}},
};

START_TEST(set_points_are_read) {
  static const double times[] = {0.0, 1.0, 1.5, 9.0};
  char rest[600];
  struct job_spec spec;
  struct error error;
  snprintf(rest, sizeof rest, "%s, \"end\": \"10 s\"", profiles[_i].input);
  ck_assert_msg(read_parts(NULL, NULL, NULL, rest, &spec, &error) == STATUS_OK, "%s",
                error.message);
  for (int i = 0; i < 4; i++) {
    double value = 1e-3 * hlpv_set_point(&spec.hlpv->input, times[i]);
    ck_assert_double_eq_tol(value, profiles[_i].value[i], 1e-9);
  }
  job_spec_release(&spec);
}
END_TEST

/* What is put in place of a part of the valid job. */
static const struct {
  const char *modes, *transitions, *initial, *rest, *pointer, *phrase;
} refusals[] = {
    {"{}", "[]", NULL, NULL, "/model/modes", "at least one mode"},
    {"{\"low\": {\"stiffness\": {\"per\": \"mm\", \"coefficients\": [\"1 N/m\"]}, \"damping\": \"1 "
     "N "
     "s/m\", \"alpha\": \"-1 1/s\", \"beta\": \"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness/per", "no unit of pressure"},
    {"{\"low\": {\"stiffness\": \"1 N\", \"damping\": \"1 N s/m\", \"alpha\": \"-1 1/s\", "
     "\"beta\": "
     "\"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness", "stiffness"},
    {"{\"low\": {\"stiffness\": \"1 N/m\", \"damping\": \"1 N s/m\", \"alpha\": \"-1 1/s\", "
     "\"beta\": \"1 1/s\", \"range\": [\"2 kPa\", \"1 kPa\"]}}",
     "[]", NULL, NULL, "/model/modes/low/range", "must be below"},
    {NULL,
     "[{\"from\": \"low\", \"to\": \"hihg\", \"when\": {\"h\": \"1 mm\", \"direction\": "
     "\"rising\"}}]",
     NULL, NULL, "/model/transitions/0/to", "\"high\""},
    {NULL, "[{\"from\": \"low\", \"to\": \"high\", \"when\": {\"direction\": \"rising\"}}]", NULL,
     NULL, "/model/transitions/0/when", "0 quantities"},
    {NULL,
     "[{\"from\": \"low\", \"to\": \"high\", \"when\": {\"h\": \"1 mm\", \"pressure\": \"1 "
     "kPa\", \"direction\": \"rising\"}}]",
     NULL, NULL, "/model/transitions/0/when", "2 quantities"},
    {"{\"low\": {\"stiffness\": {\"per\": \"psi\", \"states\": [[\"1 kPa\", 0.5]]}, \"damping\": "
     "\"1 N s/m\", \"alpha\": \"-1 1/s\", \"beta\": \"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness/states/0", "rest_length"},
    {"{\"low\": {\"stiffness\": {\"per\": \"psi\", \"states\": [[\"1 kPa\", \"-1 mm\"]]}, "
     "\"damping\": \"1 N s/m\", \"alpha\": \"-1 1/s\", \"beta\": \"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness", "positive stiffness"},
    {"{\"low\": {\"stiffness\": {\"states\": [[\"1 kPa\", \"1 mm\"], [\"1 kPa\", \"2 mm\"]]}, "
     "\"damping\": \"1 N s/m\", \"alpha\": \"-1 1/s\", \"beta\": \"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness", "same set-point"},
    {"{\"low\": {\"stiffness\": {\"slope\": [\"1 kPa\", \"0 mm\"]}, \"damping\": \"1 N s/m\", "
     "\"alpha\": \"-1 1/s\", \"beta\": \"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness", "positive stiffness"},
    {"{\"low\": {\"stiffness\": {\"per\": \"psi\"}, \"damping\": \"1 N s/m\", \"alpha\": \"-1 "
     "1/s\", \"beta\": \"1 1/s\"}}",
     "[]", NULL, NULL, "/model/modes/low/stiffness", "\"coefficients\" is missing"},
    {NULL,
     "[{\"from\": \"low\", \"to\": \"high\", \"when\": {\"h\": \"20 mm\", \"direction\": "
     "\"rising\"}, \"reset\": {\"h\": {}}}]",
     NULL, NULL, "/model/transitions/0/reset", "steady"},
    {NULL, NULL, "{\"mode\": \"middle\"}", NULL, "/initial/mode", "no mode \"middle\""},
    {NULL, NULL, "{\"mode\": \"low\", \"h\": \"15 mm\"}", NULL, "/initial/h", "beyond the guard"},
    {NULL, NULL, "{\"mode\": \"low\", \"h\": \"14.06 mm\", \"velocity\": \"1 m/s\"}", NULL,
     "/initial/h", "beyond the guard"},
    {NULL, NULL, NULL, "\"input\": {}, \"end\": \"1 s\"", "/input", "there are 0 profiles"},
    {NULL, NULL, NULL,
     "\"input\": {\"hold\": [[\"0 s\", \"1 kPa\"]], \"linear\": [[\"0 s\", \"1 kPa\"]]}, \"end\": "
     "\"1 "
     "s\"",
     "/input", "there are 2 profiles"},
    {NULL, NULL, NULL, "\"input\": {\"hold\": [[\"1 s\", \"1 kPa\"]]}, \"end\": \"1 s\"",
     "/input/hold/0/0", "must be 0 s"},
    {NULL, NULL, NULL,
     "\"input\": {\"hold\": [[\"0 s\", \"1 kPa\"], [\"2 s\", \"1 kPa\"], [\"2 s\", \"3 kPa\"]]}, "
     "\"end\": \"1 s\"",
     "/input/hold/2/0", "must rise"},
    {NULL, NULL, NULL,
     "\"input\": {\"linear\": [[\"0 s\", \"1 kPa\"], [\"2 s\", \"1 kPa\"], [\"1 s\", \"3 kPa\"]]}, "
     "\"end\": \"1 s\"",
     "/input/linear/2/0", "1 s is not after the one before it, 2 s"},
    {NULL, NULL, NULL, "\"input\": {\"hold\": [[\"0 s\", \"1 mm\"]]}, \"end\": \"1 s\"",
     "/input/hold/0/1", "a pressure"},
    {NULL, NULL, NULL,
     "\"input\": {\"data\": {\"csv\": \"t,u\\n0,1\\n2,3\\n1,4\\n\"}, \"columns\": {\"time\": "
     "{\"name\": \"t\", \"unit\": \"s\"}, \"set_point\": {\"name\": \"u\", \"unit\": \"kPa\"}}}, "
     "\"end\": \"1 s\"",
     "/input/data/csv", "line 4"},
    {NULL, NULL, NULL, "\"input\": {\"data\": {\"csv\": \"t,u\\n0,1\\n\"}}, \"end\": \"1 s\"",
     "/input", "\"columns\" is missing"},
    {NULL, NULL, NULL,
     "\"input\": {\"data\": {\"csv\": \"t,u\\n0,1\\n\"}, \"columns\": {\"time\": {\"name\": \"t\", "
     "\"unit\": \"mm\"}, \"set_point\": {\"name\": \"u\", \"unit\": \"kPa\"}}}, \"end\": \"1 s\"",
     "/input/columns/time/unit", "no unit"},
    {NULL, NULL, NULL,
     "\"input\": {\"data\": {\"file\": \"run.csv\"}, \"columns\": {\"time\": {\"name\": \"t\", "
     "\"unit\": \"s\"}, \"set_point\": {\"name\": \"u\", \"unit\": \"kPa\"}}}, \"end\": \"1 s\"",
     "/input/data/file", ""},
    {NULL, NULL, NULL, "\"input\": {\"hold\": [[\"0 s\", \"1 kPa\"]]}, \"end\": \"1 h\"",
     "/sample_rate", "at most 25000"},
    /* 24999 intervals of 15 s are 1666.6 Hz. */
    {NULL, NULL, NULL,
     "\"input\": {\"hold\": [[\"0 s\", \"1 kPa\"]]}, \"end\": \"15 s\", \"sample_rate\": \"2 kHz\"",
     "/sample_rate", "at most 25000; for example \"1666 Hz\""},
    {NULL, NULL, NULL, "\"input\": {\"hold\": [[\"0 s\", \"1 kPa\"]]}, \"end\": \"-1 s\"", "/end",
     "at least"},
};

START_TEST(refuses) {
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(read_parts(refusals[_i].modes, refusals[_i].transitions, refusals[_i].initial,
                              refusals[_i].rest, &spec, &error),
                   STATUS_INVALID);
  ck_assert_str_eq(error.pointer, refusals[_i].pointer);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s", error.message);
  ck_assert_int_ge(error.line, 1);
  ck_assert_ptr_null(spec.hlpv);
}
END_TEST

START_TEST(a_mass_is_positive) {
  static const char text[] =
      "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"-60 g\", \"gamma\": \"1 N/kPa\", \"modes\": "
      "{\"a\": {\"stiffness\": \"1 N/m\", \"damping\": \"1 N s/m\", \"alpha\": \"-1 1/s\", "
      "\"beta\": \"1 1/s\"}}}, \"initial\": {\"mode\": \"a\"}, \"input\": {\"hold\": [[\"0 s\", "
      "\"1 "
      "kPa\"]]}, \"end\": \"1 s\"}";
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(job_spec_read(text, strlen(text), &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/model/mass");
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: hybrid models");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, a_model_arrives_in_si_units);
  tcase_add_test(tcase, the_derivative_is_that_of_the_model);
  tcase_add_test(tcase, states_of_rest_give_the_stiffness);
  tcase_add_loop_test(tcase, set_points_are_read, 0, sizeof profiles / sizeof *profiles);
  tcase_add_loop_test(tcase, refuses, 0, sizeof refusals / sizeof *refusals);
  tcase_add_test(tcase, a_mass_is_positive);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
