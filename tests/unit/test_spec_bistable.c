/* From the text of a bistable job to its model, and what is refused. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "solver/job/bistable.h"
#include "solver/job/snap.h"
#include "tests/unit/suite.h"

/* %s: laws and all before; actuators; plate, input, end and all after. */
static const char form[] = "{\"kind\": \"bistable\", %s \"actuators\": %s, %s}";
static const char laws[] =
    "\"laws\": {\"pair\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"20 N\", \"-7 N\", \"0.5 "
    "N\"], \"area\": \"8 cm2\", \"volume\": \"9 ml\"}},";
static const char actuators[] =
    "[{\"offset\": \"-25 mm\", \"cells\": [{\"law\": \"pair\", \"count\": 2, \"mass\": \"12 g\", "
    "\"damping\": \"2 N s/m\"}, {\"law\": \"pair\", \"mass\": \"0.01 kg\", \"side\": "
    "\"stretched\", \"stiffness_factor\": 1.2, \"size_factor\": 2, \"stops\": {\"to\": \"1 cm\", "
    "\"stiffness\": \"10 N/mm\"}}]}, {\"offset\": \"25 mm\", \"cells\": [{\"law\": \"pair\", "
    "\"mass\": \"12 g\"}], \"pneumatics\": {\"supply\": \"chamber\", \"dead_volume\": \"20 ml\", "
    "\"conductance\": \"300 ml/min/kPa\"}, \"input\": {\"hold\": [[\"0 s\", \"1 psi\"]]}}]";
static const char rest[] =
    "\"plate\": {\"mass\": \"30 g\", \"inertia\": \"20 kg mm2\"}, \"load\": {\"mass\": \"100 g\"}, "
    "\"input\": {\"linear\": [[\"0 s\", \"0 kPa\"], [\"1 s\", \"40 kPa\"]]}, \"end\": \"2 s\"";

static enum status read_parts(const char *l, const char *a, const char *r, struct job_spec *spec,
                              struct error *error) {
  static char text[8000];
  *error = (struct error){.status = STATUS_OK};
  snprintf(text, sizeof text, form, l ? l : laws, a ? a : actuators, r ? r : rest);
  return job_spec_read(text, strlen(text), spec, error);
}

START_TEST(a_model_arrives_in_si_units) {
  struct job_spec spec;
  struct error error;
  ck_assert_msg(read_parts(NULL, NULL, NULL, &spec, &error) == STATUS_OK, "%s: %s", error.pointer,
                error.message);
  const struct bistable_spec *b = spec.bistable;
  ck_assert_int_eq(spec.kind, JOB_BISTABLE);
  ck_assert_int_eq(b->actuator_count, 2);
  ck_assert_int_eq(b->cell_count, 4);
  ck_assert_int_eq(b->actuator[1].first_cell, 3);
  suite_check_near(b->actuator[0].offset, -0.025);
  ck_assert_int_eq(b->actuator[0].supply.model, SUPPLY_DIRECT);
  ck_assert_int_eq(b->actuator[1].supply.model, SUPPLY_CHAMBER);
  suite_check_near(b->actuator[1].supply.conductance, 5e-9);
  suite_check_near(b->actuator[1].supply.exponent, 1.4);
  suite_check_near(b->actuator[1].supply.atmosphere, 101325.0);
  ck_assert_int_eq(b->actuator[0].input.profile, HLPV_LINEAR);
  suite_check_near(b->actuator[1].input.value[0], 6894.757293168361);
  ck_assert(!b->cell[1].stretched && b->cell[2].stretched);
  suite_check_near(b->cell[0].damping, 2.0);
  suite_check_near(b->cell[2].stiffness, 1.2);
  suite_check_near(b->cell[2].size, 2.0);
  suite_check_near(b->cell[2].stop_to, 0.01);
  ck_assert(isinf(b->cell[2].stop_from) && isnan(b->cell[2].elongation));
  suite_check_near(b->law[0].area, 8e-4);
  suite_check_near(b->law[0].per, 1e-3);
  suite_check_near(b->plate_inertia, 2e-5);
  ck_assert(b->has_load && isnan(b->initial_pressure));
  suite_check_near(b->sample_rate, 1000.0);
  job_spec_release(&spec);
  ck_assert_ptr_null(spec.bistable);
}
END_TEST

/* A snap job within, with its own defaults. */
START_TEST(a_law_may_be_computed) {
  struct job_spec spec;
  struct error error;
  ck_assert_msg(
      read_parts("\"snap\": {\"kind\": \"snap\", \"actuator\": {\"family\": "
                 "\"frustum-bellows\", \"outer_diameter\": \"40 mm\", \"wall\": \"2 mm\", "
                 "\"snapping_angle\": \"40 deg\", \"supporting_angle\": \"55 deg\", "
                 "\"pet_thickness\": \"0.25 mm\", \"snapping_slant\": \"5 mm\"}, \"silicone\": "
                 "{\"model\": \"neo-hooke\", \"mu\": \"0.19 MPa\"}},",
                 "[{\"cells\": [{\"law\": \"snap\", \"mass\": \"1 g\"}]}]", NULL, &spec,
                 &error) == STATUS_OK,
      "%s: %s", error.pointer, error.message);
  ck_assert_int_eq(spec.kind, JOB_BISTABLE);
  ck_assert_ptr_nonnull(spec.bistable->law[0].snap);
  job_spec_release(&spec);
  ck_assert_int_ne(
      read_parts("\"snap\": {\"kind\": \"snap\", \"actuator\": {\"family\": "
                 "\"frustum-bellows\", \"outer_diameter\": \"40 mm\", \"wall\": \"2 mm\", "
                 "\"snapping_angle\": \"70 deg\", \"supporting_angle\": \"55 deg\", "
                 "\"pet_thickness\": \"0.25 mm\", \"snapping_slant\": \"5 mm\"}, "
                 "\"silicone\": {\"model\": \"neo-hooke\", \"mu\": \"0.19 MPa\"}},",
                 "[{\"cells\": [{\"law\": \"snap\", \"mass\": \"1 g\"}]}]", NULL, &spec, &error),
      STATUS_OK);
  ck_assert_msg(strncmp(error.pointer, "/snap/actuator", 14) == 0, "%s", error.pointer);
}
END_TEST

#define SNAP(ANGLE)                                                                                \
  "\"snap\": {\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", "                \
  "\"outer_diameter\": \"40 mm\", \"wall\": \"2 mm\", \"snapping_angle\": \"" ANGLE                \
  " deg\", \"supporting_angle\": \"55 deg\", \"pet_thickness\": \"0.25 mm\", \"snapping_slant\": " \
  "\"5 mm\"}, \"silicone\": {\"model\": \"neo-hooke\", \"mu\": \"0.19 MPa\"}}"

/* Several laws, each of a geometry of its own, complete with defaults. */
START_TEST(laws_may_be_computed_from_several_geometries) {
  static const char cells[] = "[{\"cells\": [{\"law\": \"b\", \"mass\": \"1 g\"}]}]";
  struct job_spec spec;
  struct error error;
  ck_assert_msg(read_parts("\"laws\": {\"a\": {" SNAP("40") "}, \"b\": {" SNAP("38") "}},", cells,
                           NULL, &spec, &error) == STATUS_OK,
                "%s: %s", error.pointer, error.message);
  const struct bistable_spec *b = spec.bistable;
  ck_assert_int_eq(b->law_count, 2);
  ck_assert_double_gt(b->law[0].snap->given.snapping_angle, b->law[1].snap->given.snapping_angle);
  ck_assert(b->law[1].snap->contact);
  suite_check_near(b->law[1].snap->pressure_to, 60e3);
  job_spec_release(&spec);
  ck_assert_int_ne(read_parts("\"laws\": {\"b\": {" SNAP("70") "}},", cells, NULL, &spec, &error),
                   STATUS_OK);
  ck_assert_msg(strncmp(error.pointer, "/laws/b/snap/actuator", 21) == 0, "%s", error.pointer);
  ck_assert_int_eq(read_parts(SNAP("40") ", \"laws\": {\"snap\": {" SNAP("40") "}},", cells, NULL,
                              &spec, &error),
                   STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/laws/snap");
}
END_TEST

/* %s: law, dynamics. */
static const char snap_form[] =
    "{\"kind\": \"snap\", \"actuator\": {\"family\": \"frustum-bellows\", \"outer_diameter\": "
    "\"40 mm\", \"wall\": \"2 mm\", \"snapping_angle\": \"40 deg\", \"supporting_angle\": \"55 "
    "deg\", \"pet_thickness\": \"0.25 mm\", \"snapping_slant\": \"5 mm\"}, \"silicone\": "
    "{\"model\": \"neo-hooke\", \"mu\": \"0.19 MPa\"}, \"load\": {\"pressure_to\": \"50 kPa\", "
    "\"law\": [%s]}, \"dynamics\": {\"pair_mass\": \"12 g\", \"plate_mass\": \"30 g\", "
    "\"pneumatics\": {\"supply\": \"direct\"} %s}}";

static const struct {
  const char *law, *dynamics, *pointer; /* NULL: valid */
} snaps[] = {
    {"\"0 kPa\", \"20 kPa\"", ", \"pairs\": 3, \"trigger_spread\": 0.1", NULL},
    {"", "", "/dynamics"},
    {"\"0 kPa\"", "", "/dynamics"},
    {"\"0 kPa\", \"20 kPa\"", ", \"pairs\": 24, \"trigger_spread\": 0.2",
     "/dynamics/trigger_spread"},
    {"\"0 kPa\", \"20 kPa\"", ", \"rate\": \"0 kPa/s\"", "/dynamics/rate"},
};

START_TEST(a_snap_job_may_ask_for_its_motion) {
  struct job_spec spec;
  struct error error;
  char text[2000];
  snprintf(text, sizeof text, snap_form, snaps[_i].law, snaps[_i].dynamics);
  enum status status = job_spec_read(text, strlen(text), &spec, &error);
  if (snaps[_i].pointer) {
    ck_assert_int_eq(status, STATUS_INVALID);
    ck_assert_str_eq(error.pointer, snaps[_i].pointer);
    return;
  }
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
  const struct bistable_spec *b = spec.bistable;
  ck_assert_int_eq(spec.kind, JOB_SNAP);
  ck_assert_int_eq(b->cell_count, 3);
  suite_check_near(b->cell[0].stiffness, 0.9);
  suite_check_near(b->cell[2].stiffness, 1.1);
  suite_check_near(b->cell[1].damping, 2.0);
  suite_check_near(b->actuator[0].input.time[1], 5.0);
  suite_check_near(b->actuator[0].input.value[1], 50e3);
  suite_check_near(b->end, 6.0);
  job_spec_release(&spec);
}
END_TEST

#define POINT(h, f) "{\"h_mm\": " #h ", \"force_N\": " #f ", \"volume_mm3\": 9000}"
#define EIGHT                                                                                      \
  POINT(0, 0)                                                                                      \
  "," POINT(1, 1) "," POINT(2, 2) "," POINT(3, 3) "," POINT(4, 4) "," POINT(5, 5) "," POINT(       \
      6, 6) "," POINT(7, 7)
#define LEVEL(p, points) "{\"pressure_kPa\": " #p ", \"points\": [" points "]}"
#define TABLE(levels) "\"laws\": {\"pair\": {\"table\": [" levels "]}},"

/* What is put in place of a part of the valid job. */
static const struct {
  const char *laws, *actuators, *rest, *pointer, *phrase;
} refusals[] = {
    {NULL, "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"-12 g\"}]}]", NULL,
     "/actuators/0/cells/0/mass", "kg"},
    {NULL, "[{\"cells\": [{\"law\": \"pari\", \"mass\": \"12 g\"}]}]", NULL,
     "/actuators/0/cells/0/law", "\"pair\""},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"count\": 20, \"mass\": \"12 g\"}]}, {\"cells\": "
     "[{\"law\": \"pair\", \"count\": 5, \"mass\": \"12 g\"}]}]",
     NULL, "/actuators/1/cells/0", "25 cells"},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\"}]}, {\"cells\": [{\"law\": "
     "\"pair\", \"mass\": \"12 g\"}]}]",
     NULL, "/actuators", "same offset"},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\", \"stops\": {\"from\": \"5 mm\", "
     "\"to\": \"1 mm\", \"stiffness\": \"1 N/m\"}}]}]",
     NULL, "/actuators/0/cells/0/stops", "leave no room"},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\"}], \"pneumatics\": {\"supply\": "
     "\"chamber\", \"dead_volume\": \"-1 ml\", \"conductance\": \"1 ml/s/kPa\"}}]",
     NULL, "/actuators/0/pneumatics/dead_volume", "ml"},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\"}], \"pneumatics\": {\"supply\": "
     "\"chamber\", \"dead_volume\": \"1 ml\"}}]",
     NULL, "/actuators/0/pneumatics", "lacks a key: \"conductance\""},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\"}], \"pneumatics\": {\"supply\": "
     "\"direct\", \"exponent\": 1}}]",
     NULL, "/actuators/0/pneumatics/exponent", "belongs to the supply \"chamber\""},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\"}], \"pneumatics\": {\"supply\": "
     "\"chamber\", \"dead_volume\": \"1 ml\", \"conductance\": \"1 ml/s/kPa\"}, \"input\": "
     "{\"hold\": [[\"0 s\", \"-102 kPa\"]]}}]",
     NULL, "/actuators/0/input", "below vacuum"},
    {NULL,
     "[{\"cells\": [{\"law\": \"pair\", \"mass\": \"12 g\"}], \"input\": {\"hold\": [[\"1 "
     "s\", \"2 kPa\"]]}}]",
     NULL, "/actuators/0/input/hold/0/0", "must be 0 s"},
    {"", NULL, NULL, "/actuators/0/cells/0/law", "no law \"pair\""},
    {"\"laws\": {\"pair\": {}},", NULL, NULL, "/laws/pair", "one of \"table\""},
    {"\"laws\": {\"pair\": {\"per\": \"s\", \"coefficients\": [\"0 N\", \"1 N\"]}},", NULL, NULL,
     "/laws/pair/per", "no unit of the elongation"},
    {"\"laws\": {\"pair\": {\"per\": \"mm\", \"coefficients\": [\"0 N\", \"1 N\"], \"range\": [\"2 "
     "mm\", \"1 mm\"]}},",
     NULL, NULL, "/laws/pair/range", "must be below"},
    {TABLE(LEVEL(0, EIGHT)), NULL, NULL, "/laws/pair/table", ""},
    {TABLE(LEVEL(0, EIGHT) "," LEVEL(0, EIGHT)), NULL, NULL, "/laws/pair/table/1", "must rise"},
    {TABLE(LEVEL(10, EIGHT) "," LEVEL(0, EIGHT)), NULL, NULL, "/laws/pair/table/1",
     "not above the one before"},
    {TABLE(LEVEL(0, EIGHT) "," LEVEL(10, POINT(0, 0))), NULL, NULL, "/laws/pair/table/1",
     "has 1 points"},
    {TABLE(LEVEL(0, EIGHT) "," LEVEL(10, EIGHT "," POINT(7, 7))), NULL, NULL,
     "/laws/pair/table/1/points/8", "again"},
    {TABLE(LEVEL(0, EIGHT) "," LEVEL(10, EIGHT "," POINT(1e13, 7))), NULL, NULL,
     "/laws/pair/table/1/points/8", "h_mm"},
    {"\"laws\": {\"pair\": {\"area\": \"1 cm2\", \"table\": [" LEVEL(0, EIGHT) "," LEVEL(
         1, EIGHT) "]}},",
     NULL, NULL, "/laws/pair/area", "closed form"},
    {NULL, NULL,
     "\"plate\": {\"mass\": \"0 g\"}, \"input\": {\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"2 "
     "s\"",
     "/plate/mass", "kg"},
    {NULL, NULL, "\"plate\": {\"mass\": \"1 g\"}, \"end\": \"2 s\"", "/actuators/0",
     "no set-point"},
    {NULL, NULL,
     "\"plate\": {\"mass\": \"1 g\"}, \"input\": {\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"2 "
     "s\", \"gravity\": \"9.81 m/s2\", \"load\": {\"mass\": \"1 g\", \"gap\": \"1 mm\"}",
     "/load/gap", "would fall"},
    {NULL, NULL,
     "\"plate\": {\"mass\": \"1 g\"}, \"input\": {\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"2 "
     "s\", \"sample_rate\": \"1 MHz\"",
     "/sample_rate", "2000001 samples"},
    {NULL, NULL,
     "\"plate\": {\"mass\": \"1 g\"}, \"input\": {\"hold\": [[\"0 s\", \"0 kPa\"]]}, \"end\": \"2 "
     "s\", \"initial\": {\"pressure\": \"-200 kPa\"}",
     "/initial/pressure", "vacuum"},
};

START_TEST(refuses) {
  struct job_spec spec;
  struct error error;
  enum status status =
      read_parts(refusals[_i].laws, refusals[_i].actuators, refusals[_i].rest, &spec, &error);
  ck_assert_int_eq(status, STATUS_INVALID);
  ck_assert_str_eq(error.pointer, refusals[_i].pointer);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s", error.message);
}
END_TEST

/* NaN is no JSON. */
START_TEST(no_number_is_refused) {
  struct job_spec spec;
  struct error error;
  ck_assert_int_eq(read_parts(TABLE(LEVEL(0, EIGHT) "," LEVEL(10, EIGHT "," POINT(NaN, 7))), NULL,
                              NULL, &spec, &error),
                   STATUS_SYNTAX);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: bistable actuators");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, a_model_arrives_in_si_units);
  tcase_add_test(tcase, a_law_may_be_computed);
  tcase_add_test(tcase, laws_may_be_computed_from_several_geometries);
  tcase_add_loop_test(tcase, refuses, 0, sizeof refusals / sizeof *refusals);
  tcase_add_loop_test(tcase, a_snap_job_may_ask_for_its_motion, 0, sizeof snaps / sizeof *snaps);
  tcase_add_test(tcase, no_number_is_refused);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
