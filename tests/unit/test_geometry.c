/* Bodies that can and cannot exist: the axial layout, and the limit that each refusal names. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/suite.h"

#define DEGREE (3.14159265358979323846 / 180)

static void check_near(double value, double wanted) {
  ck_assert_msg(fabs(value - wanted) <= 1e-12, "%.15g, not %.15g", value, wanted);
}

static enum status read_body(const char *const (*edits)[2], struct pneunet_spec *body,
                             struct error *error) {
  struct job_spec spec;
  enum status status = suite_read_edited(edits, &spec, error);
  *body = spec.pneunet;
  return status;
}

static void read_good_body(const char *const (*edits)[2], struct pneunet_spec *body) {
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(read_body(edits, body, &error) == STATUS_OK, "%s: %s", error.pointer,
                error.message);
}

/* ---- axial layout ----------------------------------------------------------------------- */

/* Walls of 2 mm, gaps of 2 mm. Runs, then length = 4 mm + n cavity + open joints x 6 mm + closed
 * joints x 2 mm, with the sums done by hand. */
static const struct {
  const char *chambers;
  double fixed_mm;
  int count;
} layouts[] = {
    {"[{\"config\": \"B\", \"count\": 1}]", 4, 1},
    {"[{\"config\": \"B\", \"count\": 12}]", 4 + 11 * 6, 12},
    {"[{\"config\": \"C\", \"count\": 3}]", 4 + 2 * 6, 3},
    {"[{\"config\": \"A\", \"count\": 4}]", 4 + 3 * 2, 4},
    {"[{\"config\": \"A\", \"count\": 2}, {\"config\": \"A\", \"count\": 2}]", 4 + 3 * 2, 4},
    {"[{\"config\": \"A\", \"count\": 2}, {\"config\": \"B\", \"count\": 2}]", 4 + 2 + 6 + 6, 4},
    {"[{\"config\": \"B\", \"count\": 2}, {\"config\": \"A\", \"count\": 1},"
     " {\"config\": \"C\", \"count\": 1}]",
     4 + 6 + 6 + 6, 4},
};

START_TEST(length_and_cavities_follow_the_layout) {
  struct pneunet_spec body;
  const char *const by_length[][2] = {{"/actuator/chambers", layouts[_i].chambers}, {NULL, NULL}};
  read_good_body(by_length, &body);
  ck_assert_int_eq(body.chamber_count, layouts[_i].count);
  check_near(body.cavity_length, (118 - layouts[_i].fixed_mm) / layouts[_i].count * 1e-3);
  check_near(body.length, 0.118);

  const char *const by_chamber[][2] = {{"/actuator/chambers", layouts[_i].chambers},
                                       {"/actuator/length", NULL},
                                       {"/actuator/chamber_length", "\"9 mm\""},
                                       {NULL, NULL}};
  read_good_body(by_chamber, &body);
  check_near(body.cavity_length, 5e-3);
  check_near(body.length, (layouts[_i].fixed_mm + layouts[_i].count * 5) * 1e-3);
}
END_TEST

START_TEST(chambers_without_gaps_need_no_gap) {
  struct pneunet_spec body;
  const char *const closed[][2] = {{"/actuator/chambers", "[{\"config\": \"A\", \"count\": 12}]"},
                                   {"/actuator/chamber_gap", "\"0 mm\""},
                                   {NULL, NULL}};
  read_good_body(closed, &body);
  ck_assert_double_eq(body.chamber_gap, 0.0);
}
END_TEST

START_TEST(length_and_chamber_length_must_agree) {
  struct pneunet_spec body;
  struct error error;
  const char *const fits[][2] = {{"/actuator/chamber_length", "\"8 mm\""}, {NULL, NULL}};
  read_good_body(fits, &body);
  check_near(body.length, 0.118);
  const char *const wrong[][2] = {{"/actuator/chamber_length", "\"8.1 mm\""}, {NULL, NULL}};
  ck_assert_int_eq(read_body(wrong, &body, &error), STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, "/actuator/chamber_length");
  ck_assert_ptr_nonnull(strstr(error.message, "make 119.2 mm, but the length is 118 mm"));
}
END_TEST

START_TEST(heights_at_base_and_tip) {
  struct pneunet_spec body;
  struct error error;
  const char *const slope[][2] = {{"/actuator/height", "{\"base\": \"20 mm\", \"tip\": \"12 mm\"}"},
                                  {NULL, NULL}};
  read_good_body(slope, &body);
  check_near(body.height_base, 0.020);
  check_near(body.height_tip, 0.012);
  const char *const both[][2] = {{"/actuator/height", "{\"base\": \"20 mm\", \"tip\": \"12 mm\"}"},
                                 {"/actuator/taper/top", "\"1 deg\""},
                                 {NULL, NULL}};
  ck_assert_int_eq(read_body(both, &body, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, "/actuator/taper/top");
}
END_TEST

START_TEST(very_large_and_very_small_bodies_are_possible) {
  struct pneunet_spec body;
  const char *const large[][2] = {{"/actuator/length", "\"900 m\""},
                                  {"/actuator/width", "\"100 m\""},
                                  {"/actuator/height", "\"100 m\""},
                                  {NULL, NULL}};
  read_good_body(large, &body);
  const char *const small[][2] = {{"/actuator/length", "\"2 mm\""},
                                  {"/actuator/width", "\"0.4 mm\""},
                                  {"/actuator/height", "\"0.4 mm\""},
                                  {"/actuator/chambers", "[{\"config\": \"B\", \"count\": 4}]"},
                                  {"/actuator/chamber_gap", "\"10 um\""},
                                  {"/actuator/side_wall", "\"10 um\""},
                                  {"/actuator/top_wall", "\"10 um\""},
                                  {"/actuator/bottom_layer", "\"100 um\""},
                                  {"/actuator/channel", NULL},
                                  {NULL, NULL}};
  read_good_body(small, &body);
}
END_TEST

/* ---- refusals --------------------------------------------------------------------------- */

static const struct refusal refusals[] = {
    {"/actuator/gap_wall", "\"4 mm\"", STATUS_GEOMETRY, "/actuator/length", "at least 119.2 mm"},
    {"/actuator/chamber_gap", "\"10 mm\"", STATUS_GEOMETRY, "/actuator/length", "at least 159.2"},
    {"/actuator/chamber_gap", "\"0 mm\"", STATUS_GEOMETRY, "/actuator/chamber_gap",
     "at least 0.001 mm"},
    {"/actuator/chambers/0/count", "60", STATUS_GEOMETRY, "/actuator/chambers", "at most 64"},
    {"/actuator/chambers/0/count", "59", STATUS_GEOMETRY, "/actuator/length", "64 cavities"},
    {"/actuator/side_wall", "\"15 mm\"", STATUS_GEOMETRY, "/actuator/length", "cavities"},
};

START_TEST(layout_refusals) {
  suite_check_refusal(&refusals[_i]);
}
END_TEST

/* For a dimension with a limit: just inside is taken, just outside is refused, and the message
 * names the limit. The limits are worked out by hand from the base job. */
static const struct {
  const char *setting; /* further edit, as pointer */
  const char *set_to;
  const char *pointer; /* the dimension that is driven to its limit */
  const char *inside, *outside;
  const char *at, *phrase;
} limits[] = {
    /* 15 mm - 0.05 mm */
    {"/actuator/gap_wall", "\"2 mm\"", "/actuator/side_wall", "\"5 mm\"", "\"14.951 mm\"",
     "/actuator/side_wall", "at most 14.95 mm"},
    /* cavity 30 - 4 = 26 mm */
    {"/actuator/taper", "{}", "/actuator/channel/width", "\"21 mm\"", "\"26.1 mm\"",
     "/actuator/channel/width", "at most as much as the cavities, 26 mm"},
    /* below 6 - 1.5 = 4.5 mm */
    {NULL, NULL, "/actuator/channel/height", "\"4.49 mm\"", "\"4.5 mm\"",
     "/actuator/channel/height", "lower than 4.5 mm"},
    {NULL, NULL, "/actuator/channel/cover", "\"3.99 mm\"", "\"4 mm\"", "/actuator/channel/height",
     "lower than 2 mm"},
    /* 6 + 1.5 + 0.1 + 1 + 1.5 = 10.1 mm */
    {NULL, NULL, "/actuator/height", "\"10.11 mm\"", "\"10.09 mm\"", "/actuator/height",
     "at least 10.1 mm"},
    {"/actuator/chambers", "[{\"config\": \"B\", \"count\": 12}]", "/actuator/height",
     "\"7.61 mm\"", "\"7.59 mm\"", "/actuator/height", "at least 7.6 mm"},
    {NULL, NULL, "/actuator/height", "{\"base\": \"20 mm\", \"tip\": \"10.11 mm\"}",
     "{\"base\": \"20 mm\", \"tip\": \"10.09 mm\"}", "/actuator/height/tip", "10.1 mm"},
    {NULL, NULL, "/actuator/height", "{\"base\": \"10.11 mm\", \"tip\": \"20 mm\"}",
     "{\"base\": \"10.09 mm\", \"tip\": \"20 mm\"}", "/actuator/height/base", "10.1 mm"},
    {NULL, NULL, "/actuator/slit", "\"6.49 mm\"", "\"6.51 mm\"", "/actuator/height", "too small"},
    /* more than half the channel, less than half the width at the tip */
    {NULL, NULL, "/actuator/stem", "\"2.01 mm\"", "\"2 mm\"", "/actuator/stem", "more than 2 mm"},
    {"/actuator/taper", "{}", "/actuator/stem", "\"14.99 mm\"", "\"15 mm\"", "/actuator/stem",
     "less than 15 mm"},
    /* atan((15 - 4) / 118) */
    {NULL, NULL, "/actuator/taper/left", "\"5.32 deg\"", "\"5.33 deg\"", "/actuator/taper/left",
     "5.3257 deg"},
    {NULL, NULL, "/actuator/taper/right", "\"5.32 deg\"", "\"5.33 deg\"", "/actuator/taper/right",
     "5.3257 deg"},
    /* without stem and channel atan((15 - 2.05) / 118) */
    {"/actuator",
     "{\"family\": \"pneunet\", \"length\": \"118 mm\", \"width\": \"30 mm\","
     " \"height\": \"15.6 mm\", \"chambers\": [{\"config\": \"B\", \"count\": 12}],"
     " \"side_wall\": \"2 mm\", \"top_wall\": \"1.5 mm\", \"bottom_layer\": \"6 mm\","
     " \"taper\": {}}",
     "/actuator/taper/left", "\"6.26 deg\"", "\"6.27 deg\"", "/actuator/taper/left", "6.2629 deg"},
    /* atan((15.6 - 10.1) / 118) */
    {NULL, NULL, "/actuator/taper/top", "\"2.66 deg\"", "\"2.67 deg\"", "/actuator/taper/top",
     "2.6686 deg"},
    {NULL, NULL, "/actuator/taper/bottom", "\"2.66 deg\"", "\"2.67 deg\"", "/actuator/taper/bottom",
     "2.6686 deg"},
    /* atan(5.5 / 118 - tan(1 deg)) */
    {"/actuator/taper/bottom", "\"1 deg\"", "/actuator/taper/top", "\"1.66 deg\"", "\"1.68 deg\"",
     "/actuator/taper/top", "1.6700 deg beside the other one"},
};

START_TEST(limits_are_where_the_messages_say) {
  const char *first = limits[_i].setting ? limits[_i].setting : "/name";
  const char *first_value = limits[_i].setting ? limits[_i].set_to : "\"limit\"";
  struct pneunet_spec body;
  struct error error = {.status = STATUS_OK};
  const char *const inside[][2] = {
      {first, first_value}, {limits[_i].pointer, limits[_i].inside}, {NULL, NULL}};
  read_good_body(inside, &body);
  const char *const outside[][2] = {
      {first, first_value}, {limits[_i].pointer, limits[_i].outside}, {NULL, NULL}};
  enum status status = read_body(outside, &body, &error);
  ck_assert_msg(status == STATUS_GEOMETRY, "%s = %s is %s", limits[_i].pointer, limits[_i].outside,
                status_word(status));
  ck_assert_msg(strcmp(error.pointer, limits[_i].at) == 0, "%s: %s", error.pointer, error.message);
  ck_assert_msg(strstr(error.message, limits[_i].phrase) != NULL, "%s", error.message);
  ck_assert_int_ge(error.line, 1);
}
END_TEST

START_TEST(a_chamber_shorter_than_its_walls_is_refused) {
  struct pneunet_spec body;
  struct error error;
  const char *const edits[][2] = {
      {"/actuator/length", NULL}, {"/actuator/chamber_length", "\"4 mm\""}, {NULL, NULL}};
  ck_assert_int_eq(read_body(edits, &body, &error), STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, "/actuator/chamber_length");
  ck_assert_ptr_nonnull(strstr(error.message, "at least 4.1 mm"));
}
END_TEST

/* The pointer of a default that does not fit names what the job would have to add. */
START_TEST(a_default_stem_that_does_not_fit_is_refused) {
  struct pneunet_spec body;
  struct error error;
  const char *const edits[][2] = {{"/actuator/channel", NULL},
                                  {"/actuator/side_wall", "\"7.5 mm\""},
                                  {"/actuator/gap_wall", "\"2 mm\""},
                                  {"/actuator/taper", NULL},
                                  {NULL, NULL}};
  ck_assert_int_eq(read_body(edits, &body, &error), STATUS_GEOMETRY);
  ck_assert_str_eq(error.pointer, "/actuator/stem");
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: geometry of the pneu-net");
  TCase *tcase = tcase_create("all");
  tcase_add_loop_test(tcase, length_and_cavities_follow_the_layout, 0,
                      sizeof layouts / sizeof *layouts);
  tcase_add_test(tcase, chambers_without_gaps_need_no_gap);
  tcase_add_test(tcase, length_and_chamber_length_must_agree);
  tcase_add_test(tcase, heights_at_base_and_tip);
  tcase_add_test(tcase, very_large_and_very_small_bodies_are_possible);
  tcase_add_loop_test(tcase, layout_refusals, 0, sizeof refusals / sizeof *refusals);
  tcase_add_loop_test(tcase, limits_are_where_the_messages_say, 0, sizeof limits / sizeof *limits);
  tcase_add_test(tcase, a_chamber_shorter_than_its_walls_is_refused);
  tcase_add_test(tcase, a_default_stem_that_does_not_fit_is_refused);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
