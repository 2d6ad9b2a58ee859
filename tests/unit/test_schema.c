/* The schema checker: each keyword on a small schema, then the job schema itself. */
#include <stdlib.h>
#include <string.h>

#include "solver/job/schema.h"
#include "tests/unit/suite.h"

static struct units *units;

static void set_up(void) {
  ck_assert_int_eq(units_create(&units, NULL), STATUS_OK);
}

static void tear_down(void) {
  units_destroy(units);
}

static enum status check_text(const char *schema_text, const char *value_text,
                              struct error *error) {
  struct schema *schema = NULL;
  enum status status = schema_create(schema_text, strlen(schema_text), units, &schema, error);
  ck_assert_msg(status == STATUS_OK, "%s: %s", schema_text, error->message);
  json_t *value = json_loads(value_text, JSON_DECODE_ANY, NULL);
  ck_assert_msg(value != NULL, "%s", value_text);
  status = schema_check(schema, value, error);
  json_decref(value);
  schema_destroy(schema);
  return status;
}

#define QUANTITY "{\"type\": \"string\", \"x-unit\": \"mm\"}"
#define PAIR                                                                                       \
  "{\"type\": \"object\", \"additionalProperties\": false, \"required\": [\"kind\", \"a\"],"       \
  " \"properties\": {\"kind\": {\"const\": \"pair\"}, \"a\": {\"type\": \"integer\"}}}"
#define SINGLE                                                                                     \
  "{\"type\": \"object\", \"additionalProperties\": false, \"required\": [\"kind\"],"              \
  " \"properties\": {\"kind\": {\"const\": \"single\"}}}"
#define CHOICE "{\"oneOf\": [{\"type\": \"string\"}, " PAIR ", " SINGLE "]}"

static const struct {
  const char *schema, *value;
} accepted[] = {
    {"{\"type\": \"object\"}", "{}"},
    {"{\"type\": \"array\"}", "[]"},
    {"{\"type\": \"string\"}", "\"\""},
    {"{\"type\": \"boolean\"}", "false"},
    {"{\"type\": \"number\"}", "1"},
    {"{\"type\": \"number\"}", "1.5"},
    {"{\"type\": \"integer\"}", "1"},
    {"{\"type\": \"integer\"}", "1.0"},
    {"{\"const\": 0}", "0.0"},
    {"{\"type\": \"null\"}", "null"},
    {"{\"type\": \"boolean\"}", "true"},
    {"{\"const\": \"a\"}", "\"a\""},
    {"{\"enum\": [\"a\", 2, null]}", "2"},
    {"{\"enum\": [\"a\", 2, null]}", "null"},
    {"{\"maximum\": 1}", "[]"},
    {"{\"maxLength\": 2}", "[\"a rule for strings alone\"]"},
    {"{\"minItems\": 2}", "\"a rule for arrays alone\""},
    {"{\"maxItems\": 0}", "\"a rule for arrays alone\""},
    {"{\"required\": [\"a\"], \"maxProperties\": 0}", "\"a rule for objects alone\""},
    {"{\"properties\": {\"a\": {\"const\": 1}}, \"items\": {\"const\": 1}}", "5"},
    {"{\"oneOf\": [{\"const\": 1}, {\"const\": \"a\"}]}", "1.0"},
    {"{\"oneOf\": [{\"type\": \"null\"}, {\"type\": \"array\"}]}", "null"},
    {"{\"enum\": [\"a\", \"b\"]}", "\"b\""},
    {"{\"minimum\": 1, \"maximum\": 2}", "1"},
    {"{\"minimum\": 1, \"maximum\": 2}", "2"},
    {"{\"exclusiveMinimum\": 1, \"exclusiveMaximum\": 2}", "1.5"},
    {"{\"minimum\": 1}", "\"a rule for numbers alone\""},
    {"{\"minLength\": 2, \"maxLength\": 2}", "\"\xC3\xA4\xC3\xA4\""},
    {"{\"minItems\": 1, \"maxItems\": 2}", "[1, 2]"},
    {"{\"items\": {\"type\": \"integer\"}}", "[1, 2]"},
    {"{\"additionalProperties\": {\"type\": \"string\"}}", "{\"x\": \"y\"}"},
    {"{\"propertyNames\": {\"maxLength\": 2}}", "{\"xx\": 1}"},
    {"{\"maxProperties\": 1}", "{\"x\": 1}"},
    {QUANTITY, "\"1 m\""},
    {"{\"x-unit\": \"mm\", \"x-minimum\": \"1 cm\", \"x-maximum\": \"1 m\"}", "\"10 mm\""},
    {"{\"x-unit\": \"mm\", \"x-minimum\": \"1 cm\", \"x-maximum\": \"1 m\"}", "\"1 m\""},
    {"{\"x-unit\": \"mm\", \"x-exclusiveMinimum\": \"0 m\"}", "\"1 nm\""},
    {CHOICE, "\"word\""},
    {CHOICE, "{\"kind\": \"single\"}"},
    {CHOICE, "{\"kind\": \"pair\", \"a\": 1}"},
    {"{\"oneOf\": [{\"const\": 0}, " QUANTITY "]}", "0"},
    {"{\"oneOf\": [{\"const\": 0}, " QUANTITY "]}", "\"1 mm\""},
    {"{\"$ref\": \"#/$defs/x\", \"$defs\": {\"x\": {\"type\": \"string\"}}}", "\"\""},
};

START_TEST(accepts) {
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(check_text(accepted[_i].schema, accepted[_i].value, &error) == STATUS_OK,
                "%s with %s: %s", accepted[_i].schema, accepted[_i].value, error.message);
}
END_TEST

static const struct {
  const char *schema, *value, *pointer, *phrase;
} refused[] = {
    {"{\"type\": \"object\"}", "[]", "",
     "an array of 0 items is not possible here: it must be an object"},
    {"{\"type\": \"array\"}", "{}", "",
     "an object of 0 members is not possible here: it must be an array"},
    {"{\"type\": \"string\"}", "null", "", "null is not possible here: it must be a string"},
    {"{\"type\": \"boolean\"}", "0", "",
     "the number 0 is not possible here: it must be true or false"},
    {"{\"type\": \"number\"}", "true", "", "true is not possible here: it must be a number"},
    {"{\"type\": \"integer\"}", "1.5", "", "whole number"},
    {"{\"type\": \"integer\"}", "\"1\"", "",
     "\"1\" is not possible here: it must be a whole number"},
    {"{\"type\": \"integer\", \"examples\": [7]}", "\"1\"", "", "for example 7"},
    {"{\"const\": \"a\"}", "\"b\"", "", "\"a\""},
    {"{\"enum\": [\"fast\", \"fine\"]}", "\"fsat\"", "", "did you mean \"fast\"?"},
    {"{\"enum\": [\"fast\", \"fine\"]}", "\"slow\"", "", "must be \"fast\" or \"fine\""},
    {"{\"enum\": [\"fast\", \"fine\"]}", "3", "",
     "the number 3 is not possible here: it must be \"fast\" or \"fine\""},
    {"{\"minimum\": 1}", "0.5", "", "0.5 is too small: it must be a number of at least 1"},
    {"{\"maximum\": 1}", "2", "", "2 is too large: it must be a number of at most 1"},
    {"{\"exclusiveMinimum\": 1}", "1", "", "a number above 1"},
    {"{\"exclusiveMaximum\": 1}", "1", "", "a number below 1"},
    {"{\"minLength\": 2}", "\"\xC3\xA4\"", "",
     "1 character is too short: it must be a string of at least 2 characters"},
    {"{\"maxLength\": 1}", "\"ab\"", "",
     "2 characters is too long: it must be a string of at most 1 character;"},
    {"{\"minItems\": 1}", "[]", "",
     "0 items is too short: it must be an array of at least 1 item;"},
    {"{\"maxItems\": 1}", "[1, 2]", "",
     "2 items is too long: it must be an array of at most 1 item;"},
    {"{\"items\": {\"type\": \"integer\"}}", "[1, \"a\"]", "/1", "whole number"},
    {"{\"additionalProperties\": {\"type\": \"string\"}}", "{\"x\": 1}", "/x", "a string"},
    {"{\"propertyNames\": {\"maxLength\": 2}}", "{\"xxx\": 1}", "/xxx", "3 characters"},
    {"{\"maxProperties\": 1}", "{\"x\": 1, \"y\": 1}", "",
     "2 members is too large: it must be an object of at most 1 member;"},
    {PAIR, "{\"kind\": \"pair\"}", "", "the key \"a\" is missing"},
    {PAIR, "{\"kind\": \"pair\", \"A\": 1}", "/A", "did you mean \"a\"?"},
    {PAIR, "{\"kind\": \"pair\", \"a\": 1, \"zzzz\": 1}", "/zzzz", "known are \"kind\" or \"a\""},
    {QUANTITY, "5", "",
     "the number 5 has no unit: it must be a length with its unit; for example \"5 mm\""},
    {QUANTITY, "\"5\"", "", "for example \"5 mm\""},
    {QUANTITY, "\"5 kPa\"", "", "a length is wanted"},
    {"{\"type\": \"number\"}", "null", "", "null is not possible here: it must be a number"},
    {"{\"type\": \"null\"}", "0", "", "the number 0"},
    {"{\"type\": \"integer\"}", "true", "", "true is not possible here"},
    {"{\"const\": 3}", "false", "", "false"},
    {"{\"const\": \"a\"}", "\"b\"", "", "it must be \"a\""},
    {"{\"enum\": [\"a\", 2]}", "\"c\"", "", "\"a\""},
    {"{\"enum\": [2, 3]}", "1.5", "", "the number 1.5 is not"},
    {"{\"exclusiveMinimum\": 1}", "1", "", "above 1"},
    {"{\"exclusiveMaximum\": 1}", "1", "", "below 1"},
    {"{\"exclusiveMinimum\": 1, \"exclusiveMaximum\": 3}", "3", "", "above 1 and below 3"},
    {"{\"minItems\": 2, \"items\": {\"type\": \"number\"}}", "[]", "", "for example [1, 1]"},
    {"{\"maxItems\": 1}", "[1, 2]", "", "2 items is too long"},
    {"{\"maxProperties\": 1}", "{\"a\": 1, \"b\": 2}", "", "2 members is too large"},
    {"{\"required\": [\"a\"]}", "{}", "", "the key \"a\" is missing: it must be any value"},
    {"{\"required\": [\"a\"], \"properties\": {\"a\": {\"enum\": [7]}}}", "{}", "", "{\"a\": 7}"},
    {"{\"required\": [\"a\"], \"properties\": {\"a\": {\"type\": \"boolean\"}}}", "{}", "",
     "true or false; for example {\"a\": true}"},
    {"{\"required\": [\"a\"], \"properties\": {\"a\": {\"type\": \"object\", \"required\": "
     "[\"b\"], \"properties\": {\"b\": {\"minimum\": 4}}}}}",
     "{}", "", "for example {\"a\": {\"b\": 4}}"},
    {"{\"propertyNames\": {\"maxLength\": 1}}", "{\"ab\": 1}", "/ab", "2 characters is too long"},
    {"{\"additionalProperties\": {\"const\": 1}}", "{\"ab\": 2}", "/ab", "it must be 1"},
    {"{\"x-unit\": \"mm\", \"x-maximum\": \"1 cm\"}", "\"90\"", "", "has no unit"},
    {QUANTITY, "null", "", "null is not possible here"},
    {QUANTITY, "[5]", "", "it must be a length with its unit; for example \"1 mm\""},
    {"{\"x-unit\": \"mm\", \"x-minimum\": \"1 cm\"}", "\"9 mm\"", "", "at least 1 cm"},
    {"{\"x-unit\": \"mm\", \"x-maximum\": \"1 cm\"}", "\"11 mm\"", "", "at most 1 cm"},
    {"{\"x-unit\": \"mm\", \"x-exclusiveMinimum\": \"0 mm\"}", "\"0 m\"", "", "more than 0 mm"},
    {CHOICE, "3", "", "the number 3 is not possible here: it must be a string or an object"},
    {CHOICE, "{}", "", "\"kind\" is missing: it must be \"pair\" or \"single\""},
    {CHOICE, "{\"kind\": \"siingle\"}", "/kind", "did you mean \"single\"?"},
    {CHOICE, "{\"kind\": 3}", "/kind", "the number 3 is not a known kind"},
    {CHOICE, "{\"kind\": \"single\", \"a\": 1}", "/a", "not known"},
    {"{\"oneOf\": [{\"const\": 0}, " QUANTITY "]}", "9.8", "", "for example \"9.8 mm\""},
    {"{\"items\": {\"properties\": {\"a/b\": " QUANTITY "}}}", "[{\"a/b\": 1}]", "/0/a~1b",
     "\"1 mm\""},
};

START_TEST(refuses) {
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(check_text(refused[_i].schema, refused[_i].value, &error) == STATUS_INVALID,
                "%s took %s", refused[_i].schema, refused[_i].value);
  ck_assert_int_eq(error.status, STATUS_INVALID);
  ck_assert_str_eq(error.pointer, refused[_i].pointer);
  ck_assert_msg(strstr(error.message, refused[_i].phrase) != NULL, "%s with %s: %s",
                refused[_i].schema, refused[_i].value, error.message);
}
END_TEST

static const char *const broken[] = {
    "{\"type\": \"string\", \"patern\": \"x\"}",
    "{\"$ref\": \"#/$defs/missing\"}",
    "{\"$ref\": \"#/$defs/a\", \"$defs\": {\"a\": {\"$ref\": \"#/$defs/a\"}}}",
    "{\"properties\": {\"a\": {\"format\": \"date\"}}}",
    "{\"items\": 3}",
    "{\"$ref\": \"other.json\"}",
    "{\"$defs\": {\"a\": {\"patern\": \"x\"}}}",
    "{\"oneOf\": [{\"maximun\": 1}]}",
};

START_TEST(a_schema_with_a_rule_that_nobody_enforces_is_refused) {
  struct schema *schema = NULL;
  ck_assert_int_eq(schema_create(broken[_i], strlen(broken[_i]), units, &schema, NULL),
                   STATUS_INTERNAL);
}
END_TEST

/* A limit that is no quantity of its unit is the schema's mistake, not that of the job. */
START_TEST(a_limit_of_another_kind_is_an_internal_error) {
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(check_text("{\"x-unit\": \"mm\", \"x-minimum\": \"1 kPa\"}", "\"1 mm\"", &error),
                   STATUS_INTERNAL);
}
END_TEST

/* Nobody wants to know: the same answers. */
START_TEST(checks_without_a_sentence) {
  for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
    const char *text = refused[i].schema;
    struct schema *schema = NULL;
    ck_assert_int_eq(schema_create(text, strlen(text), units, &schema, NULL), STATUS_OK);
    json_t *value = json_loads(refused[i].value, JSON_DECODE_ANY, NULL);
    ck_assert_int_eq(schema_check(schema, value, NULL), STATUS_INVALID);
    json_decref(value);
    schema_destroy(schema);
  }
}
END_TEST

START_TEST(fills_defaults_at_every_level) {
  static const char text[] =
      "{\"properties\": {\"a\": {\"default\": {}, \"properties\": {\"b\": {\"default\": 1}}},"
      " \"c\": {\"items\": {\"$ref\": \"#/$defs/x\"}}, \"d\": {\"default\": 2}},"
      " \"$defs\": {\"x\": {\"properties\": {\"y\": {\"default\": \"z\"}}}}}";
  struct schema *schema = NULL;
  ck_assert_int_eq(schema_create(text, sizeof text - 1, units, &schema, NULL), STATUS_OK);
  json_t *value = json_loads("{\"c\": [{}, {\"y\": \"own\"}], \"d\": 3}", 0, NULL);
  ck_assert_int_eq(schema_fill(schema, value, NULL), STATUS_OK);
  char *filled = json_dumps(value, JSON_COMPACT | JSON_SORT_KEYS);
  ck_assert_str_eq(filled, "{\"a\":{\"b\":1},\"c\":[{\"y\":\"z\"},{\"y\":\"own\"}],\"d\":3}");
  free(filled);
  json_decref(value);
  schema_destroy(schema);
}
END_TEST

/* ---- the job schema --------------------------------------------------------------------- */

/* Checks every example and default below `node` against the node that carries it. */
static int check_examples(const json_t *root, json_t *node) {
  int checked = 0;
  const char *key;
  json_t *child, *example;
  size_t index;
  if (json_is_object(node) && json_is_array(json_object_get(node, "examples"))) {
    json_t *alone = json_copy(node);
    json_object_set(alone, "$defs", json_object_get(root, "$defs"));
    char *schema_text = json_dumps(alone, 0);
    json_t *values = json_deep_copy(json_object_get(node, "examples"));
    if (json_object_get(node, "default")) {
      json_array_append(values, json_object_get(node, "default"));
    }
    json_array_foreach(values, index, example) {
      char *value_text = json_dumps(example, JSON_ENCODE_ANY);
      struct error error = {.status = STATUS_OK};
      ck_assert_msg(check_text(schema_text, value_text, &error) == STATUS_OK, "%s: %s: %s",
                    value_text, error.pointer, error.message);
      free(value_text);
      checked++;
    }
    free(schema_text);
    json_decref(values);
    json_decref(alone);
  }
  if (json_is_object(node)) {
    json_object_foreach(node, key, child) {
      checked += check_examples(root, child);
    }
  } else if (json_is_array(node)) {
    json_array_foreach(node, index, child) {
      checked += check_examples(root, child);
    }
  }
  return checked;
}

START_TEST(examples_of_the_job_schema_follow_it) {
  size_t size = 0;
  const char *text = job_schema_text(&size);
  ck_assert_uint_eq(strlen(text), size);
  json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL);
  ck_assert_ptr_nonnull(root);
  ck_assert_int_gt(check_examples(root, root), 40);
  json_decref(root);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: schema");
  TCase *tcase = tcase_create("all");
  tcase_set_timeout(tcase, 60); /* every example with the whole schema around it */
  tcase_add_unchecked_fixture(tcase, set_up, tear_down);
  tcase_add_loop_test(tcase, accepts, 0, sizeof accepted / sizeof *accepted);
  tcase_add_loop_test(tcase, refuses, 0, sizeof refused / sizeof *refused);
  tcase_add_loop_test(tcase, a_schema_with_a_rule_that_nobody_enforces_is_refused, 0,
                      sizeof broken / sizeof *broken);
  tcase_add_test(tcase, a_limit_of_another_kind_is_an_internal_error);
  tcase_add_test(tcase, checks_without_a_sentence);
  tcase_add_test(tcase, fills_defaults_at_every_level);
  tcase_add_test(tcase, examples_of_the_job_schema_follow_it);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
