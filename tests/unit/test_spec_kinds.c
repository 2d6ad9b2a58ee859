/* From the text of a job to its spec: jobs of kind verify, and rigid planes. */
#include <math.h>
#include <string.h>

#include "tests/unit/suite.h"

static enum status read_verify(const char *text, struct job_spec *spec, struct error *error) {
  return job_spec_read(text, strlen(text), spec, error);
}

START_TEST(verification_is_read) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_verify("{\"kind\":\"verify\",\"case\":\"elastica\"}", &spec, &error),
                   STATUS_OK);
  ck_assert_int_eq(spec.kind, JOB_VERIFY);
  ck_assert_str_eq(spec.name, "unnamed");
  ck_assert_str_eq(spec.verify.name, "elastica");
  ck_assert_int_eq(spec.verify.refinement, 3);
  ck_assert_double_eq_tol(spec.timeout_s, 600.0, 1e-9);
  char hash[sizeof spec.hash];
  memcpy(hash, spec.hash, sizeof hash);
  ck_assert_int_eq(read_verify("{\"kind\":\"verify\",\"name\":\"n\",\"case\":\"elastica\","
                               "\"refinement\":3,\"timeout\":\"10 min\",\"comment\":\"c\"}",
                               &spec, &error),
                   STATUS_OK);
  ck_assert_str_eq(spec.hash, hash);
  ck_assert_int_eq(
      read_verify("{\"kind\":\"verify\",\"case\":\"elastica\",\"refinement\":2}", &spec, &error),
      STATUS_OK);
  ck_assert_str_ne(spec.hash, hash);
}
END_TEST

static const struct {
  const char *text, *pointer, *message;
} bad_verifications[] = {
    {"{\"kind\":\"verify\"}", "", "the key \"case\" is missing"},
    {"{\"kind\":\"verify\",\"case\":\"elastic\"}", "/case", "did you mean \"elastica\"?"},
    {"{\"kind\":\"verify\",\"case\":\"elastica\",\"refinement\":0}", "/refinement", "1"},
    {"{\"kind\":\"verify\",\"case\":\"elastica\",\"refinement\":5}", "/refinement", "4"},
    {"{\"kind\":\"verify\",\"case\":\"elastica\",\"material\":\"elastic-50a\"}", "/material", ""},
};

START_TEST(bad_verifications_are_refused) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_verify(bad_verifications[_i].text, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, bad_verifications[_i].pointer);
  ck_assert_msg(strstr(error.message, bad_verifications[_i].message) != NULL, "%s", error.message);
}
END_TEST

static enum status read_planes(const char *planes, struct job_spec *spec, struct error *error) {
  const char *const edits[][2] = {{"/planes", planes}, {NULL, NULL}};
  return suite_read_edited(edits, spec, error);
}

START_TEST(planes_are_read) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_planes("[]", &spec, &error), STATUS_OK);
  ck_assert_int_eq(spec.plane_count, 0);
  ck_assert(spec.half_model);
  ck_assert_int_eq(read_planes("[{\"point\":[0,0,\"-5 mm\"],\"normal\":[0,0,2]},"
                               "{\"point\":[\"10 cm\",0,0],\"normal\":[-1,0,0.5]}]",
                               &spec, &error),
                   STATUS_OK);
  ck_assert_int_eq(spec.plane_count, 2);
  ck_assert_double_eq_tol(spec.plane[0].point[2], -5e-3, 1e-15);
  ck_assert_double_eq_tol(spec.plane[1].point[0], 0.1, 1e-15);
  ck_assert_double_eq_tol(spec.plane[1].normal[2], 0.5, 1e-15);
  ck_assert(spec.half_model);
}
END_TEST

START_TEST(a_plane_askew_needs_the_whole_model) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_planes("[{\"point\":[0,\"-3 cm\",0],\"normal\":[0,1,0]}]", &spec, &error),
                   STATUS_OK);
  ck_assert(!spec.half_model);
}
END_TEST

static const struct {
  const char *text, *pointer;
} bad_planes[] = {
    {"[{\"point\":[0,0,\"-5 mm\"],\"normal\":[0,0,0]}]", "/planes/0/normal"},
    {"[{\"point\":[0,0,\"-5 kPa\"],\"normal\":[0,0,1]}]", "/planes/0/point/2"},
    {"[{\"point\":[0,0],\"normal\":[0,0,1]}]", "/planes/0/point"},
    {"[{\"normal\":[0,0,1]}]", "/planes/0"},
};

START_TEST(bad_planes_are_refused) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(read_planes(bad_planes[_i].text, &spec, &error), STATUS_INVALID);
  ck_assert_str_eq(error.pointer, bad_planes[_i].pointer);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: kinds and planes");
  TCase *tcase = tcase_create("all");
  tcase_add_test(tcase, verification_is_read);
  tcase_add_loop_test(tcase, bad_verifications_are_refused, 0,
                      sizeof bad_verifications / sizeof *bad_verifications);
  tcase_add_test(tcase, planes_are_read);
  tcase_add_test(tcase, a_plane_askew_needs_the_whole_model);
  tcase_add_loop_test(tcase, bad_planes_are_refused, 0, sizeof bad_planes / sizeof *bad_planes);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
