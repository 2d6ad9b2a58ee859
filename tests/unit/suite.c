#include "tests/unit/suite.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char base_job[] =
    "{\"kind\": \"response\", \"name\": \"test\", \"actuator\": {\"family\": \"pneunet\","
    " \"length\": \"118 mm\", \"width\": \"30 mm\", \"height\": \"15.6 mm\","
    " \"chambers\": [{\"config\": \"B\", \"count\": 7}, {\"config\": \"C\", \"count\": 5}],"
    " \"side_wall\": \"2 mm\", \"top_wall\": \"1.5 mm\", \"bottom_layer\": \"6 mm\","
    " \"channel\": {\"width\": \"4 mm\", \"height\": \"2 mm\"},"
    " \"taper\": {\"left\": \"2 deg\", \"right\": \"2 deg\"}},"
    " \"material\": \"elastic-50a\", \"load\": {\"pressure\": {\"to\": \"50 kPa\"}}}";

static struct job_reader *shared; /* of suite_share_reader */

void suite_share_reader(void) {
  ck_assert_int_eq(job_reader_create(&shared, NULL), STATUS_OK);
}

void suite_drop_reader(void) {
  job_reader_destroy(shared);
  shared = NULL;
}

int suite_run(Suite *suite) {
  SRunner *runner = srunner_create(suite);
  srunner_run_all(runner, CK_NORMAL);
  int failures = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failures == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

static void set_at(json_t *document, const char *pointer, const char *value) {
  char part[80];
  json_t *parent = document;
  for (;;) {
    size_t length = strcspn(++pointer, "/");
    ck_assert_uint_lt(length, sizeof part);
    memcpy(part, pointer, length);
    part[length] = '\0';
    pointer += length;
    if (*pointer == '\0') {
      break;
    }
    parent = json_is_array(parent) ? json_array_get(parent, strtoul(part, NULL, 10))
                                   : json_object_get(parent, part);
    ck_assert_ptr_nonnull(parent);
  }
  if (!value) {
    ck_assert_int_eq(json_object_del(parent, part), 0);
    return;
  }
  json_t *new_value = json_loads(value, JSON_DECODE_ANY, NULL);
  ck_assert_msg(new_value != NULL, "the test's own value %s is no JSON", value);
  ck_assert_int_eq(json_is_array(parent)
                       ? json_array_set_new(parent, strtoul(part, NULL, 10), new_value)
                       : json_object_set_new(parent, part, new_value),
                   0);
}

enum status suite_read_edited(const char *const (*edits)[2], struct job_spec *spec,
                              struct error *error) {
  return suite_read_document(base_job, edits, spec, error);
}

enum status suite_read_document(const char *base, const char *const (*edits)[2],
                                struct job_spec *spec, struct error *error) {
  json_t *document = json_loads(base, 0, NULL);
  ck_assert_ptr_nonnull(document);
  for (; (*edits)[0]; edits++) {
    set_at(document, (*edits)[0], (*edits)[1]);
  }
  char *text = json_dumps(document, JSON_INDENT(1));
  enum status status = shared ? job_reader_read(shared, text, strlen(text), spec, error)
                              : job_spec_read(text, strlen(text), spec, error);
  free(text);
  json_decref(document);
  return status;
}

enum status suite_read_changed(const char *pointer, const char *value, struct job_spec *spec,
                               struct error *error) {
  const char *const edits[][2] = {{pointer, value}, {NULL, NULL}};
  return suite_read_edited(edits, spec, error);
}

void suite_check_refusal(const struct refusal *refusal) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  enum status status = suite_read_changed(refusal->pointer, refusal->value, &spec, &error);
  const char *value = refusal->value ? refusal->value : "(removed)";
  ck_assert_msg(status == refusal->status, "%s = %s gave %s, not %s: %s", refusal->pointer, value,
                status_word(status), status_word(refusal->status), error.message);
  ck_assert_int_eq(error.status, status);
  ck_assert_msg(strcmp(error.pointer, refusal->at) == 0, "%s = %s points to %s: %s",
                refusal->pointer, value, error.pointer, error.message);
  ck_assert_msg(strstr(error.message, refusal->phrase) != NULL, "%s = %s says: %s",
                refusal->pointer, value, error.message);
  ck_assert_int_ge(error.line, 1);
  ck_assert_int_ge(error.column, 1);
}

void suite_check_variant(const struct variant *variant) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  enum status status =
      suite_read_document(variant->base ? variant->base : base_job, variant->edits, &spec, &error);
  const char *first = variant->edits[0][0] ? variant->edits[0][0] : "nothing";
  const char *value = variant->edits[0][1] ? variant->edits[0][1] : "(removed)";
  if (!variant->at) {
    ck_assert_msg(status == STATUS_OK, "%s = %s: %s: %s", first, value, error.pointer,
                  error.message);
    job_spec_release(&spec);
    return;
  }
  ck_assert_msg(status != STATUS_OK, "%s = %s was taken", first, value);
  ck_assert_msg(strcmp(error.pointer, variant->at) == 0 &&
                    strstr(error.message, variant->phrase) != NULL,
                "%s = %s: %s: %s", first, value, error.pointer, error.message);
  ck_assert_msg(error.allowed[0] != '\0', "%s = %s: nothing is allowed: %s", first, value,
                error.message);
  json_t *example = json_loads(error.example, JSON_DECODE_ANY, NULL);
  ck_assert_msg(example != NULL || error.example[0] == '\0', "%s = %s: no JSON: %s", first, value,
                error.example);
  json_decref(example);
  ck_assert_int_ge(error.line, 1);
}

void suite_check_near(double value, double wanted) {
  ck_assert_msg(fabs(value - wanted) <= 1e-12 * fabs(wanted), "%.15g, not %.15g", value, wanted);
}

void suite_must_read_edited(const char *const (*edits)[2], struct job_spec *spec) {
  struct error error = {.status = STATUS_OK};
  enum status status = suite_read_edited(edits, spec, &error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", error.pointer, error.message);
}

void suite_must_read(const char *pointer, const char *value, struct job_spec *spec) {
  const char *const edits[][2] = {{pointer, value}, {NULL, NULL}};
  suite_must_read_edited(edits, spec);
}
