/* What is said about wrong jobs: the place, what was found, what is allowed, the word that may have
 * been meant, and an example, which is put in place and must make the job right. */
#include <jansson.h>
#include <stdlib.h>
#include <string.h>

#include "solver/job/json.h"
#include "solver/job/spec.h"
#include "tests/unit/suite.h"

static struct job_reader *reader;

static void set_up(void) {
  ck_assert_int_eq(job_reader_create(&reader, NULL), STATUS_OK);
}

static void tear_down(void) {
  job_reader_destroy(reader);
}

#define RESPONSE                                                                                   \
  "{\"kind\": \"response\", \"actuator\": {\"family\": \"pneunet\", \"length\": \"60 mm\","        \
  " \"width\": \"20 mm\", \"height\": \"15 mm\", \"chambers\": [{\"config\": \"B\", \"count\":"    \
  " 4}], \"side_wall\": \"2 mm\", \"top_wall\": \"2 mm\", \"bottom_layer\": \"4 mm\"},"            \
  " \"material\": \"dragon-skin-20\", \"load\": {\"pressure\": {\"to\": \"30 kPa\", \"steps\":"    \
  " 6}}}"
#define VERIFY "{\"kind\": \"verify\", \"case\": \"elastica\"}"
#define CURVE                                                                                      \
  "{\"kind\": \"material-curve\", \"material\": {\"model\": \"yeoh\", \"C\": [\"1 MPa\"]}}"
#define STUDY                                                                                      \
  "{\"kind\": \"study\", \"base\": " RESPONSE ", \"sampling\": \"list\", \"designs\": [{\"set\":"  \
  " {}}]}"
#define LONG "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx"

/* ---- one change of a right job -------------------------------------------------------------- */

enum cure { CURED, BETTER, NONE }; /* by the example: the job, its place, or there is none */

static const struct wrong {
  const char *base, *at, *value; /* NULL: the member is taken away */
  const char *pointer;           /* of the error; NULL: as `at` */
  const char *nearest;           /* NULL: none */
  const char *phrase;            /* of the message */
  enum cure cure;
} wrongs[] = {
    /* type */
    {VERIFY, "/name", "3", NULL, NULL, "the number 3 is not possible here", CURED},
    {VERIFY, "/labels", "[]", NULL, NULL, "an array of 0 items", CURED},
    {VERIFY, "/labels/a", "1", NULL, NULL, "it must be a string of at most 200", CURED},
    {VERIFY, "/comment", "{}", NULL, NULL, "a string of at most 2000 characters or", CURED},
    {VERIFY, "/comment", "[1]", "/comment/0", NULL, "it must be a string", CURED},
    {RESPONSE, "/contact", "\"yes\"", NULL, NULL, "it must be true or false", CURED},
    {RESPONSE, "/contact", "0", NULL, NULL, "the number 0", CURED},
    {RESPONSE, "/contact", "null", NULL, NULL, "null is not possible here", CURED},
    {RESPONSE, "/actuator", "[]", NULL, NULL, "it must be an object", CURED},
    {RESPONSE, "/actuator", "\"pneunet\"", NULL, NULL, "\"pneunet\" is not", CURED},
    {RESPONSE, "/actuator/chambers", "4", NULL, NULL, "an array of 1 to 32 items", BETTER},
    {RESPONSE, "/load/pressure", "\"30 kPa\"", NULL, NULL, "it must be an object", CURED},
    {RESPONSE, "/load/gravity", "\"down\"", NULL, NULL, "an array of 3 items", CURED},
    {RESPONSE, "/actuator/chambers/0/count", "1.5", NULL, NULL, "is not whole", BETTER},
    {RESPONSE, "/actuator/chambers/0/count", "\"4\"", NULL, NULL, "a whole number", BETTER},
    {CURVE, "/material", "5", NULL, NULL, "or an object", CURED},
    {CURVE, "/material/bulk_ratio", "\"1000\"", NULL, NULL, "a number from 10", CURED},
    {CURVE, "/stretch", "{\"from\": 1}", NULL, NULL, "an array of 2 items", CURED},
    /* fixed words */
    {VERIFY, "/kind", "\"verfy\"", NULL, "verify", "not a known kind", CURED},
    {VERIFY, "/kind", "\"job\"", NULL, NULL, "\"response\", \"verify\"", BETTER},
    {VERIFY, "/kind", "7", NULL, NULL, "the number 7 is not a known kind", BETTER},
    {VERIFY, "/case", "\"elastca\"", NULL, "elastica", "did you mean \"elastica\"?", CURED},
    {VERIFY, "/case", "\"Elastica\"", NULL, "elastica", "is not known", CURED},
    {VERIFY, "/case", "true", NULL, NULL, "\"patch-test\"", CURED},
    {RESPONSE, "/accuracy", "\"fats\"", NULL, "fast", "\"fast\", \"standard\" or \"fine\"", CURED},
    {RESPONSE, "/accuracy", "\"\"", NULL, NULL, "\"\" is not known", CURED},
    {RESPONSE, "/material", "\"dragonskin-20\"", NULL, "dragon-skin-20", "is not known", CURED},
    {RESPONSE, "/actuator/family", "\"pneu-net\"", NULL, "pneunet", "a known family", CURED},
    {RESPONSE, "/actuator/chambers/0/config", "\"D\"", NULL, NULL, "", CURED},
    {RESPONSE, "/actuator/gap_shape", "\"rectangle\"", NULL, "rectangular", "", CURED},
    {CURVE, "/material/model", "\"yeo\"", NULL, "yeoh", "", CURED},
    {STUDY, "/sampling", "\"lists\"", NULL, "list", "", CURED},
    {STUDY, "/base/accuracy", "\"standart\"", NULL, "standard", "", CURED},
    {STUDY, "/base/kind", "\"verify\"", NULL, NULL, "", BETTER},
    {RESPONSE, "/load/gravity", "[1, 0, 0]", "/load/gravity/0", NULL, "has no unit", CURED},
    /* keys that are missing or not known */
    {VERIFY, "/kind", NULL, "", NULL, "the key \"kind\" is missing", BETTER},
    {VERIFY, "/case", NULL, "", NULL, "the key \"case\" is missing", CURED},
    {RESPONSE, "/load", NULL, "", NULL, "the key \"load\" is missing", CURED},
    {RESPONSE, "/material", NULL, "", NULL, "the key \"material\" is missing", CURED},
    {RESPONSE, "/actuator/family", NULL, "/actuator", NULL, "\"family\" is missing", CURED},
    {RESPONSE, "/actuator/length", NULL, "/actuator", NULL, "\"length\" is missing", CURED},
    {RESPONSE, "/actuator/top_wall", NULL, "/actuator", NULL, "a length with its unit", CURED},
    {RESPONSE, "/load/pressure/to", NULL, "/load/pressure", NULL, "\"to\" is missing", CURED},
    {CURVE, "/material/C", NULL, "/material", NULL, "the key \"C\" is missing", CURED},
    {STUDY, "/designs", NULL, "", NULL, "the sampling \"list\" needs", CURED},
    {VERIFY, "/naem", "\"x\"", NULL, "name", "did you mean \"name\"?", CURED},
    {VERIFY, "/Kind", "\"verify\"", NULL, "kind", "is not known here", CURED},
    {VERIFY, "/zzzz", "1", NULL, NULL, "known are", CURED},
    {VERIFY, "/", "1", NULL, NULL, "the key \"\" is not known", CURED},
    {RESPONSE, "/actuator/top_wal", "\"2 mm\"", NULL, "top_wall", "", CURED},
    {RESPONSE, "/actuator/taper", "{\"lefft\": \"2 deg\"}", "/actuator/taper/lefft", "left", "",
     CURED},
    {CURVE, "/material/Mu", "\"1 MPa\"", NULL, NULL, "known are", CURED},
    /* quantities */
    {VERIFY, "/timeout", "5", NULL, NULL, "the number 5 has no unit", CURED},
    {VERIFY, "/timeout", "1e300", NULL, NULL, "has no unit", CURED},
    {VERIFY, "/timeout", "\"5\"", NULL, NULL, "\"5\" has no unit", CURED},
    {VERIFY, "/timeout", "\"5 kPa\"", NULL, NULL, "a pressure, but a time is wanted", CURED},
    {VERIFY, "/timeout", "\"5 mins\"", NULL, NULL, "has an unknown unit", CURED},
    {VERIFY, "/timeout", "\"five min\"", NULL, NULL, "decimal number", CURED},
    {VERIFY, "/timeout", "\"50 d\"", NULL, NULL, "too large: it must be a time", CURED},
    {VERIFY, "/timeout", "\"0 s\"", NULL, NULL, "at least 1 s", CURED},
    {VERIFY, "/timeout", "\"\"", NULL, NULL, "decimal number", CURED},
    {VERIFY, "/timeout", "[5]", NULL, NULL, "a time with its unit", CURED},
    {VERIFY, "/timeout", "\"" LONG "\"", NULL, NULL, "longer than 64", CURED},
    {RESPONSE, "/actuator/length", "60", NULL, NULL, "for example \"60 mm\"", CURED},
    {RESPONSE, "/actuator/length", "-60", NULL, NULL, "at least 1 um", BETTER},
    {RESPONSE, "/actuator/length", "\"60 degC\"", NULL, NULL, "not a plain multiple", CURED},
    {RESPONSE, "/actuator/length", "\"1e400 mm\"", NULL, NULL, "the range of numbers", BETTER},
    {RESPONSE, "/load/pressure/to", "\"0 kPa\"", NULL, NULL, "more than 0 kPa", CURED},
    {RESPONSE, "/actuator/height", "15", NULL, NULL, "for example \"15 mm\"", CURED},
    {RESPONSE, "/actuator/height", "true", NULL, NULL, "or an object", CURED},
    {CURVE, "/material/C/0", "1", NULL, NULL, "for example \"1 MPa\"", CURED},
    /* sizes and ranges */
    {VERIFY, "/name", "\"\"", NULL, NULL, "0 characters is too short", CURED},
    {VERIFY, "/name", "\"" LONG LONG "\"", NULL, NULL, "too long", CURED},
    {VERIFY, "/labels/" LONG, "\"x\"", NULL, NULL, "a string of 1 to 64 characters", NONE},
    {VERIFY, "/refinement", "0", NULL, NULL, "is too small", CURED},
    {VERIFY, "/refinement", "99", NULL, NULL, "from 1 to 4", CURED},
    {VERIFY, "/refinement", "1e300", NULL, NULL, "is too large", CURED},
    {RESPONSE, "/actuator/chambers", "[]", NULL, NULL, "0 items is too short", BETTER},
    {RESPONSE, "/load/gravity", "[0, 0]", NULL, NULL, "an array of 3 items", CURED},
    {RESPONSE, "/load/gravity", "[0, 0, 0, 0]", NULL, NULL, "4 items is too long", CURED},
    {RESPONSE, "/load/pressure/steps", "0", NULL, NULL, "from 1 to 1000", CURED},
    {CURVE, "/stretch", "[1]", NULL, NULL, "1 item is too short", CURED},
    {CURVE, "/stretch", "[0.5, 30]", "/stretch/1", NULL, "the number 30 is too large", CURED},
    {CURVE, "/material/bulk_ratio", "9", NULL, NULL, "from 10", CURED},
    /* what no schema knows */
    {CURVE, "/stretch", "[3, 1]", NULL, NULL, "must be below", CURED},
    {RESPONSE, "/metrics", "{\"fit_range\": [\"9 kPa\", \"3 kPa\"]}", "/metrics/fit_range", NULL,
     "9 kPa is not below 3 kPa", CURED},
    {RESPONSE, "/metrics", "{\"fit_range\": [\"0 kPa\", \"90 kPa\"]}", "/metrics/fit_range", NULL,
     "at most the end of the load, 30 kPa", NONE},
    {RESPONSE, "/actuator/width", "\"4 mm\"", "/actuator/side_wall", NULL, "at most 1.95 mm", NONE},
    {RESPONSE, "/actuator/height", "\"5 mm\"", NULL, NULL, "at least 6.1 mm", NONE},
    {RESPONSE, "/actuator/length", "\"9 mm\"", NULL, NULL, "must be at least", NONE},
    {RESPONSE, "/actuator/chamber_length", "\"90 mm\"", NULL, NULL, "give only one", NONE},
    {RESPONSE, "/actuator/taper", "{\"left\": \"40 deg\"}", "/actuator/taper/left", NULL,
     "the limit is", NONE},
    {RESPONSE, "/actuator/chambers/0/count", "64", "/actuator/length", NULL, "must be at least",
     NONE},
    {RESPONSE, "/planes", "[{\"point\": [0, 0, 0], \"normal\": [0, 0, 0]}]", "/planes/0/normal",
     NULL, "has no length", CURED},
    {RESPONSE, "/sensitivity", "{\"parameters\": [\"/actuator/widht\"]}",
     "/sensitivity/parameters/0", "/actuator/width", "did you mean", NONE},
    {STUDY, "/designs/0/set", "{\"actuator\": 1}", "/designs/0/set/actuator", NULL,
     "begins with a slash", NONE},
    {STUDY, "/base/actuator/length", "\"9 mm\"", "/designs/0", NULL, "must be at least", NONE},
};

/* The parent of the member that a pointer names, and its key; arrays count by number. */
static json_t *parent_of(json_t *root, const char *pointer, char *key) {
  json_t *at = root;
  const char *part = pointer + 1;
  for (;;) {
    size_t length = strcspn(part, "/");
    memcpy(key, part, length);
    key[length] = '\0';
    if (part[length] == '\0') {
      return at;
    }
    at = json_is_array(at) ? json_array_get(at, strtoul(key, NULL, 10)) : json_object_get(at, key);
    part += length + 1;
  }
}

static json_t *value_at(json_t *root, const char *pointer) {
  char key[200];
  if (pointer[0] == '\0') {
    return root;
  }
  json_t *parent = parent_of(root, pointer, key);
  return json_is_array(parent) ? json_array_get(parent, strtoul(key, NULL, 10))
                               : json_object_get(parent, key);
}

static void put(json_t *root, const char *pointer, json_t *value) {
  char key[200];
  json_t *parent = parent_of(root, pointer, key);
  if (!parent) {
    json_t *made = json_object();
    char above[200];
    strcpy(above, pointer);
    *strrchr(above, '/') = '\0';
    put(root, above, made);
    parent = made;
  }
  if (!value) {
    json_object_del(parent, key);
  } else if (json_is_array(parent)) {
    json_array_set_new(parent, strtoul(key, NULL, 10), value);
  } else {
    json_object_set_new(parent, key, value);
  }
}

/* The value that stands in the text at a line and column, a new reference. */
static json_t *value_in_text(const char *text, int line, int column) {
  for (; line > 1; line--) {
    text = strchr(text, '\n') + 1;
  }
  return json_loads(text + column - 1, JSON_DECODE_ANY | JSON_DISABLE_EOF_CHECK, NULL);
}

/* Puts the example of the error in place. */
static void cure(json_t *document, const struct error *error) {
  json_t *example = json_loads(error->example, JSON_DECODE_ANY, NULL);
  ck_assert_msg(example != NULL, "example %s of: %s", error->example, error->message);
  bool missing = strstr(error->message, "is missing") != NULL;
  bool unknown = strstr(error->message, "is not known here") != NULL;
  char key[200];
  if (missing) {
    json_object_update(value_at(document, error->pointer), example);
    json_decref(example);
  } else if (unknown) {
    json_t *parent = parent_of(document, error->pointer, key);
    json_object_del(parent, key);
    json_object_update(parent, example);
    json_decref(example);
  } else if (error->pointer[0]) {
    put(document, error->pointer, example);
  } else {
    json_decref(example);
  }
}

START_TEST(a_wrong_job_is_explained) {
  const struct wrong *wrong = &wrongs[_i];
  json_t *document = json_loads(wrong->base, 0, NULL);
  put(document, wrong->at, wrong->value ? json_loads(wrong->value, JSON_DECODE_ANY, NULL) : NULL);
  char *text = json_dumps(document, JSON_INDENT(2));
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_msg(job_reader_read(reader, text, strlen(text), &spec, &error) != STATUS_OK, "%s",
                text);
  const char *pointer = wrong->pointer ? wrong->pointer : wrong->at;
  ck_assert_msg(strcmp(error.pointer, pointer) == 0, "%s: %s", error.pointer, error.message);
  ck_assert_msg(strstr(error.message, wrong->phrase) != NULL, "%s", error.message);
  ck_assert_str_eq(error.nearest, wrong->nearest ? wrong->nearest : "");
  ck_assert_msg(error.found[0] && error.allowed[0], "%s", error.message);
  ck_assert_msg(strstr(error.message, error.allowed) != NULL, "%s", error.message);
  json_t *there = value_in_text(text, error.line, error.column);
  ck_assert_msg(json_equal(there, value_at(document, error.pointer)), "%s is not at %d:%d of %s",
                error.pointer, error.line, error.column, text);
  json_decref(there);
  free(text);
  if (wrong->cure != NONE) {
    cure(document, &error);
    struct error second = {.status = STATUS_OK};
    enum status status = job_reader_check(reader, document, &spec, &second);
    ck_assert_msg(status == STATUS_OK ||
                      (wrong->cure == BETTER && strcmp(second.pointer, error.pointer) != 0) ||
                      (wrong->cure == BETTER && strcmp(second.message, error.message) != 0),
                  "after the example %s: %s: %s", error.example, second.pointer, second.message);
    job_spec_release(&spec);
  }
  json_decref(document);
}
END_TEST

/* ---- text that is no job at all ------------------------------------------------------------- */

static const struct {
  const char *text;
  int line, column;
  const char *phrase;
} texts[] = {
    {"", 1, 1, "the text is empty"},
    {"  \n ", 2, 2, "the text is empty"},
    {"{", 1, 2, "ends too early"},
    {"{\"kind\": \"verify\"", 1, 18, "ends too early"},
    {"[]", 1, 1, "an array of 0 items is not possible here: it must be an object"},
    {"{}", 1, 1, "the key \"kind\" is missing"},
    {"\"verify\"", 1, 1, "\"verify\" stands where something else is due: '[' or '{'"},
    {"kind: verify", 1, 1, "\"kind\" stands where something else is due"},
    {"{kind: 1}", 1, 2, "\"kind\" stands where something else is due"},
    {"{\"kind\" \"verify\"}", 1, 9, "\"verify\" stands where something else is due: ':'"},
    {"{\"kind\": \"verify\"\n \"case\": 1}", 2, 2, "\"case\" stands where something else is due"},
    {"{\"kind\": \"verify\",}", 1, 19, "no comma before it"},
    {"{\"comment\": [\"x\",]}", 1, 18, "a bracket ends the array"},
    {"{'kind': 1}", 1, 2, "text in double quotes"},
    {"{\"kind\": True}", 1, 10, "true or false in small letters"},
    {"{\"timeout\": NaN}", 1, 13, "a finite number"},
    {"{\"timeout\": -Infinity}", 1, 13, "a finite number"},
    {"{\"timeout\": +1}", 1, 13, "begins with a plus sign"},
    {"{\"timeout\": .5}", 1, 13, "a digit before it"},
    {"{\"timeout\": 012}", 1, 13, "no leading zero"},
    {"{\"timeout\": 1e999}", 1, 13, "the number 1e999 is too big"},
    {"{\"n\": 123456789012345678901234567890}", 1, 7, "is too big"},
    {"{\"a\": 1,\n  \"a\": 2}", 2, 3, "the key \"a\" stands twice"},
    {"{\"a\": \"\xFF\"}", 1, 8, "no UTF-8"},
    {"{\"\xC3\xA4\": \"\xED\xA0\x80\"}", 1, 8, "no UTF-8"},
    {"{\"a\": \"\\u0000\"}", 1, 7, "a NUL character"},
    {"{\"a\": \"x\ny\"}", 1, 8, "newline"},
    {"\xEF\xBB\xBF{}", 1, 1, "a byte order mark"},
    {"{}\n{}", 2, 1, "follows the document"},
    {"{} x", 1, 4, "\"x\" follows the document"},
    {"// a job\n{}", 1, 1, "JSON has no remarks"},
    {"{\"kind\": \"verify\" /* or not */}", 1, 19, "JSON has no remarks"},
    {"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", 1, 33, "at most 32 levels"},
};

START_TEST(text_that_is_no_job_is_explained) {
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  const char *text = texts[_i].text;
  ck_assert_int_ne(job_reader_read(reader, text, strlen(text), &spec, &error), STATUS_OK);
  ck_assert_msg(strstr(error.message, texts[_i].phrase) != NULL, "%s: %s", text, error.message);
  ck_assert_msg(error.line == texts[_i].line && error.column == texts[_i].column, "%s at %d:%d",
                text, error.line, error.column);
  ck_assert_str_eq(error.pointer, "");
}
END_TEST

START_TEST(a_job_of_more_than_a_mebibyte_is_explained) {
  size_t size = JSON_TEXT_MAX + 1;
  char *text = malloc(size);
  memset(text, ' ', size);
  struct job_spec spec;
  struct error error = {.status = STATUS_OK};
  ck_assert_int_eq(job_reader_read(reader, text, size, &spec, &error), STATUS_TOO_LARGE);
  ck_assert_str_eq(error.found, "the document has 1048577 bytes");
  ck_assert_str_eq(error.allowed, "at most 1048576 (1 MiB)");
  free(text);
}
END_TEST

/* ---- the problem for programs ---------------------------------------------------------------- */

START_TEST(the_parts_are_members_of_the_problem) {
  static const char text[] = "{\"kind\": \"verify\",\n \"case\": \"elastca\"}";
  struct job_spec spec;
  struct error error;
  char described[ERROR_TEXT_MAX];
  job_reader_read(reader, text, sizeof text - 1, &spec, &error);
  error_describe(&error, described, sizeof described);
  ck_assert_msg(strncmp(described, "/case (line 2, column 10): \"elastca\" is not known", 49) == 0,
                "%s", described);
  json_t *problem = json_object();
  json_set_error(problem, &error);
  ck_assert_str_eq(json_string_value(json_object_get(problem, "found")), "\"elastca\"");
  ck_assert_str_eq(json_string_value(json_object_get(problem, "nearest")), "elastica");
  ck_assert_str_eq(json_string_value(json_object_get(problem, "example")), "elastica");
  ck_assert_int_eq(json_integer_value(json_object_get(problem, "line")), 2);
  ck_assert_int_eq(json_integer_value(json_object_get(problem, "column")), 10);
  json_decref(problem);
}
END_TEST

int main(void) {
  Suite *suite = suite_create("job: refusals");
  TCase *tcase = tcase_create("all");
  tcase_add_unchecked_fixture(tcase, set_up, tear_down);
  tcase_add_loop_test(tcase, a_wrong_job_is_explained, 0, sizeof wrongs / sizeof *wrongs);
  tcase_add_loop_test(tcase, text_that_is_no_job_is_explained, 0, sizeof texts / sizeof *texts);
  tcase_add_test(tcase, a_job_of_more_than_a_mebibyte_is_explained);
  tcase_add_test(tcase, the_parts_are_members_of_the_problem);
  suite_add_tcase(suite, tcase);
  return suite_run(suite);
}
