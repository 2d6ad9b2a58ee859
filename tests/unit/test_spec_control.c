/* Hybrid models under control, and stiffnesses from states of rest: what is taken and refused. */
#include <math.h>

#include "solver/job/hlpv_control.h"
#include "tests/unit/suite.h"

static const char model[] =
    "{\"kind\": \"hlpv\", \"model\": {\"mass\": \"60 g\", \"gamma\": \"5 N/kPa\", \"modes\": "
    "{\"low\": {\"stiffness\": \"2 kN/m\", \"damping\": \"9 N s/m\", \"alpha\": \"-9 1/s\", "
    "\"beta\": \"9 1/s\"}, \"high\": {\"rest\": \"28 mm\", \"stiffness\": \"2 kN/m\", \"damping\": "
    "\"6 N s/m\", \"alpha\": \"-9 1/s\", \"beta\": \"9 1/s\"}}, \"transitions\": [{\"from\": "
    "\"low\", \"to\": \"high\", \"when\": {\"h\": \"14 mm\", \"direction\": \"rising\"}, "
    "\"reset\": {\"h\": \"44 mm\"}}]}, \"initial\": {\"mode\": \"low\"}, \"end\": \"10 s\", "
    "\"input\": {\"hold\": [[\"0 s\", \"3 psi\"]]}}";

#define CONTROL(more)                                                                              \
  {"/control",                                                                                     \
   "{\"reference\": {\"hold\": [[\"0 s\", \"4 mm\"], [\"2 s\", \"8 mm\"]]}, \"saturation\": "      \
   "[\"-5 psi\", \"8 psi\"]" more "}"},                                                            \
  {                                                                                                \
    "/input", NULL                                                                                 \
  }
#define STATES(form)                                                                               \
  { "/model/modes/low/stiffness", "{\"per\": \"kPa\", " form "}" }
#define WHEN(quantity)                                                                             \
  { "/model/transitions/0/when", "{" quantity ", \"direction\": \"falling\"}" }
#define RESET(quantity)                                                                            \
  { "/model/transitions/0/reset", "{" quantity "}" }

static const struct variant variants[] = {
    {model, {{NULL}}, NULL, NULL},
    /* control */
    {model, {CONTROL("")}, NULL, NULL},
    {model,
     {CONTROL(", \"rate\": \"100 Hz\", \"noise\": {\"h\": \"0.1 mm\", \"seed\": 3}, "
              "\"anti_windup\": false, \"assumed\": {\"mass\": \"70 g\"}")},
     NULL,
     NULL},
    {model,
     {CONTROL(", \"rate\": \"100 kHz\""), {"/end", "\"1 h\""}, {"/sample_rate", "\"1 Hz\""}},
     "/control/rate",
     "at most"},
    {model, {CONTROL(""), {"/control/saturation", "[\"8 psi\", \"55.2 kPa\"]"}}, NULL, NULL},
    {model,
     {CONTROL(""), {"/control/saturation", "[\"8 psi\", \"-5 psi\"]"}},
     "/control/saturation",
     "they must rise"},
    {model, {CONTROL(""), {"/control/reference", "{}"}}, "/control/reference", "0 profiles"},
    {model,
     {CONTROL(""), {"/control/reference", "{\"hold\": [[\"0 s\", \"4 kPa\"]]}"}},
     "/control/reference/hold/0/1",
     "a length is wanted"},
    {model,
     {CONTROL(""), {"/input", "{\"hold\": [[\"0 s\", \"3 psi\"]]}"}},
     "/control",
     "not both"},
    {model, {{"/input", NULL}}, "", "\"input\""},
    {model,
     {{"/input", "{\"sine\": {\"mean\": \"9 MPa\", \"amplitude\": \"2 GPa\", \"frequency\": "
                 "\"1 Hz\"}}"}},
     "/input/sine/amplitude",
     "at most"},
    /* stiffness from states of rest */
    {model, {STATES("\"states\": [[\"3 kPa\", \"5 mm\"], [\"5 kPa\", \"14 mm\"]]")}, NULL, NULL},
    {model, {STATES("\"slope\": [\"3 kPa\", \"5 mm\"]")}, NULL, NULL},
    {model,
     {STATES("\"slope\": [\"3 kPa\", 0.1], \"states\": [[\"5 kPa\", 0.2]]"),
      {"/model/rest_length", "\"82 mm\""}},
     NULL,
     NULL},
    {model,
     {STATES("\"states\": [[3, \"5 mm\"]]")},
     "/model/modes/low/stiffness/states/0",
     "a set-point comes first"},
    {model,
     {STATES("\"states\": [[\"3 kPa\", \"5 mm\"], [\"3 s\", \"6 mm\"]]")},
     "/model/modes/low/stiffness/states/1",
     "a pressure is wanted"},
    {model,
     {STATES("\"slope\": [\"3 kPa\", \"5 kPa\"]")},
     "/model/modes/low/stiffness/slope",
     "a length is wanted"},
    {model,
     {STATES("\"states\": [[\"3 kPa\", 0.1]]")},
     "/model/modes/low/stiffness/states/0",
     "an elongation with its unit"},
    {model,
     {STATES("\"states\": [[\"3 kPa\", \"0 mm\"]]")},
     "/model/modes/low/stiffness",
     "no positive stiffness"},
    {model,
     {STATES("\"slope\": [\"3 kPa\", \"0 mm\"]")},
     "/model/modes/low/stiffness",
     "changes of one sign"},
    {model,
     {STATES("\"slope\": [\"3 kPa\", \"-5 mm\"]")},
     "/model/modes/low/stiffness",
     "changes of one sign"},
    {model,
     {STATES("\"slope\": [\"3 kPa\", \"5 mm\"], \"states\": [[\"1 kPa\", \"1 mm\"], [\"2 kPa\", "
             "\"2 mm\"]]")},
     "/model/modes/low/stiffness",
     "one, which gives the rest"},
    {model,
     {STATES("\"slope\": [\"3 kPa\", \"5 mm\"], \"coefficients\": [\"3 N/m\"]")},
     "/model/modes/low/stiffness",
     "one of the two"},
    /* guards and resets */
    {model, {WHEN("\"velocity\": \"-3 m/s\"")}, NULL, NULL},
    {model, {WHEN("\"h\": {\"steady\": \"-4 psi\"}"), {"/initial/mode", "\"high\""}}, NULL, NULL},
    {model,
     {WHEN("\"h\": {\"steady\": \"1 kPa\"}"),
      {"/model/modes/low/stiffness",
       "{\"per\": \"kPa\", \"coefficients\": [\"1 N/m\", \"-1 N/m\"]}"}},
     "/model/transitions/0/when",
     "a set-point with a stiffness"},
    {model, {RESET("\"velocity\": {\"times\": -0.8}")}, NULL, NULL},
    {model, {RESET("\"h\": {\"steady\": \"4 psi\"}")}, NULL, NULL},
    {model,
     {RESET("\"h\": {\"steady\": \"1 kPa\"}"),
      {"/model/modes/high/stiffness",
       "{\"per\": \"kPa\", \"coefficients\": [\"1 N/m\", \"-1 N/m\"]}"}},
     "/model/transitions/0/reset",
     "has no value"},
    {model,
     {RESET("\"h\": {\"steady\": \"1 kPa\", \"times\": 2}")},
     "/model/transitions/0/reset",
     "has no value"},
    {model, {{"/initial", NULL}}, "", "\"initial\" is missing"},
};

START_TEST(variants_are_taken_or_refused) {
  suite_check_variant(&variants[_i]);
}
END_TEST

/* At rest the set-point is 0, or the limit that is nearest to it. */
START_TEST(the_set_point_at_rest_lies_within_the_limits) {
  static const struct {
    const char *limits;
    double rest;
  } cases[] = {{"[\"-5 kPa\", \"8 kPa\"]", 0.0},
               {"[\"2 kPa\", \"8 kPa\"]", 2e3},
               {"[\"-5 kPa\", \"-2 kPa\"]", -2e3}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    const char *const edits[][2] = {
        CONTROL(""), {"/control/saturation", cases[i].limits}, {NULL, NULL}};
    struct job_spec spec;
    struct error error;
    ck_assert_int_eq(suite_read_document(model, edits, &spec, &error), STATUS_OK);
    ck_assert_double_eq_tol(spec.hlpv->input.value[0], cases[i].rest, 1e-9);
    ck_assert_uint_eq(spec.hlpv->input.count, 1);
    suite_check_near(spec.hlpv->control->interval, 0.02);
    job_spec_release(&spec);
  }
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: control of hybrid models");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, suite_share_reader, suite_drop_reader);
  tcase_add_loop_test(tcase, variants_are_taken_or_refused, 0, sizeof variants / sizeof *variants);
  tcase_add_test(tcase, the_set_point_at_rest_lies_within_the_limits);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
