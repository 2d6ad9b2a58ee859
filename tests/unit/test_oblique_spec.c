/* From the text of a job with two oblique rows to its spec: geometry, pressures, refusals. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/suite.h"

#define BODY(length, angle, more)                                                                  \
  "{\"family\":\"oblique-pneunet\",\"length\":\"" length "\",\"width\":\"25 mm\",\"height\":"      \
  "\"20 mm\",\"chamber_angle\":\"" angle "\",\"chamber_thickness\":\"4 mm\",\"chamber_gap\":"      \
  "\"1.5 mm\",\"side_wall\":\"2 mm\",\"gap_wall\":\"1.5 mm\",\"top_wall\":\"2 mm\","               \
  "\"bottom_layer\":\"10 mm\"" more "}"

static enum status read_body(const char *body, const char *pressure, struct job_spec *spec,
                             struct error *error) {
  const char *const edits[][2] = {{"/actuator", body}, {"/load/pressure", pressure}, {NULL, NULL}};
  return suite_read_edited(edits, spec, error);
}

static void must_read(const char *body, const char *pressure, struct job_spec *spec) {
  struct error error = {.status = STATUS_OK};
  enum status status = read_body(body, pressure, spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
}

START_TEST(body_is_read) {
  struct job_spec spec;
  must_read(BODY("260 mm", "45 deg", ""), "{\"to\":\"80 kPa\",\"steps\":8}", &spec);
  const struct oblique_spec *p = &spec.oblique;
  ck_assert_int_eq(spec.family, FAMILY_OBLIQUE);
  suite_check_near(p->length, 0.26);
  suite_check_near(p->angle, M_PI / 4);
  suite_check_near(p->gap_wall, 0.0015);
  suite_check_near(p->centre_wall, 0.0015);
  ck_assert(!p->spine && !p->has_channel);
  /* 260 mm less 12.5 mm of slant and two ends of 2 mm hold 20 chambers of 7 mm with gaps of
   * 1.5 mm, sqrt(2) as long along x: 238.29 mm; one more would take 12.02 mm. */
  ck_assert_int_eq(p->chamber_count, 20);
  double occupied = (20 * 7 + 19 * 1.5) * sqrt(2) + 12.5;
  suite_check_near(p->end, 0.5e-3 * (260 - occupied));
}
END_TEST

START_TEST(angle_has_two_readings) {
  struct job_spec cross, along;
  must_read(BODY("260 mm", "30 deg", ""), "{\"to\":\"80 kPa\"}", &cross);
  must_read(BODY("260 mm", "60 deg", ",\"angle_from\":\"long-axis\""), "{\"to\":\"80 kPa\"}",
            &along);
  suite_check_near(along.oblique.angle, cross.oblique.angle);
  ck_assert_int_eq(along.oblique.chamber_count, cross.oblique.chamber_count);
}
END_TEST

static const struct {
  const char *pressure;
  double to, left, right;
  bool half;
} loads[] = {
    {"{\"to\":\"80 kPa\"}", 80e3, 1, 1, true},
    {"{\"left\":\"80 kPa\",\"right\":\"80 kPa\"}", 80e3, 1, 1, true},
    {"{\"left\":\"80 kPa\",\"right\":\"40 kPa\"}", 80e3, 1, 0.5, false},
    {"{\"left\":\"0 kPa\",\"right\":\"60 kPa\"}", 60e3, 0, 1, false},
};

START_TEST(rows_have_their_pressures) {
  struct job_spec spec;
  must_read(BODY("260 mm", "45 deg", ""), loads[_i].pressure, &spec);
  suite_check_near(spec.load.pressure_to, loads[_i].to);
  ck_assert_double_eq_tol(spec.load.cavity_share[0], loads[_i].left, 1e-15);
  ck_assert_double_eq_tol(spec.load.cavity_share[1], loads[_i].right, 1e-15);
  ck_assert_int_eq(spec.half_model, loads[_i].half);
}
END_TEST

static const struct {
  const char *body, *pressure;
  enum status status;
  const char *at, *phrase;
} refusals[] = {
    {BODY("260 mm", "81 deg", ""), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY,
     "/actuator/chamber_angle", "at most 80 deg"},
    {BODY("260 mm", "5 deg", ",\"angle_from\":\"long-axis\""), "{\"to\":\"80 kPa\"}",
     STATUS_GEOMETRY, "/actuator/chamber_angle", "at least 10 deg from the long axis"},
    {BODY("60 mm", "75 deg", ""), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY, "/actuator/chamber_angle",
     "the limit is 70.4096 deg from the cross-section; for example \"70 deg\""},
    {BODY("10 mm", "45 deg", ""), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY, "/actuator/length",
     "at least 11 mm"},
    {BODY("260 mm", "45 deg", ",\"chambers\":21"), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY,
     "/actuator/chambers", "overlap the solid ends of 2 mm in a length of 260 mm: at most 20 fit"},
    {BODY("2 m", "45 deg", ""), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY, "/actuator/chambers",
     "at most 64"},
    {BODY("260 mm", "45 deg", ",\"centre_wall\":\"21 mm\""), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY,
     "/actuator/centre_wall", "at most 20.8 mm"},
    {BODY("260 mm", "45 deg", ",\"channel\":{\"width\":\"10 mm\",\"height\":\"2 mm\"}"),
     "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY, "/actuator/channel/width", "as its cavities, 9.75 mm"},
    {BODY("260 mm", "45 deg", ",\"channel\":{\"width\":\"4 mm\",\"height\":\"9 mm\"}"),
     "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY, "/actuator/channel/height", "lower than 8.5 mm"},
    {BODY("260 mm", "45 deg", ",\"solid_end\":\"130 mm\""), "{\"to\":\"80 kPa\"}", STATUS_GEOMETRY,
     "/actuator/length", "do not fit"},
    {BODY("260 mm", "95 deg", ""), "{\"to\":\"80 kPa\"}", STATUS_INVALID, "/actuator/chamber_angle",
     "at most 90 deg"},
    {BODY("260 mm", "45", ""), "{\"to\":\"80 kPa\"}", STATUS_INVALID, "/actuator/chamber_angle",
     "for example \"45 deg\""},
    {BODY("260 mm", "45 deg", ""), "{\"steps\":8}", STATUS_INVALID, "/load/pressure",
     "the key \"to\" is missing"},
    {BODY("260 mm", "45 deg", ""), "{\"left\":\"80 kPa\"}", STATUS_INVALID, "/load/pressure",
     "the key \"right\" is missing"},
    {BODY("260 mm", "45 deg", ""), "{\"to\":\"80 kPa\",\"left\":\"80 kPa\",\"right\":\"0 kPa\"}",
     STATUS_INVALID, "/load/pressure/left", "leave it out"},
    {BODY("260 mm", "45 deg", ""), "{\"left\":\"0 kPa\",\"right\":\"0 kPa\"}", STATUS_INVALID,
     "/load/pressure/left", "above 0 kPa"},
    {BODY("260 mm", "45 deg", ""), "{\"left\":\"-1 kPa\",\"right\":\"0 kPa\"}", STATUS_INVALID,
     "/load/pressure/left", "at least 0 kPa"},
};

START_TEST(refuses) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  enum status status = read_body(refusals[_i].body, refusals[_i].pressure, &spec, &error);
  ck_assert_int_eq(status, refusals[_i].status);
  ck_assert_str_eq(error.pointer, refusals[_i].at);
  ck_assert_msg(strstr(error.message, refusals[_i].phrase) != NULL, "%s", error.message);
  ck_assert_int_gt(error.line, 0);
}
END_TEST

START_TEST(one_row_has_one_pressure) {
  const struct refusal refusal = {"/load/pressure", "{\"left\": \"80 kPa\", \"right\": \"40 kPa\"}",
                                  STATUS_INVALID, "/load/pressure/left", "oblique-pneunet"};
  suite_check_refusal(&refusal);
}
END_TEST

/* The published design, in both load cases. */
START_TEST(job_files_are_valid) {
  static const char *const files[] = {"both-45", "one-45"};
  const char *source = getenv("srcdir");
  static char text[1 << 14];
  char path[600];
  snprintf(path, sizeof path, "%s/jobs/ptba/%s.json", source ? source : ".", files[_i]);
  FILE *file = fopen(path, "rb");
  ck_assert_msg(file != NULL, "%s cannot be opened", path);
  size_t size = fread(text, 1, sizeof text, file);
  fclose(file);
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(job_spec_read(text, size, &spec, &error) == STATUS_OK, "%s", error.message);
  suite_check_near(spec.oblique.length, 0.26);
  suite_check_near(spec.load.pressure_to, 80e3);
  ck_assert_double_eq(spec.load.cavity_share[1], _i == 0 ? 1 : 0);
  ck_assert_int_eq(spec.half_model, _i == 0);
}
END_TEST

/* Only the material of this family can be varied. */
START_TEST(dimensions_are_no_parameters) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  const char *const edits[][2] = {{"/actuator", BODY("260 mm", "45 deg", "")},
                                  {"/sensitivity", "{\"parameters\": [\"/actuator/side_wall\"]}"},
                                  {NULL, NULL}};
  ck_assert_int_eq(suite_read_edited(edits, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/sensitivity/parameters/0");
  ck_assert_msg(strstr(error.message, "/material/C/0") != NULL, "%s", error.message);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("oblique spec");
  TCase *tcase = tcase_create("oblique spec");
  tcase_add_test(tcase, body_is_read);
  tcase_add_test(tcase, angle_has_two_readings);
  tcase_add_loop_test(tcase, rows_have_their_pressures, 0, sizeof loads / sizeof *loads);
  tcase_add_loop_test(tcase, refuses, 0, sizeof refusals / sizeof *refusals);
  tcase_add_test(tcase, one_row_has_one_pressure);
  tcase_add_loop_test(tcase, job_files_are_valid, 0, 2);
  tcase_add_test(tcase, dimensions_are_no_parameters);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
